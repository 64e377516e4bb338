#pragma once

#include "app/view/navigation.h"
#include "app/view/values/slices.h"
#include "app/view/values/volume_grid.h"

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstddef>
#include <optional>

namespace gs::app {

/// A slice that is held in the picture, at one of its edges.
struct SliceGrip {
  std::size_t axis = 0;
  glm::dvec3 point{0};   // of the edge, world space
  glm::dvec3 across{0};  // world space: from where the plane of the first voxel is to that of the last
  float place = 0;       // of the slice when it was taken, 0..1
  glm::vec2 pointer{0};  // pixels, likewise
  bool upwards = false;  // who took it looked along its way, and draws up and down
};

/// The slice whose edge is seen at `pointer`, no farther than `reach` pixels from it; of several the nearest to the
/// pointer. Pixels count from the upper left of a viewport of `size`.
[[nodiscard]] std::optional<SliceGrip> slice_at_edge(const VolumeGrid& grid, const VolumeSlices& slices,
                                                     const glm::dmat4& world_from_node, const Pose& pose,
                                                     const glm::vec2& size, const glm::vec2& pointer, float reach);
/// Where the slice is, 0..1, once its edge has been drawn to `pointer`: what is held stays under the pointer as far as
/// the plane can follow. Who looks along its way draws up and down.
[[nodiscard]] float dragged_place(const SliceGrip& grip, const Pose& pose, const glm::vec2& size,
                                  const glm::vec2& pointer);

}  // namespace gs::app
