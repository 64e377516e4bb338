#include "app/encode/outline_model.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>

namespace gs::app {
namespace {

constexpr float kSame = 0.9999f;  // min cosine of two normals that count as equal
constexpr float kBeyond = 3.1416f;  // radians; above the largest angle between faces

/// Returns an index for each vertex. Vertices at equal positions have the same index.
std::vector<std::uint32_t> welded(const vrml::Mesh& mesh) {
  std::vector<std::uint32_t> order(mesh.positions.size()), first(mesh.positions.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<std::uint32_t>(i);
  const auto key = [&](std::uint32_t i) {
    const glm::vec3 p = mesh.positions[i] + 0.0f;
    return std::array{std::bit_cast<std::uint32_t>(p.x), std::bit_cast<std::uint32_t>(p.y),
                      std::bit_cast<std::uint32_t>(p.z)};
  };
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t a, std::uint32_t b) { return std::pair(key(a), a) < std::pair(key(b), b); });
  for (std::size_t i = 0; i < order.size(); ++i)
    first[order[i]] = i > 0 && key(order[i]) == key(order[i - 1]) ? first[order[i - 1]] : order[i];
  return first;
}

struct Side {
  std::uint32_t low, high;  // indices from welded() of the ends
  std::uint32_t at_low, at_high, triangle;
};

glm::vec3 face_normal(const vrml::Mesh& mesh, std::size_t triangle) {
  const auto corner = [&](std::size_t k) { return mesh.positions[mesh.indices[3 * triangle + k]]; };
  const glm::vec3 n = glm::cross(corner(1) - corner(0), corner(2) - corner(0));
  const float length = std::sqrt(glm::dot(n, n));
  return length > 0 ? n / length : glm::vec3(0);
}

}  // namespace

float crease_angle_of(const vrml::Mesh& mesh) {
  if (mesh.normals.size() != mesh.positions.size() || mesh.indices.empty()) return 0;
  const std::vector<std::uint32_t> weld = welded(mesh);
  std::vector<Side> sides;
  sides.reserve(mesh.indices.size());
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3)
    for (std::size_t k = 0; k < 3; ++k) {
      std::uint32_t a = mesh.indices[i + k], b = mesh.indices[i + (k + 1) % 3];
      if (weld[a] > weld[b]) std::swap(a, b);
      if (weld[a] != weld[b]) sides.push_back({weld[a], weld[b], a, b, static_cast<std::uint32_t>(i / 3)});
    }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return std::array{a.low, a.high, a.triangle} < std::array{b.low, b.high, b.triangle};
  });
  std::vector<std::pair<float, bool>> edges;  // angle between the two faces; true if the normals are smooth
  std::size_t smooth = 0;
  for (std::size_t i = 0; i + 1 < sides.size(); ++i) {
    const Side &s = sides[i], &t = sides[i + 1];
    if (s.low != t.low || s.high != t.high) continue;
    const float cosine = glm::dot(face_normal(mesh, s.triangle), face_normal(mesh, t.triangle));
    if (cosine > kSame) continue;  // the faces are in one plane, so any angle fits
    const bool same = glm::dot(mesh.normals[s.at_low], mesh.normals[t.at_low]) > kSame &&
                      glm::dot(mesh.normals[s.at_high], mesh.normals[t.at_high]) > kSame;
    smooth += same ? 1 : 0;
    edges.emplace_back(std::acos(std::clamp(cosine, -1.0f, 1.0f)), same);
    ++i;
  }
  if (smooth == 0) return 0;
  // Choose the angle for which the fewest edges are wrong.
  std::sort(edges.begin(), edges.end());
  std::size_t wrong = smooth, least = smooth;  // number of wrong edges at angle 0
  float angle = 0;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    wrong = edges[i].second ? wrong - 1 : wrong + 1;
    if (wrong >= least) continue;
    least = wrong;
    angle = i + 1 < edges.size() ? (edges[i].first + edges[i + 1].first) / 2 : kBeyond;
  }
  return angle;
}

}  // namespace gs::app
