#include "render/scene/surface_mesh.h"

#include "qnv/base/shine.h"
#include "qnv/codecs/displaced/tessellation/patch_mesh.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gs::render {
namespace {

// Maximum triangles of a mesh for collision detection.
constexpr std::size_t kMaxMetTriangles = 16384;

vrml::Color color_of(const qnv::Rgb8& c) {
  return {static_cast<float>(c.r) / 255, static_cast<float>(c.g) / 255, static_cast<float>(c.b) / 255};
}

}  // namespace

std::shared_ptr<const vrml::Mesh> mesh_of_surface(const qnv::Geometry& geometry, bool pictured) {
  if (const auto* patches = geometry.as<qnv::SurfacePatches>())
    return mesh_of_cut(*patches, qnv::even_cut(*patches, kMaxMetTriangles));
  auto mesh = std::make_shared<vrml::Mesh>();
  const auto* surface = geometry.as<qnv::IndexedMesh>();
  if (!surface) return mesh;
  // Vertices with a texture are last.
  const std::size_t border = surface->first_textured(), first = pictured ? border : 0,
                    count = (pictured ? surface->size() : border) - first;
  const auto middle = std::ranges::find_if(surface->triangles, [&](std::uint32_t v) { return v >= border; });
  std::vector<std::uint32_t> indices;
  for (auto at = pictured ? middle : surface->triangles.begin(); at != (pictured ? surface->triangles.end() : middle);
       ++at)
    indices.push_back(*at - static_cast<std::uint32_t>(first));
  const auto positions = std::span(surface->positions).subspan(first, count);
  mesh->positions = Array<glm::vec3>(positions);
  mesh->normals = Array<glm::vec3>(std::span(surface->normals).subspan(first, count));
  mesh->indices = Array<std::uint32_t>(std::span<const std::uint32_t>(indices));
  mesh->solid = !surface->description.two_sided;
  if (pictured) {
    mesh->texture_coordinates = Array<glm::vec2>(std::span<const glm::vec2>(surface->texture_coordinates));
  } else if (!surface->colors.empty()) {
    std::vector<vrml::Color> colors;
    colors.reserve(count);
    for (std::size_t v = 0; v < count; ++v) colors.push_back(color_of(surface->colors[v]));
    mesh->colors = Array<vrml::Color>(std::span<const vrml::Color>(colors));
  }
  for (const glm::vec3& p : positions) mesh->bounds.add(p);
  return mesh;
}

std::shared_ptr<const vrml::Mesh> mesh_of_cut(const qnv::SurfacePatches& surface, const qnv::SurfaceCut& cut) {
  auto mesh = std::make_shared<vrml::Mesh>();
  bool colored = false;
  for (const auto& part : surface.parts) colored = colored || part->colored();
  std::vector<glm::vec3> positions, normals;
  std::vector<vrml::Color> colors;
  std::vector<std::uint32_t> indices;
  qnv::PatchMesh patch;
  for (const qnv::PatchCut& one : cut.patches) {
    patch.build(*surface.parts[one.part], one);
    const auto first = static_cast<std::uint32_t>(positions.size());
    for (const qnv::PatchVertex& v : patch.vertices()) {
      positions.push_back(v.position);
      normals.push_back(qnv::unpack_direction(v.normal));
    }
    for (std::size_t i = 0; colored && i < patch.vertices().size(); ++i)
      colors.push_back(color_of(patch.colors().empty() ? surface.color : patch.colors()[i]));
    for (const auto& triangles : {patch.inner(), patch.border()})
      for (const qnv::PatchMesh::Triangle& t : triangles)
        for (const auto corner : t) indices.push_back(first + corner);
  }
  mesh->positions = Array<glm::vec3>(std::span<const glm::vec3>(positions));
  mesh->normals = Array<glm::vec3>(std::span<const glm::vec3>(normals));
  mesh->indices = Array<std::uint32_t>(std::span<const std::uint32_t>(indices));
  if (colored) mesh->colors = Array<vrml::Color>(std::span<const vrml::Color>(colors));
  mesh->solid = !surface.description.two_sided;
  const Box box = surface.box();
  mesh->bounds.add(box.lower);
  mesh->bounds.add(box.upper);
  return mesh;
}

void dress_surface(DrawItem& item) {
  if (!item.surface || item.material.lit) return;
  const qnv::Rgb8& own = item.surface->color();
  item.material = Material{};
  item.material.diffuse = glm::vec3(own.r, own.g, own.b) / 255.0f;
  const qnv::Shine shine = qnv::shine_of(item.surface->description());
  item.material.specular = shine.specular;
  item.material.shininess = shine.shininess;
}

}  // namespace gs::render
