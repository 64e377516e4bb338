#pragma once

#include "qnv/codecs/outlines/grouping/outline_groups.h"

#include <catch2/catch.hpp>
#include <glm/geometric.hpp>

#include <array>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <numbers>
#include <utility>
#include <variant>
#include <vector>

/// Polygon models with known groups.
namespace gs::qnv {

inline void add_polygon(PolygonModel& model, const std::vector<glm::vec3>& polygon, std::uint32_t appearance = 0) {
  for (const glm::vec3& p : polygon) {
    model.corners.push_back(static_cast<std::uint32_t>(model.positions.size()));
    model.positions.push_back(p);
  }
  model.ends.push_back(static_cast<std::uint32_t>(model.corners.size()));
  model.appearances.push_back(appearance);
}

/// Adds a square of edge 1 in the plane z = 0, with its lower left corner at x, y.
inline void add_square(PolygonModel& model, float x, float y, std::uint32_t appearance = 0) {
  add_polygon(model, {{x, y, 0}, {x + 1, y, 0}, {x + 1, y + 1, 0}, {x, y + 1, 0}}, appearance);
}

/// Adds the cube 0..1 as twelve triangles that face outwards or inwards.
inline void add_cube(PolygonModel& model, bool inside_out = false) {
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side) {
      const auto corner = [&](int u, int v) {
        glm::vec3 p(0);
        p[axis] = static_cast<float>(side);
        p[(axis + 1) % 3] = static_cast<float>(u);
        p[(axis + 2) % 3] = static_cast<float>(v);
        return p;
      };
      std::array<glm::vec3, 4> ring{corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)};
      if ((side == 0) != inside_out) std::swap(ring[1], ring[3]);
      add_polygon(model, {ring[0], ring[1], ring[2]});
      add_polygon(model, {ring[0], ring[2], ring[3]});
    }
}

/// Returns a unit sphere around the origin: a subdivided octahedron.
inline PolygonModel sphere_model(int divisions) {
  PolygonModel model;
  for (int octant = 0; octant < 8; ++octant) {
    const glm::vec3 sign(octant & 1 ? -1 : 1, octant & 2 ? -1 : 1, octant & 4 ? -1 : 1);
    const bool mirrored = sign.x * sign.y * sign.z < 0;
    const auto at = [&](int i, int j) {
      const glm::vec3 p(static_cast<float>(i), static_cast<float>(j), static_cast<float>(divisions - i - j));
      return glm::normalize(p) * sign;
    };
    const auto add = [&](const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
      add_polygon(model, mirrored ? std::vector{a, c, b} : std::vector{a, b, c});
    };
    for (int i = 0; i < divisions; ++i)
      for (int j = 0; i + j < divisions; ++j) {
        add(at(i, j), at(i + 1, j), at(i, j + 1));
        if (i + j + 1 < divisions) add(at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
      }
  }
  return model;
}

inline OutlineGroups groups_of(const PolygonModel& model, const OutlineOptions& options = {}) {
  auto made = group_outlines(model, options);
  if (const auto* error = std::get_if<OutlineError>(&made)) FAIL(error->message);
  return std::move(std::get<OutlineGroups>(made));
}

/// Returns the polygons that are finally shown.
inline const OutlinePolygons& surface_of(const OutlineGroup& group) {
  return group.inner.empty() ? group.outline : group.inner;
}

/// Returns the vector area of positions.
template <typename Positions>
glm::dvec3 vector_area(const Positions& ring) {
  glm::dvec3 sum(0);
  for (std::size_t i = 0; i < ring.size(); ++i)
    sum += glm::cross(glm::dvec3(ring[i]) - glm::dvec3(ring[0]),
                      glm::dvec3(ring[(i + 1) % ring.size()]) - glm::dvec3(ring[0]));
  return sum / 2.0;
}

inline double area_of(const OutlinePolygons& polygons) {
  double area = 0;
  for (const double part : polygons.areas) area += part;
  return area;
}

}  // namespace gs::qnv
