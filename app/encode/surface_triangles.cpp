#include "app/encode/surface_triangles.h"
#include "qnv/base/finite.h"

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <unordered_map>
#include <vector>

namespace gs::app {
namespace {

using qnv::finite;

constexpr std::size_t kTriangleBatch = 4096;
// The edges of a textured triangle are halved until they are this many texels long, but not more often than this.
constexpr float kTexels = 2;
constexpr int kMostDivisions = 7;

/// How often each edge of a triangle is halved: that from corner k to corner k + 1.
using Halvings = std::array<int, 3>;
/// The two ends of an edge, the lesser first.
using EdgePlaces = std::array<float, 6>;
struct HashEdge {
  std::size_t operator()(const EdgePlaces& edge) const {
    std::size_t hash = 0;
    for (const float f : edge) hash = (hash ^ std::hash<float>()(f)) * 0x9e3779b97f4a7c15u + (hash >> 29);
    return hash;
  }
};
EdgePlaces edge_places(const glm::vec3& a, const glm::vec3& b) {
  const std::array<float, 3> p{a.x, a.y, a.z}, q{b.x, b.y, b.z};
  const auto& least = p < q ? p : q;
  const auto& most = p < q ? q : p;
  return {least[0], least[1], least[2], most[0], most[1], most[2]};
}

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
    if (textured_) measure_edges(mesh);
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
      std::array<SurfaceCorner, 3> corners;
      for (std::size_t k = 0; k < 3; ++k) corners[k] = corner(mesh, mesh.indices[i + k]);
      if (flipped_) std::swap(corners[1], corners[2]);
      Halvings halvings{};
      for (std::size_t k = 0; k < 3 && !edges_.empty(); ++k) {
        const auto edge = edges_.find(edge_places(corners[k].position, corners[(k + 1) % 3].position));
        if (edge != edges_.end()) halvings[k] = edge->second;
      }
      if (!emit(corners, halvings, 0)) return false;
    }
    return flush();
  }

 private:
  SurfaceCorner corner(const vrml::Mesh& mesh, std::uint32_t index) const {
    SurfaceCorner c{};
    c.position = place_of(mesh, index);
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

  int halvings_of(const glm::vec2& a, const glm::vec2& b) const {
    const glm::vec2 d = (b - a) * glm::vec2(static_cast<float>(item_.texture.image->width),
                                            static_cast<float>(item_.texture.image->height));
    float length = std::sqrt(glm::dot(d, d));
    if (!std::isfinite(length)) return 0;
    int n = 0;
    while (n < kMostDivisions && length > kTexels) {
      length *= 0.5f;
      ++n;
    }
    return n;
  }

  // Two triangles may disagree how long an edge is in the texture: both halve it as often as the one with more texels,
  // so that the surface stays closed between them.
  void measure_edges(const vrml::Mesh& mesh) {
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3)
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t a = mesh.indices[i + k], b = mesh.indices[i + (k + 1) % 3];
        const int halvings = halvings_of(mesh.texture_coordinates[a], mesh.texture_coordinates[b]);
        if (halvings == 0) continue;
        int& most = edges_[edge_places(place_of(mesh, a), place_of(mesh, b))];
        most = std::max(most, halvings);
      }
  }

  glm::vec3 place_of(const vrml::Mesh& mesh, std::uint32_t index) const {
    return glm::vec3(place_ * glm::dvec4(mesh.positions[index], 1));
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

  // An edge is halved as often as its own number says, whatever the others of the triangle do: so the triangle on its
  // other side, which does the same, meets it in the same places. `depth`: times that a triangle was divided before.
  bool emit(const std::array<SurfaceCorner, 3>& c, const Halvings& halvings, int depth) {
    const auto halved = static_cast<std::size_t>((halvings[0] > 0) + (halvings[1] > 0) + (halvings[2] > 0));
    if (halved == 0) return put(c);
    // Edges inside are as long as they are; no triangle is divided more than kMostDivisions times.
    const auto inside = [&](const SurfaceCorner& a, const SurfaceCorner& b) {
      return std::min(halvings_of(a.texture, b.texture), kMostDivisions - depth - 1);
    };
    if (halved == 3) {
      const SurfaceCorner ab = middle(c[0], c[1]), bc = middle(c[1], c[2]), ca = middle(c[2], c[0]);
      const int a = halvings[0] - 1, b = halvings[1] - 1, d = halvings[2] - 1;
      const int near_a = inside(ab, ca), near_b = inside(ab, bc), near_c = inside(bc, ca);
      return emit({c[0], ab, ca}, {a, near_a, d}, depth + 1) && emit({ab, c[1], bc}, {a, b, near_b}, depth + 1) &&
             emit({ca, bc, c[2]}, {near_c, b, d}, depth + 1) &&
             emit({ab, bc, ca}, {near_b, near_c, near_a}, depth + 1);
    }
    // One edge, or of two the one that the other follows: from corner k on.
    std::size_t k = 0;
    while (halvings[k] == 0 || (halved == 2 && halvings[(k + 1) % 3] == 0)) ++k;
    const SurfaceCorner &p = c[k], &q = c[(k + 1) % 3], &r = c[(k + 2) % 3];
    const int along = halvings[k] - 1, next = halvings[(k + 1) % 3], last = halvings[(k + 2) % 3];
    const SurfaceCorner pq = middle(p, q);
    if (halved == 1) {
      const int across = inside(pq, r);
      return emit({p, pq, r}, {along, across, last}, depth + 1) && emit({pq, q, r}, {along, next, across}, depth + 1);
    }
    const SurfaceCorner qr = middle(q, r);
    const int near_q = inside(pq, qr), across = inside(pq, r);
    return emit({pq, q, qr}, {along, next - 1, near_q}, depth + 1) &&
           emit({pq, qr, r}, {near_q, next - 1, across}, depth + 1) && emit({p, pq, r}, {along, across, last}, depth + 1);
  }

  bool put(const std::array<SurfaceCorner, 3>& c) {
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
  std::unordered_map<EdgePlaces, int, HashEdge> edges_;  // that are halved: how often
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
