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

/// Evaluates a displaced surface incrementally while its numbers are received. Re-evaluates only patches with new
/// numbers and nearby patches, since their predictions depend on these. Call from one thread; it uses others
/// internally.
class PatchEvaluator {
 public:
  /// Marks patches of a cluster after some of its numbers were received. `patches` is the number of all patches.
  void changed(const displaced::ClusterHeader& cluster, std::uint32_t patches);
  /// Marks colours after some of their numbers were received.
  void colors_changed() { colors_changed_ = true; }
  /// Returns the surface at a level, which must not be coarser than in the last call. `surface` and `box` must be the
  /// same in every call. Shares unchanged parts with the last result. Keeps about 45 bytes per vertex for the next
  /// call.
  [[nodiscard]] std::shared_ptr<const PatchSurface> state(const displaced::Surface& surface, int level, const Box& box);
  /// Returns the number of patches evaluated for the last state, counted once per level.
  [[nodiscard]] std::size_t worked_out() const { return worked_out_; }

 private:
  struct Level {
    RawVector<glm::vec3> places, shifts;  // positions by layer 0; shifts added by finer layers
    RawVector<glm::vec3> normals;         // of `places`, by slot
  };
  /// Marks of patches, edges or vertices that must be evaluated.
  using Marks = std::vector<char>;
  /// Changed parts of a level.
  struct Changes {
    Marks inner, edges, corners;  // by patch, edge and vertex of the base
    bool all = false;             // the level is new; the marks are unused
  };
  struct Scratch {
    Columns places, shifts, normals, made, made_shifts;
    std::vector<std::int16_t> numbers;
    std::array<std::vector<float>, displaced::kLayers> moved, row;
  };

  void prepare(const displaced::Surface& surface);
  void work_out_base(const displaced::Surface& surface, Changes& changes);
  void work_out(const displaced::Surface& surface, int level, std::uint32_t patch, Changes& changes, Scratch& scratch);
  /// Returns the patches that contain a change.
  [[nodiscard]] Marks touched(const displaced::Surface& surface, const Changes& changes) const;
  /// Returns the marked patches and all patches that share a base vertex with one of them.
  [[nodiscard]] Marks around(const displaced::Surface& surface, const Marks& marks) const;
  /// Computes normals at the slots of marked patches, as vectors or packed, from the positions of a level plus
  /// `shifts`, if any. Covers all slots of the patches in `inner`, and only edge slots of the others.
  void find_normals(const displaced::Surface& surface, int level, std::span<const glm::vec3> places,
                    std::span<const glm::vec3> shifts, const Marks& inner, const Marks& edges,
                    RawVector<glm::vec3>* normals, RawVector<std::uint32_t>* packed);

  std::vector<Level> levels_;
  std::vector<Marks> marks_;                                   // by level
  std::vector<std::vector<std::uint32_t>> patches_of_corner_;  // by vertex of the base
  struct SlotCorner {
    std::uint32_t patch, corner;
  };
  std::vector<std::vector<SlotCorner>> corners_of_slot_;  // by vertex of the patches cut along creases
  RawVector<glm::vec3> rims_;               // partial sums at the rim vertices of each patch, for the current level
  RawVector<std::uint32_t> shown_normals_;  // of the last state, by slot; see pack_direction()
  std::vector<Rgb8> colors_;
  bool colors_changed_ = true;
  std::size_t worked_out_ = 0;
  std::shared_ptr<const PatchSurface> last_;
};

}  // namespace gs::qnv
