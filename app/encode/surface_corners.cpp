#include "app/encode/surface_corners.h"

#include <algorithm>

namespace gs::app {

std::uint8_t to_byte(float value) { return static_cast<std::uint8_t>(std::clamp(value, 0.0f, 1.0f) * 255.0f + 0.5f); }

qnv::Rgb8 to_rgb8(const glm::vec3& color) { return {to_byte(color.x), to_byte(color.y), to_byte(color.z)}; }

SurfaceCorners::SurfaceCorners(const vrml::Mesh& mesh, const glm::dmat4& world_from_node, const glm::vec3& color,
                               const glm::dvec3& origin)
    : mesh_(mesh),
      place_(world_from_node),
      color_(color),
      has_normals_(mesh.normals.size() == mesh.positions.size()),
      has_colors_(mesh.colors.size() == mesh.positions.size()) {
  place_[3] -= glm::dvec4(origin, 0);
  // Normals need the inverse transpose. The adjugate is proportional to it and exists for singular matrices, too.
  const glm::mat3 m(world_from_node);
  normal_matrix_ = glm::mat3(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
  flipped_ = glm::dot(m[0], glm::cross(m[1], m[2])) < 0;
  if (flipped_) normal_matrix_ = -normal_matrix_;
}

void SurfaceSummary::add(const vrml::Mesh& mesh, const glm::dmat4& world_from_node, const qnv::Shine& of_shape) {
  triangles += mesh.indices.size() / 3;
  if (!std::exchange(any_, true)) shine = of_shape;
  if (shine != of_shape) shine.reset();
  two_sided = two_sided || !mesh.solid;
  for (const std::uint32_t index : mesh.indices) {
    const glm::dvec3 p(world_from_node * glm::dvec4(mesh.positions[index], 1));
    if (finite(p)) box.add(p);
  }
}

}  // namespace gs::app
