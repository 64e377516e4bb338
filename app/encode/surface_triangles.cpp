#include "app/encode/surface_triangles.h"
#include "qnv/base/finite.h"

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

namespace gs::app {
namespace {

using qnv::finite;

constexpr std::size_t kTriangleBatch = 4096;
// A textured triangle is divided until its pieces are this many texels long, but not more often than this.
constexpr float kTexels = 2;
constexpr int kMostDivisions = 7;

// One coordinate of a texture, in texels.
std::uint32_t texel(float at, std::uint32_t size, bool repeat) {
  if (!std::isfinite(at)) return 0;
  at = repeat ? at - std::floor(at) : std::clamp(at, 0.0f, 1.0f);
  return std::min(static_cast<std::uint32_t>(at * static_cast<float>(size)), size - 1);
}

// VRML97 Table 4.6: RGB textures replace the colour, intensity textures are multiplied with it.
glm::vec3 sample(const render::TextureUse& texture, const glm::vec2& at, const glm::vec3& color) {
  const render::Image& image = *texture.image;
  const glm::vec3 p = texture.transform * glm::vec3(at, 1.0f);
  const std::uint32_t x = texel(p.x, image.width, texture.repeat_s), y = texel(p.y, image.height, texture.repeat_t);
  const std::size_t row = image.height - 1 - y;  // t runs upwards
  const std::uint8_t* c = image.pixels.data() + (row * image.width + x) * image.components;
  if (image.components < 3) return color * (static_cast<float>(c[0]) / 255.0f);
  return {static_cast<float>(c[0]) / 255.0f, static_cast<float>(c[1]) / 255.0f, static_cast<float>(c[2]) / 255.0f};
}

struct SurfaceCorner {
  glm::vec3 position, normal, color;
  glm::vec2 texture;
};

class Emitter {
 public:
  Emitter(const render::DrawItem& item, const qnv::TriangleSink& sink, const glm::dvec3& origin)
      : item_(item), sink_(sink), place_(item.world_from_node) {
    place_[3] -= glm::dvec4(origin, 0);
    world_from_node_ = glm::mat3(item.world_from_node);
    // The adjugate stands for the inverse transpose and exists for singular matrices too.
    const glm::mat3& m = world_from_node_;
    normal_matrix_ = glm::mat3(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
    flipped_ = glm::dot(m[0], glm::cross(m[1], m[2])) < 0;
    if (flipped_) normal_matrix_ = -normal_matrix_;
    const render::TextureUse& t = item.texture;
    textured_ = t.image && t.image->components > 0 && t.image->width > 0 && t.image->height > 0 && !t.image->empty() &&
                item.mesh->texture_coordinates.size() == item.mesh->positions.size();
  }

  bool run() {
    const vrml::Mesh& mesh = *item_.mesh;
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
      std::array<SurfaceCorner, 3> corners;
      for (std::size_t k = 0; k < 3; ++k) corners[k] = corner(mesh, mesh.indices[i + k]);
      if (flipped_) std::swap(corners[1], corners[2]);
      if (!emit(corners, divisions(corners))) return false;
    }
    return flush();
  }

 private:
  SurfaceCorner corner(const vrml::Mesh& mesh, std::uint32_t index) const {
    SurfaceCorner c{};
    c.position = glm::vec3(place_ * glm::dvec4(mesh.positions[index], 1));
    if (mesh.normals.size() == mesh.positions.size()) {
      const glm::vec3 n = normal_matrix_ * mesh.normals[index];
      const float length = std::sqrt(glm::dot(n, n));
      if (length > 0 && std::isfinite(length)) c.normal = n / length;
    }
    c.color = item_.material.lit ? item_.material.diffuse + item_.material.emissive
                                 : (mesh.lit ? glm::vec3(1.0f) : item_.material.emissive);
    if (mesh.colors.size() == mesh.positions.size()) {
      const vrml::Color& v = mesh.colors[index];
      c.color = {v.r, v.g, v.b};
    }
    if (textured_) {
      c.texture = mesh.texture_coordinates[index];
      c.color = sample(item_.texture, c.texture, c.color);
    }
    return c;
  }

  int divisions(const std::array<SurfaceCorner, 3>& c) const {
    if (!textured_) return 0;
    const glm::vec2 size(static_cast<float>(item_.texture.image->width),
                         static_cast<float>(item_.texture.image->height));
    float longest = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const glm::vec2 d = (c[(i + 1) % 3].texture - c[i].texture) * size;
      longest = std::max(longest, std::sqrt(glm::dot(d, d)));
    }
    if (!std::isfinite(longest)) return 0;
    int n = 0;
    while (n < kMostDivisions && longest > kTexels) {
      longest *= 0.5f;
      ++n;
    }
    return n;
  }

  SurfaceCorner middle(const SurfaceCorner& a, const SurfaceCorner& b) const {
    SurfaceCorner c{};
    c.position = (a.position + b.position) * 0.5f;
    const glm::vec3 n = a.normal + b.normal;
    const float length = std::sqrt(glm::dot(n, n));
    if (length > 0) c.normal = n / length;
    c.texture = (a.texture + b.texture) * 0.5f;
    c.color = sample(item_.texture, c.texture, (a.color + b.color) * 0.5f);
    return c;
  }

  bool emit(const std::array<SurfaceCorner, 3>& c, int divisions) {
    if (divisions > 0) {
      const SurfaceCorner ab = middle(c[0], c[1]), bc = middle(c[1], c[2]), ca = middle(c[2], c[0]);
      return emit({c[0], ab, ca}, divisions - 1) && emit({ab, c[1], bc}, divisions - 1) &&
             emit({ca, bc, c[2]}, divisions - 1) && emit({ab, bc, ca}, divisions - 1);
    }
    qnv::Triangle triangle;
    for (std::size_t i = 0; i < 3; ++i) {
      if (!finite(c[i].position)) return true;
      triangle.positions[i] = c[i].position;
      triangle.normals[i] = c[i].normal;
      triangle.colors[i] = to_rgb8(c[i].color);
    }
    batch_.push_back(triangle);
    return batch_.size() < kTriangleBatch || flush();
  }

  bool flush() {
    const bool more = batch_.empty() || sink_(batch_);
    batch_.clear();
    return more;
  }

  const render::DrawItem& item_;
  const qnv::TriangleSink& sink_;
  glm::dmat4 place_;  // from the node's space to the world's from the origin
  glm::mat3 world_from_node_{1.0f}, normal_matrix_{1.0f};
  bool flipped_ = false, textured_ = false;
  std::vector<qnv::Triangle> batch_;
};

}  // namespace

bool has_surface(const render::DrawItem& item) {
  return item.mesh && item.mesh->primitive == vrml::Mesh::Primitive::triangles && !item.mesh->indices.empty();
}

std::uint8_t to_byte(float value) { return static_cast<std::uint8_t>(std::clamp(value, 0.0f, 1.0f) * 255.0f + 0.5f); }

qnv::Rgb8 to_rgb8(const glm::vec3& color) { return {to_byte(color.x), to_byte(color.y), to_byte(color.z)}; }

bool for_each_triangle(const render::RenderList& list, const qnv::TriangleSink& sink, const glm::dvec3& origin) {
  for (const render::DrawItem& item : list.items)
    if (has_surface(item) && !Emitter(item, sink, origin).run()) return false;
  return true;
}

SurfaceSummary summarize_surface(const render::RenderList& list) {
  SurfaceSummary summary;
  for (const render::DrawItem& item : list.items) {
    if (!has_surface(item)) continue;
    const vrml::Mesh& mesh = *item.mesh;
    summary.triangles += mesh.indices.size() / 3;
    summary.two_sided = summary.two_sided || !mesh.solid;
    summary.textured = summary.textured || item.texture.image != nullptr;
    for (const std::uint32_t index : mesh.indices) {
      const glm::dvec3 p(item.world_from_node * glm::dvec4(mesh.positions[index], 1));
      if (finite(p)) summary.box.add(p);
    }
  }
  return summary;
}

}  // namespace gs::app
