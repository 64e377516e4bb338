#pragma once

#include "qnv/codecs/outlines/grouping/outline_groups.h"
#include "qnv/container/outline_header.h"

#include <glm/geometric.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <random>
#include <span>
#include <utility>
#include <vector>

// Outline groups that are built directly, without grouping a model.
namespace gs::qnv::shapes {

using Ring = std::vector<glm::vec3>;

inline double area_of(const std::vector<Ring>& rings) {
  glm::dvec3 sum(0);
  for (const Ring& ring : rings)
    for (std::size_t i = 0; i < ring.size(); ++i)
      sum += glm::cross(glm::dvec3(ring[i]), glm::dvec3(ring[(i + 1) % ring.size()]));
  return glm::length(sum) / 2;
}

inline void add_polygon(OutlinePolygons& to, const std::vector<Ring>& rings,
                        const std::vector<glm::vec2>& texture_coordinates = {}) {
  for (const Ring& ring : rings) {
    to.positions.insert(to.positions.end(), ring.begin(), ring.end());
    to.ring_ends.push_back(static_cast<std::uint32_t>(to.positions.size()));
  }
  to.texture_coordinates.insert(to.texture_coordinates.end(), texture_coordinates.begin(), texture_coordinates.end());
  to.polygon_ends.push_back(static_cast<std::uint32_t>(to.ring_ends.size()));
  to.areas.push_back(area_of(rings));
}

/// Returns a group of one polygon.
inline OutlineGroup flat_group(const std::vector<Ring>& rings, std::uint32_t appearance = 0,
                               const std::vector<glm::vec2>& texture_coordinates = {}) {
  OutlineGroup group;
  group.appearance = appearance;
  group.polygons = 1;
  add_polygon(group.outline, rings, texture_coordinates);
  group.area = group.outline.areas.front();
  return group;
}

inline Ring square(glm::vec3 corner, float side) {
  return {corner, corner + glm::vec3(side, 0, 0), corner + glm::vec3(side, side, 0), corner + glm::vec3(0, side, 0)};
}

/// Returns a sphere of 2 * (rows - 1) * columns triangles. Each patch of `patch` x `patch` cells is a group with its
/// border as outline. Appearances alternate.
inline OutlineGroups sphere(int rows, int columns, int patch, std::uint32_t appearances = 1) {
  const auto at = [&](int row, int column) {
    const double polar = 3.14159265358979 * row / rows, azimuth = 2 * 3.14159265358979 * (column % columns) / columns;
    return glm::vec3(
        glm::dvec3(std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth), std::cos(polar)));
  };
  OutlineGroups groups;
  std::uint32_t number = 0;
  for (int row = 0; row < rows; row += patch)
    for (int column = 0; column < columns; column += patch) {
      OutlineGroup& group = groups.groups.emplace_back();
      group.appearance = number++ % appearances;
      const int last_row = std::min(row + patch, rows), last_column = std::min(column + patch, columns);
      Ring border;
      for (int i = row; i < last_row; ++i) border.push_back(at(i, column));
      for (int i = column; i < last_column; ++i) border.push_back(at(last_row, i));
      for (int i = last_row; i > row; --i) border.push_back(at(i, last_column));
      for (int i = last_column; i > column; --i) border.push_back(at(row, i));
      add_polygon(group.outline, {border});
      for (int i = row; i < last_row; ++i)
        for (int j = column; j < last_column; ++j) {
          const glm::vec3 a = at(i, j), b = at(i + 1, j), c = at(i + 1, j + 1), d = at(i, j + 1);
          if (i + 1 < rows) add_polygon(group.inner, {{a, b, c}});
          if (i > 0) add_polygon(group.inner, {{a, c, d}});
        }
      for (const double area : group.inner.areas) group.area += area;
      group.polygons = static_cast<std::uint32_t>(group.inner.size());
    }
  return groups;
}

/// Returns large rectangles of random size, position and direction.
inline OutlineGroups rectangles(std::size_t count, unsigned seed, bool along_axes) {
  std::mt19937 random(seed);
  const auto number = [&] { return static_cast<float>(random() % 100000) / 1000; };
  OutlineGroups groups;
  for (std::size_t i = 0; i < count; ++i) {
    glm::vec3 u(0), v(0);
    if (along_axes) {
      const int axis = static_cast<int>(random() % 3);
      u[(axis + 1) % 3] = number();
      v[(axis + 2) % 3] = number();
    } else {
      u = {number(), number(), number()};
      v = glm::cross(u, glm::vec3(number(), number(), number()));
      v *= number() / (glm::length(v) + 1e-3f);
    }
    const glm::vec3 corner(number(), number(), number());
    groups.groups.push_back(flat_group({{corner, corner + u, corner + u + v, corner + v}}));
  }
  return groups;
}

}  // namespace gs::qnv::shapes
