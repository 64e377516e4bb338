#pragma once

#include "qnv/base/raw_vector.h"
#include "qnv/surface/patch_grid.h"
#include "qnv/surface/patch_surface.h"

#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace gs::qnv {

/// Keeps a displaced surface worked out while its numbers come: only patches that got some, and those near them, whose
/// predictions depend on them, are worked out again. One thread, which makes others work for it.
class PatchEvaluator {
 public:
  /// Numbers of a cluster have come, or some of them. `patches`: how many there are.
  void changed(const displaced::ClusterHeader& cluster, std::uint32_t patches);
  /// Numbers of colours have come.
  void colors_changed() { colors_changed_ = true; }
  /// The surface at a level, which is no coarser than the last time. `surface` and `box` are the same every time. What
  /// is the same as the last time is shared with that. About 45 bytes a vertex are kept for the next time.
  [[nodiscard]] std::shared_ptr<const PatchSurface> state(const displaced::Surface& surface, int level, const Box& box);
  /// Patches that were worked out for the last state, once for each level.
  [[nodiscard]] std::size_t worked_out() const { return worked_out_; }

 private:
  struct Level {
    RawVector<glm::vec3> places, shifts;  // by layer 0, and what the finer ones add
    RawVector<glm::vec3> normals;         // of the places, by slot
  };
  /// Whose numbers are to be looked at, patch by patch.
  using Marks = std::vector<char>;
  /// What of a level is not what it was.
  struct Changes {
    Marks inner, edges, corners;  // by patch, edge and vertex of the base
    bool all = false;             // the level is new: nothing of it is marked
  };
  struct Scratch {
    Columns places, shifts, normals, made, made_shifts;
    std::vector<std::int16_t> numbers;
    std::array<std::vector<float>, displaced::kLayers> moved, row;
  };

  void prepare(const displaced::Surface& surface);
  void work_out_base(const displaced::Surface& surface, Changes& changes);
  void work_out(const displaced::Surface& surface, int level, std::uint32_t patch, Changes& changes, Scratch& scratch);
  /// The patches that hold something that changed.
  [[nodiscard]] Marks touched(const displaced::Surface& surface, const Changes& changes) const;
  /// Those and all that have a vertex of the base in common with one of them.
  [[nodiscard]] Marks around(const displaced::Surface& surface, const Marks& marks) const;
  /// The normals, or packed ones, of places of a level, with their shifts if there are any, at the slots of marked
  /// patches: all of those in `inner`, of the others only those on edges.
  void find_normals(const displaced::Surface& surface, int level, std::span<const glm::vec3> places,
                    std::span<const glm::vec3> shifts, const Marks& inner, const Marks& edges,
                    RawVector<glm::vec3>* normals, RawVector<std::uint32_t>* packed);

  std::vector<Level> levels_;
  std::vector<Marks> marks_;                                   // by level
  std::vector<std::vector<std::uint32_t>> patches_of_corner_;  // by vertex of the base
  struct SlotCorner {
    std::uint32_t patch, corner;
  };
  std::vector<std::vector<SlotCorner>> corners_of_slot_;  // by vertex of the patches that were cut along creases
  RawVector<glm::vec3> rims_;               // sums at the vertices of each patch's rim, of the level in work
  RawVector<std::uint32_t> shown_normals_;  // of the last state, by slot: pack_direction
  std::vector<Rgb8> colors_;
  bool colors_changed_ = true;
  std::size_t worked_out_ = 0;
  std::shared_ptr<const PatchSurface> last_;
};

}  // namespace gs::qnv
