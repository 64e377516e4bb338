#include "render/scene/surface_mesh.h"

#include "qnv/codecs/displaced/tessellation/patch_mesh.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <system_error>
#include <vector>

namespace gs::render {
namespace {

// Maximum size of a mesh for collision detection.
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
  // Textured vertices come last.
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

std::vector<std::pair<std::string, std::string>> metadata_of(const Shine& shine) {
  if (shine.specular == glm::vec3(0)) return {};
  const auto text = [](float number) {
    std::array<char, 16> digits{};
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), number, std::chars_format::general, 4);
    return std::string(digits.data(), end.ptr);
  };
  const glm::vec3& s = shine.specular;
  return {{"specular", text(s.x) + " " + text(s.y) + " " + text(s.z)}, {"shininess", text(shine.shininess)}};
}

Shine shine_of(const qnv::Description& description) {
  Shine shine;
  const auto read = [](std::string_view text, std::span<float> numbers) {
    const char *at = text.data(), *const end = at + text.size();
    for (float& number : numbers) {
      while (at != end && *at == ' ') ++at;
      const auto [next, error] = std::from_chars(at, end, number);
      if (error != std::errc() || !(number >= 0 && number <= 1)) return false;
      at = next;
    }
    return at == end;
  };
  for (const auto& [key, value] : description.metadata) {
    std::array<float, 3> numbers{};
    if (key == "specular" && read(value, numbers)) shine.specular = {numbers[0], numbers[1], numbers[2]};
    if (key == "shininess" && read(value, std::span(numbers).first(1))) shine.shininess = numbers[0];
  }
  return shine;
}

void dress_surface(DrawItem& item) {
  if (!item.surface || item.material.lit) return;
  const qnv::Rgb8& own = item.surface->color();
  item.material = Material{};
  item.material.diffuse = glm::vec3(own.r, own.g, own.b) / 255.0f;
  const Shine shine = shine_of(item.surface->description());
  item.material.specular = shine.specular;
  item.material.shininess = shine.shininess;
}

}  // namespace gs::render
