#include "render/text/glyph_outline.h"

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

namespace gs::render {
namespace {

using glm::dvec2;
using Polygon = std::vector<dvec2>;

double cross(const dvec2& a, const dvec2& b) { return a.x * b.y - a.y * b.x; }

double area_of(const Polygon& polygon) {
  double sum = 0;
  for (std::size_t i = 0, before = polygon.size() - 1; i < polygon.size(); before = i++)
    sum += cross(polygon[before] - polygon[0], polygon[i] - polygon[0]);
  return sum / 2;
}

/// Returns the winding number of a polygon around a point; positive if counter-clockwise.
int winding(const Polygon& polygon, const dvec2& point) {
  int turns = 0;
  for (std::size_t i = 0, before = polygon.size() - 1; i < polygon.size(); before = i++) {
    const dvec2 &a = polygon[before], &b = polygon[i];
    if ((a.y <= point.y) == (b.y <= point.y)) continue;
    const double side = cross(b - a, point - a);
    if (a.y <= point.y && side > 0) ++turns;
    if (a.y > point.y && side < 0) --turns;
  }
  return turns;
}

double distance_to_segment(const dvec2& point, const dvec2& a, const dvec2& b) {
  const dvec2 along = b - a;
  const double square = glm::dot(along, along);
  const double t = square > 0 ? std::clamp(glm::dot(point - a, along) / square, 0.0, 1.0) : 0.0;
  return glm::length(point - a - t * along);
}

/// Returns a point inside the polygon, near the middle of its longest edge. `area` is the signed area.
dvec2 place_inside(const Polygon& polygon, double area) {
  // Step inwards from the middle of the longest edge by a ten-thousandth of its length. No part of a glyph is thinner.
  std::size_t longest = 0;
  double most = -1;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const double length = glm::length(polygon[(i + 1) % polygon.size()] - polygon[i]);
    if (length > most) most = length, longest = i;
  }
  const dvec2 a = polygon[longest], b = polygon[(longest + 1) % polygon.size()];
  const dvec2 inwards = (area > 0 ? dvec2(a.y - b.y, b.x - a.x) : dvec2(b.y - a.y, a.x - b.x)) * 1e-4;
  return (a + b) * 0.5 + inwards;
}

double turn(const dvec2& a, const dvec2& b, const dvec2& c) { return cross(b - a, c - a); }

/// Reports whether the segment from a corner to a point begins inside the counter-clockwise polygon. Bridges make
/// corners coincide; the segment begins inside at only one of them.
bool sees(const Polygon& polygon, std::size_t corner, const dvec2& point) {
  const dvec2 &at = polygon[corner], &before = polygon[corner == 0 ? polygon.size() - 1 : corner - 1],
              &next = polygon[corner + 1 == polygon.size() ? 0 : corner + 1];
  const double of_next = turn(at, next, point), of_before = turn(before, at, point);
  return turn(before, at, next) > 0 ? of_next >= 0 && of_before >= 0 : of_next > 0 || of_before > 0;
}

struct Hole {
  const Polygon* polygon;
  std::size_t rightmost;
};

/// Joins a hole to the polygon by a bridge from the hole's rightmost corner to the right.
void join(Polygon& outer, const Polygon& hole, std::size_t rightmost) {
  const dvec2 from = hole[rightmost];
  // Find the first edge that the ray to the right hits.
  double nearest = INFINITY;
  std::size_t edge = outer.size();
  for (std::size_t i = 0, before = outer.size() - 1; i < outer.size(); before = i++) {
    const dvec2 &a = outer[before], &b = outer[i];
    if ((a.y <= from.y) == (b.y <= from.y)) continue;
    const double x = a.x + (b.x - a.x) * (from.y - a.y) / (b.y - a.y);
    if (x >= from.x && x < nearest) nearest = x, edge = i;
  }
  if (edge == outer.size()) return;  // the contours cross each other: fill the hole
  // End of the bridge: the right end of that edge, or the corner before it with the smallest angle.
  const std::size_t before = edge == 0 ? outer.size() - 1 : edge - 1;
  std::size_t to = outer[before].x > outer[edge].x ? before : edge;
  const dvec2 hit(nearest, from.y), end = outer[to];
  const double sign = turn(from, hit, end) >= 0 ? 1 : -1;
  double flattest = INFINITY, closest = INFINITY;
  for (std::size_t i = 0; i < outer.size(); ++i) {
    const dvec2& p = outer[i];
    const bool in_the_way =
        sign * turn(from, hit, p) >= 0 && sign * turn(hit, end, p) >= 0 && sign * turn(end, from, p) >= 0;
    if (p.x < from.x || !(p == end || in_the_way) || !sees(outer, i, from)) continue;
    const double way = p.x - from.x, slope = way > 0 ? std::abs(p.y - from.y) / way : INFINITY;
    if (slope < flattest || (slope == flattest && way < closest)) flattest = slope, closest = way, to = i;
  }
  Polygon joined;
  joined.reserve(outer.size() + hole.size() + 2);
  joined.insert(joined.end(), outer.begin(), outer.begin() + static_cast<std::ptrdiff_t>(to) + 1);
  for (std::size_t i = 0; i <= hole.size(); ++i) joined.push_back(hole[(rightmost + i) % hole.size()]);
  joined.insert(joined.end(), outer.begin() + static_cast<std::ptrdiff_t>(to), outer.end());
  outer = std::move(joined);
}

void keep_between(const Polygon& contour, std::size_t first, std::size_t last, double tolerance,
                  std::vector<bool>& kept) {
  std::vector<std::pair<std::size_t, std::size_t>> open{{first, last}};
  while (!open.empty()) {
    const auto [low, high] = open.back();
    open.pop_back();
    double most = tolerance;
    std::size_t farthest = low;
    for (std::size_t i = low + 1; i < high; ++i) {
      const double distance = distance_to_segment(contour[i], contour[low], contour[high % contour.size()]);
      if (distance > most) most = distance, farthest = i;
    }
    if (farthest == low) continue;
    kept[farthest] = true;
    open.push_back({low, farthest});
    open.push_back({farthest, high});
  }
}

}  // namespace

std::vector<dvec2> simplified(const std::vector<dvec2>& given, double tolerance) {
  if (given.size() <= 3) return given;
  // Split the contour at its leftmost corner and at the corner farthest from that.
  Polygon contour = given;
  const auto left = std::min_element(contour.begin(), contour.end(),
                                     [](const dvec2& a, const dvec2& b) { return a.x != b.x ? a.x < b.x : a.y < b.y; });
  std::rotate(contour.begin(), left, contour.end());
  std::size_t far = 0;
  for (std::size_t i = 1; i < contour.size(); ++i)
    if (glm::length(contour[i] - contour[0]) > glm::length(contour[far] - contour[0])) far = i;
  if (far == 0) return given;
  std::vector<bool> kept(contour.size(), false);
  kept[0] = kept[far] = true;
  keep_between(contour, 0, far, tolerance, kept);
  keep_between(contour, far, contour.size(), tolerance, kept);
  if (std::count(kept.begin(), kept.end(), true) < 3) {
    // The contour is thinner than the tolerance, so keep its widest point.
    double most = 0;
    std::size_t widest = 0;
    for (std::size_t i = 1; i < contour.size(); ++i) {
      const double width = std::abs(cross(contour[far] - contour[0], contour[i] - contour[0]));
      if (width > most) most = width, widest = i;
    }
    kept[widest] = true;
  }
  Polygon result;
  for (std::size_t i = 0; i < contour.size(); ++i)
    if (kept[i]) result.push_back(contour[i]);
  return result;
}

vrml::GlyphShape fill(const Contours& contours, vrml::PolygonTriangulator& triangulator) {
  struct Part {
    Polygon polygon;
    double area;
    dvec2 inside;
  };
  std::vector<Part> outers, holes;
  for (const Polygon& contour : contours) {
    if (contour.size() < 3) continue;
    const double area = area_of(contour);
    if (area == 0 || !std::isfinite(area)) continue;
    const dvec2 inside = place_inside(contour, area);
    int around = 0;
    for (const Polygon& other : contours)
      if (&other != &contour && other.size() >= 3) around += winding(other, inside);
    const int within = around + (area > 0 ? 1 : -1);
    if ((around == 0) == (within == 0)) continue;  // both sides of the contour are inside the glyph
    Part part{contour, area, inside};
    const bool outer = around == 0;
    // Make outer contours counter-clockwise and holes clockwise.
    if ((area > 0) != outer) std::reverse(part.polygon.begin(), part.polygon.end());
    (outer ? outers : holes).push_back(std::move(part));
  }
  std::vector<std::vector<Hole>> holes_of(outers.size());
  for (const Part& hole : holes) {
    std::size_t best = outers.size();
    for (std::size_t i = 0; i < outers.size(); ++i)
      if (winding(outers[i].polygon, hole.inside) != 0 &&
          (best == outers.size() || std::abs(outers[i].area) < std::abs(outers[best].area)))
        best = i;
    if (best == outers.size()) continue;
    const auto right = std::max_element(hole.polygon.begin(), hole.polygon.end(),
                                        [](const dvec2& a, const dvec2& b) { return a.x < b.x; });
    holes_of[best].push_back({&hole.polygon, static_cast<std::size_t>(right - hole.polygon.begin())});
  }

  vrml::GlyphShape shape;
  std::vector<glm::vec3> corners;
  for (std::size_t i = 0; i < outers.size(); ++i) {
    Polygon& polygon = outers[i].polygon;
    // Join the rightmost hole first. No bridge then crosses a hole that is not joined yet.
    std::sort(holes_of[i].begin(), holes_of[i].end(),
              [](const Hole& a, const Hole& b) { return (*a.polygon)[a.rightmost].x > (*b.polygon)[b.rightmost].x; });
    for (const Hole& hole : holes_of[i]) join(polygon, *hole.polygon, hole.rightmost);
    corners.clear();
    for (const dvec2& p : polygon) corners.emplace_back(glm::vec2(p), 0);
    const auto first = static_cast<std::uint32_t>(shape.points.size());
    for (const std::uint32_t corner : triangulator.triangulate(corners)) shape.triangles.push_back(first + corner);
    for (const dvec2& p : polygon) shape.points.emplace_back(p);
  }
  return shape;
}

}  // namespace gs::render
