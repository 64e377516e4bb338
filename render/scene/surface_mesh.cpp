#include "render/scene/surface_mesh.h"

#include <span>
#include <vector>

namespace gs::render {

std::shared_ptr<const vrml::Mesh> mesh_of_surface(const qnv::Cloud& cloud) {
  auto mesh = std::make_shared<vrml::Mesh>();
  mesh->positions = vrml::Array<glm::vec3>(std::span<const glm::vec3>(cloud.positions));
  mesh->normals = vrml::Array<glm::vec3>(std::span<const glm::vec3>(cloud.normals));
  mesh->indices = vrml::Array<std::uint32_t>(std::span<const std::uint32_t>(cloud.triangles));
  mesh->solid = !cloud.description.two_sided;
  if (!cloud.colors.empty()) {
    std::vector<vrml::Color> colors;
    colors.reserve(cloud.colors.size());
    for (const qnv::Rgb8& c : cloud.colors)
      colors.push_back({static_cast<float>(c.r) / 255, static_cast<float>(c.g) / 255, static_cast<float>(c.b) / 255});
    mesh->colors = vrml::Array<vrml::Color>(std::span<const vrml::Color>(colors));
  }
  for (const glm::vec3& p : cloud.positions) mesh->bounds.add(p);
  return mesh;
}

void dress_surface(DrawItem& item) {
  if (!item.surface || item.material.lit) return;
  const qnv::Rgb8& own = item.surface->color;
  item.material = Material{};
  item.material.diffuse = glm::vec3(own.r, own.g, own.b) / 255.0f;
}

}  // namespace gs::render
