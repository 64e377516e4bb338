// Comparison of meshes with formulas: corners, and sets of triangles in any order and from any corner.
#pragma once

#include "tests/vrml/mesh_checks.h"

#include <glm/common.hpp>
#include <glm/vec2.hpp>

#include <array>
#include <cstdint>
#include <random>
#include <span>

namespace gs::vrml::test {

/// Random numbers, the same in every run.
class Random {
 public:
  explicit Random(std::uint32_t seed) : engine_(seed) {}

  int below(int end) { return static_cast<int>(engine_() % static_cast<std::uint32_t>(end)); }
  bool flip() { return below(2) == 0; }
  double between(double lower, double upper) { return lower + (upper - lower) * (engine_() / 4294967296.0); }
  float number(double lower, double upper) { return static_cast<float>(between(lower, upper)); }
  /// Returns a size from 1/100 to 100. Half of the sizes are below 1.
  float measure() { return static_cast<float>(std::pow(10.0, between(-2, 2))); }

 private:
  std::mt19937 engine_;
};

/// Corner of a triangle of a formula or a mesh.
struct FormulaCorner {
  glm::dvec3 position{0};
  glm::dvec2 texture_coordinate{0};
  glm::dvec3 normal{0};
  glm::dvec3 color{1};
};
using FormulaTriangle = std::array<FormulaCorner, 3>;

/// Compared parts of a corner besides its position.
struct FormulaParts {
  bool texture_coordinate = false, normal = false, color = false;
};

[[nodiscard]] inline FormulaTriangle triangle_of(const Mesh& mesh, std::size_t t) {
  FormulaTriangle triangle;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::uint32_t vertex = mesh.indices[3 * t + i];
    triangle[i].position = glm::dvec3(mesh.positions[vertex]);
    if (!mesh.texture_coordinates.empty())
      triangle[i].texture_coordinate = glm::dvec2(mesh.texture_coordinates[vertex]);
    if (!mesh.normals.empty()) triangle[i].normal = glm::dvec3(mesh.normals[vertex]);
    if (!mesh.colors.empty()) triangle[i].color = {mesh.colors[vertex].r, mesh.colors[vertex].g, mesh.colors[vertex].b};
  }
  return triangle;
}

[[nodiscard]] inline bool same_corner(const FormulaCorner& a, const FormulaCorner& b, double size,
                                      const FormulaParts& parts) {
  constexpr double kRounding = 4e-6;
  return glm::length(a.position - b.position) <= kRounding * size &&
         (!parts.texture_coordinate || glm::length(a.texture_coordinate - b.texture_coordinate) < 1e-4) &&
         (!parts.normal || glm::length(a.normal - b.normal) < 2e-3) &&
         (!parts.color || glm::length(a.color - b.color) < 1e-6);
}

/// Compares two triangles with the same orientation; they may begin at different corners.
[[nodiscard]] inline bool same_triangle(const FormulaTriangle& a, const FormulaTriangle& b, double size,
                                        const FormulaParts& parts) {
  for (std::size_t turn = 0; turn < 3; ++turn)
    if (same_corner(a[0], b[turn], size, parts) && same_corner(a[1], b[(turn + 1) % 3], size, parts) &&
        same_corner(a[2], b[(turn + 2) % 3], size, parts))
      return true;
  return false;
}

/// Counts expected triangles that the mesh lacks, and unexpected triangles of the mesh. `size` is the size of the
/// shape, which scales the tolerance.
struct Differences {
  std::size_t missing = 0, unexpected = 0;
};
[[nodiscard]] inline Differences differences(const Mesh& mesh, std::span<const FormulaTriangle> expected, double size,
                                             const FormulaParts& parts) {
  std::vector<FormulaTriangle> left;
  for (std::size_t t = 0; t < triangles_of(mesh); ++t) left.push_back(triangle_of(mesh, t));
  Differences result;
  for (const FormulaTriangle& wanted : expected) {
    const auto found = std::find_if(left.begin(), left.end(), [&](const FormulaTriangle& triangle) {
      return same_triangle(triangle, wanted, size, parts);
    });
    if (found == left.end()) {
      ++result.missing;
    } else {
      *found = left.back();
      left.pop_back();
    }
  }
  result.unexpected = left.size();
  return result;
}

/// Appends two triangles of a quadrilateral, cut at its first corner, counter-clockwise or reversed.
inline void add_quadrilateral(std::vector<FormulaTriangle>& triangles, const std::array<FormulaCorner, 4>& corners,
                              bool ccw) {
  for (std::size_t i = 2; i < 4; ++i) {
    FormulaTriangle triangle{corners[0], corners[i - 1], corners[i]};
    if (!ccw) std::swap(triangle[1], triangle[2]);
    triangles.push_back(triangle);
  }
}

/// Counts edges (by positions) without exactly two triangles in opposite directions; 0 for a closed surface.
[[nodiscard]] inline std::size_t open_edges(const Mesh& mesh) {
  std::vector<std::array<float, 6>> edges;
  for (std::size_t t = 0; t < triangles_of(mesh); ++t)
    for (std::size_t i = 0; i < 3; ++i) {
      const glm::vec3 a = mesh.positions[mesh.indices[3 * t + i]],
                      b = mesh.positions[mesh.indices[3 * t + (i + 1) % 3]];
      edges.push_back({a.x, a.y, a.z, b.x, b.y, b.z});
    }
  std::sort(edges.begin(), edges.end());
  std::size_t open = 0;
  for (const auto& edge : edges) {
    const std::array<float, 6> other{edge[3], edge[4], edge[5], edge[0], edge[1], edge[2]};
    const auto [first, last] = std::equal_range(edges.begin(), edges.end(), other);
    open += last - first != 1;
  }
  return open;
}

}  // namespace gs::vrml::test
