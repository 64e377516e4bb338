#pragma once

#include "qnv/mesh/manifold.h"
#include "tests/qnv/surface_shapes.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <numbers>
#include <set>
#include <utility>
#include <vector>

// Surfaces with shared vertices, for tests of displaced streams.
namespace gs::qnv::displaced {

/// Returns a unit sphere of 8 n^2 triangles: a subdivided octahedron.
inline Triangles ball(int n, const std::function<Rgb8(const glm::vec3&)>& color = {}) {
  Triangles out;
  const auto put = [&](const std::array<glm::ivec3, 3>& corners, const glm::ivec3& sign) {
    Triangle t;
    const bool turned = sign.x * sign.y * sign.z < 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t to = turned && k > 0 ? 3 - k : k;
      t.positions[to] = glm::normalize(glm::vec3(corners[k] * sign));
      t.normals[to] = t.positions[to];
      if (color) t.colors[to] = color(t.positions[to]);
    }
    out.push_back(t);
  };
  for (int side = 0; side < 8; ++side) {
    const glm::ivec3 sign(side & 1 ? -1 : 1, side & 2 ? -1 : 1, side & 4 ? -1 : 1);
    for (int j = 0; j < n; ++j)
      for (int i = 0; i + j < n; ++i) {
        const auto at = [&](int x, int y) { return glm::ivec3(n - x - y, x, y); };
        put({at(i, j), at(i + 1, j), at(i, j + 1)}, sign);
        if (i + j + 1 < n) put({at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)}, sign);
      }
  }
  return out;
}

/// Connects a grid of positions to triangles; in a closed direction, the last row is connected to the first row.
inline Triangles woven(int u, int v, bool closed_u, bool closed_v, const std::function<glm::vec3(int, int)>& place) {
  Triangles out;
  const auto at = [&](int i, int j) { return place(closed_u ? i % u : i, closed_v ? j % v : j); };
  for (int j = 0; j < v; ++j)
    for (int i = 0; i < u; ++i) {
      out.push_back(triangle_of(at(i, j), at(i + 1, j), at(i + 1, j + 1)));
      out.push_back(triangle_of(at(i, j), at(i + 1, j + 1), at(i, j + 1)));
    }
  return out;
}

inline Triangles torus(int u, int v) {
  return woven(u, v, true, true, [=](int i, int j) {
    const double a = 2 * std::numbers::pi * i / u, b = 2 * std::numbers::pi * j / v;
    const double r = 1 + 0.4 * std::cos(b);
    return glm::vec3(r * std::cos(a), r * std::sin(a), 0.4 * std::sin(b));
  });
}

/// Returns a sheet with waves, noise and a hole in its middle.
inline Triangles sheet(int n) {
  Triangles all = woven(n, n, false, false, [=](int i, int j) {
    const double x = 2.0 * i / n - 1, y = 2.0 * j / n - 1;
    const auto noise = static_cast<double>((i * 7919 + j * 104729) % 101) / 101 - 0.5;
    return glm::vec3(x, y, 0.2 * std::sin(4 * x) * std::cos(3 * y) + 0.1 / n * noise);
  });
  std::erase_if(all, [](const Triangle& t) {
    const glm::vec3 m = (t.positions[0] + t.positions[1] + t.positions[2]) / 3.0f;
    return m.x * m.x + m.y * m.y < 0.06f;
  });
  return all;
}

/// Returns a wheel with 200 flat-shaded teeth: too many corners for a first stage.
inline Triangles wheel() {
  constexpr int kPlaces = 400;
  Triangles out;
  const auto at = [](int i, int h) {
    const double a = 2 * std::numbers::pi * (i % kPlaces) / kPlaces, r = i % 2 ? 1.0 : 0.86;
    return glm::vec3(r * std::cos(a), r * std::sin(a), 0.3 * h);
  };
  const auto flat = [&](const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
    Triangle t = triangle_of(a, b, c);
    t.normals.fill(glm::normalize(glm::cross(b - a, c - a)));
    out.push_back(t);
  };
  for (int i = 0; i < kPlaces; ++i) {
    flat(at(i, 0), at(i + 1, 0), at(i + 1, 1));
    flat(at(i, 0), at(i + 1, 1), at(i, 1));
    flat({0, 0, 0.3f}, at(i, 1), at(i + 1, 1));
    flat(glm::vec3(0), at(i + 1, 0), at(i, 0));
  }
  return out;
}

inline SurfaceMesh mesh_of(const Triangles& triangles, bool colored = false) {
  MeshBuilder builder(colored);
  builder.add(triangles);
  return builder.finish();
}

inline std::vector<Corners> corners_of(const SurfaceMesh& mesh) { return mesh.triangles; }

/// Counts each directed edge.
inline std::map<std::pair<std::uint32_t, std::uint32_t>, int> sides_of(const std::vector<Corners>& triangles) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> sides;
  for (const Corners& t : triangles)
    for (std::size_t k = 0; k < 3; ++k) ++sides[{t[k], t[(k + 1) % 3]}];
  return sides;
}

/// Reports whether each directed edge occurs once, so that an edge has at most two triangles, with the same
/// orientation.
inline bool sides_once(const std::vector<Corners>& triangles) {
  for (const auto& [side, times] : sides_of(triangles))
    if (times != 1) return false;
  return true;
}

/// Counts boundary edges.
inline std::size_t rims_of(const std::vector<Corners>& triangles) {
  const auto sides = sides_of(triangles);
  std::size_t rims = 0;
  for (const auto& [side, times] : sides) rims += sides.contains({side.second, side.first}) ? 0 : 1;
  return rims;
}

/// Reports whether the triangles around each vertex form one fan.
inline bool one_fan_a_vertex(const std::vector<Corners>& triangles) {
  std::map<std::uint32_t, std::map<std::uint32_t, std::uint32_t>> round;  // per vertex: next neighbour
  std::map<std::uint32_t, std::size_t> count;
  for (const Corners& t : triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      round[t[k]][t[(k + 1) % 3]] = t[(k + 2) % 3];
      ++count[t[k]];
    }
  for (const auto& [vertex, next] : round) {
    if (next.size() != count[vertex]) return false;
    std::set<std::uint32_t> ends;
    for (const auto& [a, b] : next) ends.insert(b);
    std::uint32_t start = next.begin()->first;
    for (const auto& [a, b] : next)
      if (!ends.contains(a)) start = a;
    std::size_t walked = 0;
    for (auto i = next.find(start); i != next.end() && walked <= next.size(); i = next.find(i->second)) {
      ++walked;
      if (i->second == start) break;
    }
    if (walked != next.size()) return false;
  }
  return true;
}

inline std::size_t vertices_used(const std::vector<Corners>& triangles) {
  std::set<std::uint32_t> used;
  for (const Corners& t : triangles) used.insert(t.begin(), t.end());
  return used.size();
}

/// Returns vertices - edges + triangles.
inline int euler_characteristic(const std::vector<Corners>& triangles) {
  const std::size_t edges = (triangles.size() * 3 + rims_of(triangles)) / 2;
  return static_cast<int>(vertices_used(triangles)) - static_cast<int>(edges) + static_cast<int>(triangles.size());
}

inline std::size_t components_of(const std::vector<Corners>& triangles) {
  std::map<std::uint32_t, std::uint32_t> parent;
  const auto find = [&](std::uint32_t v) {
    parent.try_emplace(v, v);
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (const Corners& t : triangles)
    for (std::size_t k = 0; k < 2; ++k) {
      const std::uint32_t a = find(t[k]), b = find(t[k + 1]);
      parent[a] = b;
    }
  std::size_t components = 0;
  for (const auto& [v, p] : parent) components += v == p ? 1 : 0;
  return components;
}

}  // namespace gs::qnv::displaced
