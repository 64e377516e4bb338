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

/// Slice that is being dragged by one of its edges.
struct SliceGrip {
  std::size_t axis = 0;
  glm::dvec3 point{0};   // point on the edge, world space
  glm::dvec3 across{0};  // from the plane of the first voxel to that of the last, world space
  float place = 0;       // position of the slice at the start of the drag, 0..1
  glm::vec2 pointer{0};  // pointer position at the start, pixels
  bool upwards = false;  // the view looks along the slice's normal, so dragging up or down moves it
};

/// Returns the slice with an edge within `reach` pixels of `pointer`, the nearest one if there are several. Pixels
/// count from the upper left of a viewport of `size`.
[[nodiscard]] std::optional<SliceGrip> slice_at_edge(const VolumeGrid& grid, const VolumeSlices& slices,
                                                     const glm::dmat4& world_from_node, const Pose& pose,
                                                     const glm::vec2& size, const glm::vec2& pointer, float reach);
/// Returns the slice position, 0..1, after its edge was dragged to `pointer`. The grabbed point stays under the pointer
/// as far as the plane can follow. If the view looks along the normal, vertical movement counts.
[[nodiscard]] float dragged_place(const SliceGrip& grip, const Pose& pose, const glm::vec2& size,
                                  const glm::vec2& pointer);

}  // namespace gs::app
