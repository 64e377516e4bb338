#pragma once

#include "qnv/base/triangles.h"
#include "qnv/base/voxels.h"
#include "qnv/codecs/octree/encode/encode_surface.h"
#include "qnv/codecs/shared/encode_options.h"
#include "tests/watched.h"

#include <catch2/catch.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <random>
#include <span>
#include <utility>
#include <variant>
#include <vector>

// Surfaces for tests of the surface encoder.
namespace gs::qnv {

using Triangles = std::vector<Triangle>;

inline Triangle triangle_of(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, const Rgb8& color = {}) {
  Triangle t;
  t.positions = {a, b, c};
  t.colors.fill(color);
  return t;
}

inline double area_of(const Triangle& t) {
  const glm::dvec3 a(t.positions[0]), b(t.positions[1]), c(t.positions[2]);
  return 0.5 * glm::length(glm::cross(b - a, c - a));
}

inline double area_of(const Triangles& triangles) {
  double area = 0;
  for (const Triangle& t : triangles) area += area_of(t);
  return area;
}

/// Returns a sphere of n by 2 n quadrilaterals that faces outwards.
inline Triangles sphere(int n, float radius = 1, const glm::vec3& center = {}, bool colored = false) {
  Triangles out;
  const auto at = [&](int i, int j) {
    const double a = std::numbers::pi * i / n, b = std::numbers::pi * (j % (2 * n)) / n;
    return center + radius * glm::vec3(std::sin(a) * std::cos(b), std::sin(a) * std::sin(b), std::cos(a));
  };
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < 2 * n; ++j) {
      const Rgb8 color = colored ? Rgb8{static_cast<std::uint8_t>(255 * i / n), static_cast<std::uint8_t>(127 * j / n),
                                        static_cast<std::uint8_t>(i > n / 2 ? 250 : 20)}
                                 : Rgb8{};
      // At the poles one of the two triangles has no area.
      if (i > 0) out.push_back(triangle_of(at(i, j), at(i + 1, j), at(i, j + 1), color));
      if (i + 1 < n) out.push_back(triangle_of(at(i + 1, j), at(i + 1, j + 1), at(i, j + 1), color));
    }
  return out;
}

/// Returns the surface of a box that faces outwards, with n^2 squares per side.
inline Triangles box_shape(const glm::vec3& lower, const glm::vec3& upper, int n = 1) {
  Triangles out;
  const glm::vec3 size = upper - lower;
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side)
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
          const auto at = [&](int di, int dj) {
            glm::vec3 p(0);
            p[axis] = static_cast<float>(side);
            p[(axis + 1) % 3] = static_cast<float>(i + di) / static_cast<float>(n);
            p[(axis + 2) % 3] = static_cast<float>(j + dj) / static_cast<float>(n);
            return lower + p * size;
          };
          if (side == 1) {
            out.push_back(triangle_of(at(0, 0), at(1, 0), at(1, 1)));
            out.push_back(triangle_of(at(0, 0), at(1, 1), at(0, 1)));
          } else {
            out.push_back(triangle_of(at(0, 0), at(1, 1), at(1, 0)));
            out.push_back(triangle_of(at(0, 0), at(0, 1), at(1, 1)));
          }
        }
  return out;
}

/// Returns an oblique square with triangles on both sides.
inline Triangles two_sided_sheet() {
  const glm::vec3 a(-1, -0.8f, -0.1f), b(1, -0.7f, 0.2f), c(1.05f, 0.9f, 0.3f), d(-0.95f, 0.8f, 0);
  return {triangle_of(a, b, c), triangle_of(a, c, d), triangle_of(c, b, a), triangle_of(d, c, a)};
}

inline Triangles random_triangles(std::size_t count, float extent, std::uint32_t seed) {
  std::mt19937 random(seed);
  const auto number = [&] { return extent * (static_cast<float>(random() % 2000001) / 1e6f - 1); };
  Triangles out;
  for (std::size_t i = 0; i < count; ++i) {
    const float size = i % 3 == 0 ? 1.0f : (i % 3 == 1 ? 0.1f : 0.004f);
    const glm::vec3 middle(number() * (1 - size), number() * (1 - size), number() * (1 - size));
    const auto corner = [&] { return middle + size * glm::vec3(number(), number(), number()); };
    const glm::vec3 a = corner(), b = corner(), c = corner();
    out.push_back(triangle_of(a, b, c, {static_cast<std::uint8_t>(random()), 7, 200}));
  }
  return out;
}

inline void check_sound(const IndexedMesh& geometry) {
  REQUIRE_EACH(geometry.normals.size() == geometry.size());
  REQUIRE_EACH(geometry.weights.size() == geometry.size());
  REQUIRE_EACH((geometry.colors.empty() || geometry.colors.size() == geometry.size()));
  for (const std::uint32_t v : geometry.triangles) REQUIRE_EACH(v < geometry.size());
  for (const float w : geometry.weights) REQUIRE_EACH((w > 0 && std::isfinite(w)));
  for (const glm::vec3& p : geometry.positions) REQUIRE_EACH(std::isfinite(p.x + p.y + p.z));
  for (const glm::vec3& n : geometry.normals) REQUIRE_EACH(std::abs(glm::length(n) - 1) < 1e-3f);
}

inline Box box_of(const Triangles& triangles) {
  Box box;
  for (const Triangle& t : triangles)
    for (const glm::vec3& p : t.positions) box.add(p);
  return box;
}

inline std::vector<Voxel> voxels_of(const Triangles& triangles, int level, unsigned threads = 0) {
  SurfaceVoxelizer voxelizer(Cube::around(box_of(triangles)), level, threads);
  voxelizer.add(triangles);
  return voxelizer.finish();
}

inline TriangleSource source_of(const Triangles& triangles) {
  return [&triangles](const TriangleSink& sink) {
    for (std::size_t i = 0; i < triangles.size(); i += 100)
      if (!sink(std::span(triangles).subspan(i, std::min<std::size_t>(100, triangles.size() - i)))) return false;
    return true;
  };
}

inline EncodedStream encoded(const Triangles& triangles, const EncodeOptions& options) {
  auto result = encode_surface(source_of(triangles), options);
  if (const auto* error = std::get_if<EncodeError>(&result)) FAIL(error->message);
  return std::get<EncodedStream>(std::move(result));
}

inline double total_weight(const VectorArrays& geometry) {
  double total = 0;
  for (const float weight : geometry.weights) total += weight;
  return total;
}

}  // namespace gs::qnv
