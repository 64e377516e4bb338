#include "app/view/values/slice_drag.h"

#include "app/view/values/slice_scene.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>

namespace gs::app {
namespace {

// Returns the point of a line that is closest to a ray, as a multiple of `along` from `from`. Returns nullopt if line
// and ray are nearly parallel.
std::optional<double> nearest_along(const glm::dvec3& from, const glm::dvec3& along, const Ray& ray) {
  constexpr double kMinSine = 0.2;
  const glm::dvec3 direction(ray.direction);
  const double length = glm::dot(along, along), shared = glm::dot(along, direction);
  const double apart = length - shared * shared;
  if (!(apart > kMinSine * kMinSine * length)) return std::nullopt;
  const glm::dvec3 off = ray.origin - from;
  return (glm::dot(off, along) - glm::dot(off, direction) * shared) / apart;
}

float distance_to_segment(const glm::vec2& from, const glm::vec2& to, const glm::vec2& point) {
  const glm::vec2 along = to - from;
  const float length = glm::dot(along, along);
  const float part = length > 0 ? std::clamp(glm::dot(point - from, along) / length, 0.0f, 1.0f) : 0.0f;
  return glm::distance(from + along * part, point);
}

}  // namespace

std::optional<SliceGrip> slice_at_edge(const VolumeGrid& grid, const VolumeSlices& slices,
                                       const glm::dmat4& world_from_node, const Pose& pose, const glm::vec2& size,
                                       const glm::vec2& pointer, float reach) {
  std::optional<SliceGrip> nearest;
  float least = reach;
  const auto world = [&](const glm::dvec3& place) { return glm::dvec3(world_from_node * glm::dvec4(place, 1)); };
  const Ray ray = ray_through(pose, pointer, size);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!slices.shown[axis]) continue;
    const std::array<glm::dvec3, 4> corners = slice_corners(grid, slices, axis);
    for (std::size_t i = 0; i < 4; ++i) {
      const glm::dvec3 from = world(corners[i]), to = world(corners[(i + 1) % 4]);
      const auto seen_from = pixel_that_sees(pose, from, size), seen_to = pixel_that_sees(pose, to, size);
      if (!seen_from || !seen_to) continue;
      const float distance = distance_to_segment(*seen_from, *seen_to, pointer);
      if (!(distance <= least)) continue;
      least = distance;
      const double part = std::clamp(nearest_along(from, to - from, ray).value_or(0.5), 0.0, 1.0);
      glm::dvec3 first(0), last(0);
      last[static_cast<int>(axis)] = (grid.whole()[axis] - 1.0) / grid.fineness(axis);
      const glm::dvec3 point = from + (to - from) * part;
      const glm::dvec3 across = world(grid.place_of(last)) - world(grid.place_of(first));
      nearest = SliceGrip{axis, point, across, slices.places[axis], pointer, !nearest_along(point, across, ray)};
    }
  }
  return nearest;
}

float dragged_place(const SliceGrip& grip, const Pose& pose, const glm::vec2& size, const glm::vec2& pointer) {
  const double upwards = static_cast<double>((grip.pointer.y - pointer.y) / std::max(size.y, 1.0f));
  const double moved =
      grip.upwards ? upwards : nearest_along(grip.point, grip.across, ray_through(pose, pointer, size)).value_or(0);
  return std::clamp(grip.place + static_cast<float>(moved), 0.0f, 1.0f);
}

}  // namespace gs::app
