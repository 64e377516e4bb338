#pragma once

#include "qnv/base/raw_vector.h"
#include "qnv/codecs/displaced/tessellation/patch_grid.h"
#include "qnv/codecs/displaced/tessellation/patch_surface.h"

#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace gs::qnv {

/// Incremental evaluator of a displaced surface while its numbers are received. Re-evaluates only patches with new
/// numbers and nearby patches, because their predictions depend on the new numbers. Call it from one thread; it uses
/// others internally.
class PatchEvaluator {
 public:
  /// Marks the patches of a cluster as changed, after some of its numbers were received. `patches` is the number of all
  /// patches.
  void changed(const displaced::ClusterHeader& cluster, std::uint32_t patches);
  /// Marks the colours as changed, after some of their numbers were received.
  void colors_changed() { colors_changed_ = true; }
  /// Returns the surface at a level. The level must not be coarser than in the last call; `surface` and `box` must be
  /// the same in every call. The result shares unchanged parts with the last result. Keeps about 45 bytes per vertex
  /// for the next call.
  [[nodiscard]] std::shared_ptr<const PatchSurface> state(const displaced::Surface& surface, int level, const Box& box);
  /// Returns the number of patches that the last state() evaluated. A patch counts once per level.
  [[nodiscard]] std::size_t worked_out() const { return worked_out_; }

 private:
  struct Level {
    RawVector<glm::vec3> places, shifts;  // positions after layer 0; displacements of finer layers
    RawVector<glm::vec3> normals;  // normals of the surface at `places`, by slot
  };
  /// Marks of patches, edges or vertices that must be evaluated.
  using Marks = std::vector<char>;
  /// Changed parts of a level.
  struct Changes {
    Marks inner, edges, corners;  // inner parts of patches, edges, and corners at base vertices
    bool all = false;  // everything on the level is new; ignore the marks
  };
  struct Scratch {
    Columns places, shifts, normals, made, made_shifts;
    std::vector<std::int16_t> numbers;
    std::array<std::vector<float>, displaced::kLayers> moved, row;
  };

  void prepare(const displaced::Surface& surface);
  void work_out_base(const displaced::Surface& surface, Changes& changes);
  void work_out(const displaced::Surface& surface, int level, std::uint32_t patch, Changes& changes, Scratch& scratch);
  /// Returns the patches in which something changed.
  [[nodiscard]] Marks touched(const displaced::Surface& surface, const Changes& changes) const;
  /// Returns the marked patches, and all patches that share a base vertex with a marked patch.
  [[nodiscard]] Marks around(const displaced::Surface& surface, const Marks& marks) const;
  /// Computes normals at the slots of marked patches, and writes them as vectors or packed. Uses the positions of a
  /// level plus `shifts`, which may be empty. Covers all slots of the patches in `inner`, and only edge slots of the
  /// other marked patches.
  void find_normals(const displaced::Surface& surface, int level, std::span<const glm::vec3> places,
                    std::span<const glm::vec3> shifts, const Marks& inner, const Marks& edges,
                    RawVector<glm::vec3>* normals, RawVector<std::uint32_t>* packed);

  std::vector<Level> levels_;
  std::vector<Marks> marks_;  // patches with new numbers, by level
  std::vector<std::vector<std::uint32_t>> patches_of_corner_;  // adjacent patches of each base vertex
  struct SlotCorner {
    std::uint32_t patch, corner;
  };
  std::vector<std::vector<SlotCorner>> corners_of_slot_;  // adjacent patches of each base slot
  RawVector<glm::vec3> rims_;               // partial sums at the rim vertices of each patch, for the current level
  RawVector<std::uint32_t> shown_normals_;  // normals of the last result, by slot; see pack_direction()
  std::vector<Rgb8> colors_;
  bool colors_changed_ = true;
  std::size_t worked_out_ = 0;
  std::shared_ptr<const PatchSurface> last_;
};

}  // namespace gs::qnv
