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

/// Received stages of a displaced surface. Stages may be received in any order; clusters wait for their base. One
/// thread at a time. Safe for untrusted bytes.
class SurfaceStages {
 public:
  /// Starts with the first stage. `base` is the base mesh from the stream's header, `box` the stream's box.
  void begin(std::span<const std::byte> base, const Box& box, std::size_t most_vectors);
  /// Adds a cluster: the payload of one chunk.
  void add(std::span<const std::byte> payload);
  /// Appends the visible vertices and their triangles. `colored` appends colours; vertices without received colours use
  /// the mesh's colour. `without` marks patches of the main stage to leave out, by number; if empty, none are.
  void append(IndexedMesh& mesh, bool colored, const std::vector<bool>& without = {}) const;
  /// Returns the number of vertices that append() would append.
  [[nodiscard]] std::size_t vectors(const std::vector<bool>& without = {}) const;
  /// Main stage, which replaces the earlier stages. `surface` is nullptr if there is no stage.
  struct Shown {
    int number = 0;
    const displaced::Surface* surface = nullptr;
    int level = 0;
  };
  [[nodiscard]] Shown main() const;
  /// Returns the visible stages as patches for renderers. The result shares unchanged parts with earlier results.
  [[nodiscard]] SurfacePatches patches(GeometryBase base);
  [[nodiscard]] const DecodeCount& count() const { return count_; }

 private:
  void add_stage(int number, displaced::StageHeader stage);
  /// Removes the stages that a later stage has replaced.
  void drop_stages();
  [[nodiscard]] bool fits(const displaced::Surface& surface) const;
  void recount();
  /// Returns the last stage with enough clusters to replace the earlier ones; nullptr if there is none.
  [[nodiscard]] const displaced::Surface* shown() const;
  /// Returns all stages that are drawn together, the main stage first.
  [[nodiscard]] std::vector<std::pair<int, const displaced::Surface*>> all_shown() const;
  void append(const displaced::Surface& surface, IndexedMesh& mesh, bool colored,
              const std::vector<bool>& without) const;

  Box box_;
  std::size_t most_vectors_ = 0, vectors_ = 0, waiting_bytes_ = 0;
  std::uint32_t gone_ = 0;  // one bit per removed stage
  DecodeCount count_;
  std::map<int, displaced::Surface> stages_;
  std::map<int, PatchEvaluator> evaluators_;  // for stages that patches() has returned
  std::multimap<int, std::vector<std::byte>> waiting_;  // clusters without a base, by stage
};

}  // namespace gs::qnv
