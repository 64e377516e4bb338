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

/// Slice of a volume that the user drags by one of its edges.
struct SliceGrip {
  std::size_t axis = 0;
  glm::dvec3 point{0};  // point on the edge where the drag began, world space
  glm::dvec3 across{0};  // vector from the plane of the first voxels to that of the last voxels, world space
  float place = 0;  // position of the slice when the drag began, 0..1
  glm::vec2 pointer{0};  // pixels; position of the pointer when the drag began
  bool upwards = false;  // the view direction is along the slice's normal; then dragging up or down moves the slice
};

/// Returns a grip on the slice with an edge within `reach` pixels of `pointer`; if there are several, on the nearest
/// one. `pointer` is in pixels from the upper left of a viewport of `size` pixels. Returns nullopt if there is none.
[[nodiscard]] std::optional<SliceGrip> slice_at_edge(const VolumeGrid& grid, const VolumeSlices& slices,
                                                     const glm::dmat4& world_from_node, const Pose& pose,
                                                     const glm::vec2& size, const glm::vec2& pointer, float reach);
/// Returns the position of the slice, 0..1, after the pointer was dragged to `pointer`. The grabbed point stays under
/// the pointer if possible. If `grip.upwards`, only vertical movement counts.
[[nodiscard]] float dragged_place(const SliceGrip& grip, const Pose& pose, const glm::vec2& size,
                                  const glm::vec2& pointer);

}  // namespace gs::app
