#include "app/view/values/picked_values.h"

#include <cstddef>

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

}  // namespace gs::app
