#pragma once

#include "qnv/base/geometry.h"
#include "qnv/codecs/displaced/surface.h"
#include "qnv/codecs/displaced/tessellation/patch_evaluator.h"
#include "qnv/codecs/shared/decoder.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace gs::qnv {

/// Received stages of a displaced surface, in any order; clusters wait for their base. Not thread-safe; safe for
/// untrusted bytes.
class SurfaceStages {
 public:
  /// Starts with the first stage, from the stream's header. `box` is the stream's.
  void begin(std::span<const std::byte> base, const Box& box, std::size_t most_vectors);
  /// Adds the payload of a chunk.
  void add(std::span<const std::byte> payload);
  /// Appends the visible vertices and their triangles. `colored` appends colours; vertices without received colours use
  /// the mesh's colour. `without` marks patches of the main stage to leave out, by number; if empty, none are.
  void append(IndexedMesh& mesh, bool colored, const std::vector<bool>& without = {}) const;
  /// Returns the number of these vertices.
  [[nodiscard]] std::size_t vectors(const std::vector<bool>& without = {}) const;
  /// Stage that replaces the earlier ones: its number, surface and level. `surface` is nullptr if there is none.
  struct Shown {
    int number = 0;
    const displaced::Surface* surface = nullptr;
    int level = 0;
  };
  [[nodiscard]] Shown main() const;
  /// Returns the visible stages for renderers. Shares unchanged parts with earlier results.
  [[nodiscard]] SurfacePatches patches(GeometryBase base);
  [[nodiscard]] const DecodeCount& count() const { return count_; }

 private:
  void add_stage(int number, displaced::StageHeader stage);
  /// Removes the stages that another one has replaced.
  void drop_stages();
  [[nodiscard]] bool fits(const displaced::Surface& surface) const;
  void recount();
  /// Returns the last stage that has enough clusters to replace the earlier ones, or nullptr.
  [[nodiscard]] const displaced::Surface* shown() const;
  /// Returns all stages that are shown together, the main one first.
  [[nodiscard]] std::vector<std::pair<int, const displaced::Surface*>> all_shown() const;
  void append(const displaced::Surface& surface, IndexedMesh& mesh, bool colored,
              const std::vector<bool>& without) const;

  Box box_;
  std::size_t most_vectors_ = 0, vectors_ = 0, waiting_bytes_ = 0;
  std::uint32_t gone_ = 0;  // one bit per replaced stage
  DecodeCount count_;
  std::map<int, displaced::Surface> stages_;
  std::map<int, PatchEvaluator> evaluators_;            // of stages requested as patches
  std::multimap<int, std::vector<std::byte>> waiting_;  // by stage
};

}  // namespace gs::qnv
