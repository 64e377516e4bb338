#include "app/view/values/picked_values.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace gs::app {

std::optional<VectorValue> value_near(const qnv::Volume& volume, const glm::dvec3& place) {
  if (volume.empty() || volume.classes.size() != volume.size()) return std::nullopt;
  const glm::vec3 sought(place);
  std::size_t nearest = volume.size();
  float least = 0;
  for (std::size_t i = 0; i < volume.size(); ++i) {
    const glm::vec3 off = volume.positions[i] - sought;
    const float distance = off.x * off.x + off.y * off.y + off.z * off.z;
    if (!(nearest == volume.size() ? distance == distance : distance < least)) continue;
    nearest = i;
    least = distance;
  }
  if (nearest == volume.size()) return std::nullopt;
  const auto [low, high] = volume.description.value_range;
  VectorValue result;
  result.step = (static_cast<double>(high) - static_cast<double>(low)) / 255;
  result.value = static_cast<double>(low) + volume.classes[nearest] * result.step;
  if (volume.weights.size() == volume.size()) result.gradient = static_cast<double>(volume.weights[nearest]);
  return result;
}

std::optional<double> value_on(const ColorKey& key, const vrml::Mesh& mesh, const render::TriangleHit& hit) {
  const std::size_t first = std::size_t{hit.triangle} * 3;
  if (mesh.primitive != vrml::Mesh::Primitive::triangles || first + 3 > mesh.indices.size()) return std::nullopt;
  double value = 0;
  for (std::size_t corner = 0; corner < 3; ++corner) {
    const auto at = static_cast<std::size_t>(mesh.indices[first + corner]);
    if (at >= mesh.colors.size()) return std::nullopt;
    value += hit.weights[static_cast<int>(corner)] * key.value_of(mesh.colors[at]);
  }
  return value;
}

std::optional<ProjectedValue> projected_value(const VolumeGrid& grid, VolumeMode mode,
                                              const glm::dmat4& volume_from_world, const glm::dvec3& origin,
                                              const glm::dvec3& direction) {
  constexpr double kMostSteps = 8192, kStepsPerVoxel = 2;
  const auto voxel_at = [&](const glm::dvec3& place) {
    return grid.voxel_at(glm::dvec3(volume_from_world * glm::dvec4(place, 1)));
  };
  const glm::dvec3 from = voxel_at(origin), along = voxel_at(origin + direction) - from;
  double begin = 0, end = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    const double last = static_cast<double>(grid.dimensions()[static_cast<std::size_t>(axis)]) - 0.5;
    const double a = (-0.5 - from[axis]) / along[axis], b = (last - from[axis]) / along[axis];
    if (along[axis] == 0) {
      if (from[axis] < -0.5 || from[axis] > last) return std::nullopt;
      continue;
    }
    begin = std::max(begin, std::min(a, b));
    end = std::min(end, std::max(a, b));
  }
  if (!(begin < end) || !std::isfinite(end)) return std::nullopt;
  const double steps = std::clamp(std::ceil((end - begin) * glm::length(along) * kStepsPerVoxel), 1.0, kMostSteps);
  std::optional<ProjectedValue> found;
  double sum = 0, count = 0;
  for (double i = 0.5; i < steps; ++i) {
    const glm::dvec3 voxel = from + along * (begin + (end - begin) * (i / steps));
    const auto value = grid.nearest(voxel);
    if (!value) continue;
    sum += static_cast<double>(*value);
    ++count;
    const auto here = static_cast<double>(*value);
    if (!found || (mode == VolumeMode::minimum ? here < found->value : here > found->value))
      found = ProjectedValue{here, voxel};
  }
  if (found && mode == VolumeMode::average) found = ProjectedValue{sum / count, std::nullopt};
  return found;
}

}  // namespace gs::app
