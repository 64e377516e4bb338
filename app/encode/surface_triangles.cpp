#include "app/encode/surface_triangles.h"
#include "base/finite.h"

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <unordered_map>
#include <utility>
#include <vector>

namespace gs::app {
namespace {

// Textured triangles are subdivided: each edge is halved until it is kTexels long, at most kMaxDivisions times.
constexpr float kTexels = 2;
constexpr int kMaxDivisions = 7;

// An edge is curved if the cosine between its end normals exceeds kBentCosine. The midpoint moves by at most kMaxBend
// of the edge's length.
constexpr float kBentCosine = 0.5f, kMaxBend = 0.15f;

/// Subdivision of an edge: how often it is halved, and whether its midpoint follows the normals (`bent`) or stays on
/// the straight line.
struct EdgeCut {
  int halvings = 0;
  bool bent = false;
};
/// Subdivision of a triangle's edges. Edge k is from corner k to corner k + 1.
using EdgeCuts = std::array<EdgeCut, 3>;
struct SharedEdge {
  EdgeCut cut;
  std::array<glm::vec3, 2> normals;  // normals at the smaller and at the larger end, in the order of EdgePlaces
};
/// Key of an edge: the coordinates of both ends. The end that is smaller in the order x, y, z comes first.
using EdgePlaces = std::array<float, 6>;
struct HashEdge {
  std::size_t operator()(const EdgePlaces& edge) const {
    std::size_t hash = 0;
    for (const float f : edge) hash = (hash ^ std::hash<float>()(f)) * 0x9e3779b97f4a7c15u + (hash >> 29);
    return hash;
  }
};
bool before(const glm::vec3& a, const glm::vec3& b) { return std::array{a.x, a.y, a.z} < std::array{b.x, b.y, b.z}; }
EdgePlaces edge_places(const glm::vec3& a, const glm::vec3& b) {
  const glm::vec3 &least = before(a, b) ? a : b, &most = before(a, b) ? b : a;
  return {least.x, least.y, least.z, most.x, most.y, most.z};
}

// Converts a texture coordinate to the index of a texel.
std::uint32_t texel(float at, std::uint32_t size, bool repeat) {
  if (!std::isfinite(at)) return 0;
  at = repeat ? at - std::floor(at) : std::clamp(at, 0.0f, 1.0f);
  return std::min(static_cast<std::uint32_t>(at * static_cast<float>(size)), size - 1);
}

// Returns the colour at a texture coordinate. An RGB texture replaces `color`, an intensity texture multiplies it
// (VRML97 Table 4.6).
glm::vec3 sample(const render::TextureUse& texture, const glm::vec2& at, const glm::vec3& color) {
  const render::Image& image = *texture.image;
  const glm::vec3 p = texture.transform * glm::vec3(at, 1.0f);
  const std::uint32_t x = texel(p.x, image.width, texture.repeat_s), y = texel(p.y, image.height, texture.repeat_t);
  const std::size_t row = image.height - 1 - y;  // the texture coordinate t increases upwards
  const std::uint8_t* c = image.pixels.data() + (row * image.width + x) * image.components;
  if (image.components < 3) return color * (static_cast<float>(c[0]) / 255.0f);
  return {static_cast<float>(c[0]) / 255.0f, static_cast<float>(c[1]) / 255.0f, static_cast<float>(c[2]) / 255.0f};
}

class Emitter {
 public:
  Emitter(const render::DrawItem& item, const qnv::TriangleSink& sink, const glm::dvec3& origin)
      : item_(item),
        corners_(*item.mesh, item.world_from_node, color_of(item), origin),
        batches_(sink),
        textured_(shows_picture(item)) {}

  void run_whole(const WholeTriangleSink& sink) const {
    (void)each([&](const std::array<SurfaceCorner, 3>& corners) {
      std::array<glm::vec2, 3> at{};
      for (std::size_t k = 0; k < 3; ++k) {
        if (!finite(corners[k].position)) return true;
        const glm::vec3 p = item_.texture.transform * glm::vec3(corners[k].texture, 1.0f);
        if (textured_) at[k] = glm::vec2(std::isfinite(p.x) ? p.x : 0, std::isfinite(p.y) ? p.y : 0);
      }
      sink(item_, triangle_of(corners), at);
      return true;
    });
  }

  bool run() {
    if (textured_) (void)each([&](const auto& corners) { return measure_edges(corners); });
    const bool wanted = each([&](const auto& corners) {
      EdgeCuts cuts{};
      for (std::size_t k = 0; k < 3 && !edges_.empty(); ++k) {
        const auto edge = edges_.find(edge_places(corners[k].position, corners[(k + 1) % 3].position));
        if (edge != edges_.end()) cuts[k] = edge->second.cut;
      }
      return emit(corners, cuts, 0);
    });
    return wanted && batches_.flush();
  }

 private:
  static glm::vec3 color_of(const render::DrawItem& item) {
    return item.material.lit ? item.material.diffuse + item.material.emissive
                             : (item.mesh->lit ? glm::vec3(1.0f) : item.material.emissive);
  }
  SurfaceCorner corner(std::uint32_t index) const {
    SurfaceCorner c = corners_.corner(index);
    if (textured_) {
      c.texture = item_.mesh->texture_coordinates[index];
      c.color = sample(item_.texture, c.texture, c.color);
    }
    return c;
  }
  /// Calls `work` with the corners of each triangle. Stops when `work` returns false.
  template <class Work>
  bool each(const Work& work) const {
    return corners_.each([this](std::uint32_t index) { return corner(index); }, work);
  }

  int halvings_of(const glm::vec2& a, const glm::vec2& b) const {
    const glm::vec2 d = (b - a) * glm::vec2(static_cast<float>(item_.texture.image->width),
                                            static_cast<float>(item_.texture.image->height));
    float length = std::sqrt(glm::dot(d, d));
    if (!std::isfinite(length)) return 0;
    int n = 0;
    while (n < kMaxDivisions && length > kTexels) {
      length *= 0.5f;
      ++n;
    }
    return n;
  }

  // Records how to subdivide the edges of a triangle, so that the surface stays closed. The adjacent triangle with the
  // most texels gives the number of halvings. An edge is curved only if its adjacent triangles have the same normals
  // there.
  bool measure_edges(const std::array<SurfaceCorner, 3>& corners) {
    for (std::size_t k = 0; k < 3; ++k) {
      const SurfaceCorner *least = &corners[k], *most = &corners[(k + 1) % 3];
      const int halvings = halvings_of(least->texture, most->texture);
      if (halvings == 0) continue;
      if (before(most->position, least->position)) std::swap(least, most);
      const auto [at, fresh] = edges_.try_emplace(edge_places(least->position, most->position));
      SharedEdge& edge = at->second;
      if (fresh) {
        edge.normals = {least->normal, most->normal};
        edge.cut.bent = glm::dot(least->normal, most->normal) > kBentCosine;
      }
      edge.cut.bent = edge.cut.bent && edge.normals[0] == least->normal && edge.normals[1] == most->normal;
      edge.cut.halvings = std::max(edge.cut.halvings, halvings);
    }
    return true;
  }

  SurfaceCorner middle(const SurfaceCorner& a, const SurfaceCorner& b, bool bent) const {
    SurfaceCorner c{};
    c.position = (a.position + b.position) * 0.5f;
    if (bent) {
      // Move the midpoint half way to the tangent planes at both ends. For a circle, that is exact.
      const glm::vec3 half = (b.position - a.position) * 0.5f;
      const glm::vec3 off = 0.25f * (glm::dot(half, b.normal) * b.normal - glm::dot(half, a.normal) * a.normal);
      const float size = glm::length(off), most = kMaxBend * 2 * glm::length(half);
      if (size > 0) c.position += size > most ? off * (most / size) : off;
    }
    const glm::vec3 n = a.normal + b.normal;
    const float length = std::sqrt(glm::dot(n, n));
    if (length > 0) c.normal = n / length;
    c.texture = (a.texture + b.texture) * 0.5f;
    c.color = sample(item_.texture, c.texture, (a.color + b.color) * 0.5f);
    return c;
  }

  // Subdivides a triangle. The vertices on an edge depend only on that edge, so that the adjacent triangle gets the
  // same vertices. `depth` is the number of subdivisions so far.
  bool emit(const std::array<SurfaceCorner, 3>& c, const EdgeCuts& cuts, int depth) {
    const auto is_cut = [&](std::size_t k) { return cuts[k % 3].halvings > 0; };
    const int halved = is_cut(0) + is_cut(1) + is_cut(2);
    if (halved == 0) return batches_.add_finite(c);
    // Halvings of a new inner edge depend on its own length. They are limited, so that the depth stays within
    // kMaxDivisions.
    const auto inside = [&](const SurfaceCorner& a, const SurfaceCorner& b) {
      return EdgeCut{std::min(halvings_of(a.texture, b.texture), kMaxDivisions - depth - 1),
                     glm::dot(a.normal, b.normal) > kBentCosine};
    };
    const auto half = [&](std::size_t k) { return EdgeCut{cuts[k % 3].halvings - 1, cuts[k % 3].bent}; };
    const auto cut = [&](std::size_t k) {  // start at the smaller end, so that both triangles compute the same midpoint
      const SurfaceCorner &a = c[k % 3], &b = c[(k + 1) % 3];
      return before(b.position, a.position) ? middle(b, a, cuts[k % 3].bent) : middle(a, b, cuts[k % 3].bent);
    };
    if (halved == 3) {
      const SurfaceCorner ab = cut(0), bc = cut(1), ca = cut(2);
      const EdgeCut near_a = inside(ab, ca), near_b = inside(ab, bc), near_c = inside(bc, ca);
      return emit({c[0], ab, ca}, {half(0), near_a, half(2)}, depth + 1) &&
             emit({ab, c[1], bc}, {half(0), half(1), near_b}, depth + 1) &&
             emit({ca, bc, c[2]}, {near_c, half(1), half(2)}, depth + 1) &&
             emit({ab, bc, ca}, {near_b, near_c, near_a}, depth + 1);
    }
    // One or two edges are subdivided. Let k be the first of them; if there are two, edge k + 1 is the other.
    std::size_t k = 0;
    while (!is_cut(k) || (halved == 2 && !is_cut(k + 1))) ++k;
    const SurfaceCorner &p = c[k], &q = c[(k + 1) % 3], &r = c[(k + 2) % 3];
    const SurfaceCorner pq = cut(k);
    const EdgeCut across = inside(pq, r), last = cuts[(k + 2) % 3];
    if (halved == 1)
      return emit({p, pq, r}, {half(k), across, last}, depth + 1) &&
             emit({pq, q, r}, {half(k), cuts[(k + 1) % 3], across}, depth + 1);
    const SurfaceCorner qr = cut(k + 1);
    const EdgeCut near_q = inside(pq, qr);
    return emit({pq, q, qr}, {half(k), half(k + 1), near_q}, depth + 1) &&
           emit({pq, qr, r}, {near_q, half(k + 1), across}, depth + 1) &&
           emit({p, pq, r}, {half(k), across, last}, depth + 1);
  }

  const render::DrawItem& item_;
  SurfaceCorners corners_;
  TriangleBatches batches_;
  bool textured_;
  std::unordered_map<EdgePlaces, SharedEdge, HashEdge> edges_;  // edges to subdivide
};

}  // namespace

bool has_surface(const render::DrawItem& item) {
  return item.mesh && !item.volume && item.mesh->primitive == vrml::Mesh::Primitive::triangles &&
         !item.mesh->indices.empty();
}

bool shows_picture(const render::DrawItem& item) {
  const render::TextureUse& t = item.texture;
  return t.image && t.image->components > 0 && t.image->width > 0 && t.image->height > 0 && !t.image->empty() &&
         item.mesh->texture_coordinates.size() == item.mesh->positions.size();
}

void for_each_whole_triangle(const render::RenderList& list, const WholeTriangleSink& sink, const glm::dvec3& origin) {
  for (const render::DrawItem& item : list.items)
    if (has_surface(item)) Emitter(item, {}, origin).run_whole(sink);
}

bool for_each_triangle(const render::RenderList& list, const qnv::TriangleSink& sink, const glm::dvec3& origin) {
  for (const render::DrawItem& item : list.items)
    if (has_surface(item) && !Emitter(item, sink, origin).run()) return false;
  return true;
}

SurfaceSummary summarize_surface(const render::RenderList& list) {
  SurfaceSummary summary;
  for (const render::DrawItem& item : list.items) {
    if (!has_surface(item)) continue;
    const render::Material& material = item.material;
    summary.add(*item.mesh, item.world_from_node,
                material.lit ? qnv::Shine{material.specular, material.shininess} : qnv::Shine{});
    summary.textured = summary.textured || item.texture.image != nullptr;
  }
  return summary;
}

}  // namespace gs::app
