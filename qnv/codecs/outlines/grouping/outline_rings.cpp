#include "qnv/codecs/outlines/grouping/outline_parts.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace gs::qnv::outline {
namespace {

// Splits a ring at vertices that it visits repeatedly. The resulting rings touch there.
void split(const Mesh& mesh, const Ring& ring, std::vector<Ring>& to) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> order;  // pairs of vertex and index in the ring
  for (std::uint32_t i = 0; i < ring.size(); ++i) order.emplace_back(mesh.vertices[ring[i]], i);
  std::sort(order.begin(), order.end());
  bool twice = false;
  for (std::size_t i = 1; i < order.size() && !twice; ++i) twice = order[i - 1].first == order[i].first;
  if (!twice) {
    to.push_back(ring);
    return;
  }
  std::vector<std::uint32_t> number(ring.size());  // number of each position's vertex; equal vertices share one
  std::uint32_t count = 0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (i > 0 && order[i - 1].first != order[i].first) ++count;
    number[order[i].second] = count;
  }
  std::vector<std::uint8_t> open(count + std::size_t{1});
  std::vector<std::uint32_t> stack;  // indices of the current ring; no vertex occurs twice
  for (std::uint32_t i = 0; i < ring.size(); ++i) {
    if (open[number[i]]) {
      Ring part;
      std::uint32_t place = 0;
      do {
        place = stack.back();
        stack.pop_back();
        open[number[place]] = 0;
        part.push_back(ring[place]);
      } while (number[place] != number[i]);
      std::reverse(part.begin(), part.end());
      if (part.size() > 2) to.push_back(std::move(part));
    }
    open[number[i]] = 1;
    stack.push_back(i);
  }
  if (stack.size() < 3) return;
  Ring rest;
  for (const std::uint32_t place : stack) rest.push_back(ring[place]);
  to.push_back(std::move(rest));
}

std::vector<glm::dvec2> flattened(const Mesh& mesh, const Ring& ring, const PlaneAxes& axes) {
  std::vector<glm::dvec2> points;
  points.reserve(ring.size());
  for (const std::uint32_t h : ring) points.push_back(axes(mesh.position(h)));
  return points;
}

double area_of(const Mesh& mesh, const Ring& ring, const glm::dvec3& normal) {
  return glm::dot(ring_area(ring.size(), [&](std::size_t i) { return mesh.position(ring[i]); }), normal) / 2;
}

bool contains(const std::vector<glm::dvec2>& ring, const glm::dvec2& p) {
  bool inside = false;
  for (std::size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++)
    if ((ring[i].y > p.y) != (ring[j].y > p.y) &&
        p.x < ring[i].x + (p.y - ring[i].y) / (ring[j].y - ring[i].y) * (ring[j].x - ring[i].x))
      inside = !inside;
  return inside;
}

struct Segment {
  glm::dvec2 a, b;

  [[nodiscard]] double low(int axis) const { return std::min(a[axis], b[axis]); }
  [[nodiscard]] double high(int axis) const { return std::max(a[axis], b[axis]); }
};

// Reports whether two segments cross by more than `slack`. Segments that touch do not cross.
bool cross(const Segment& s, const Segment& t, double slack) {
  const double ls = glm::length(s.b - s.a) * slack, lt = glm::length(t.b - t.a) * slack;
  const double a = turn(s.a, s.b, t.a), b = turn(s.a, s.b, t.b);
  if (!((a > ls && b < -ls) || (a < -ls && b > ls))) return false;
  const double c = turn(t.a, t.b, s.a), d = turn(t.a, t.b, s.b);
  return (c > lt && d < -lt) || (c < -lt && d > lt);
}

// Reports whether any two segments cross. Sweeps along the axis in which the segments are shorter.
bool any_crossing(std::vector<Segment> segments, double slack) {
  glm::dvec2 extent(0), low(INFINITY), high(-INFINITY);
  for (const Segment& s : segments)
    for (int axis = 0; axis < 2; ++axis) {
      extent[axis] += s.high(axis) - s.low(axis);
      low[axis] = std::min(low[axis], s.low(axis));
      high[axis] = std::max(high[axis], s.high(axis));
    }
  const int along = extent.x * (high.y - low.y) <= extent.y * (high.x - low.x) ? 0 : 1, across = 1 - along;
  std::sort(segments.begin(), segments.end(),
            [&](const Segment& s, const Segment& t) { return s.low(along) < t.low(along); });
  std::uint64_t budget = 1000 * std::max<std::uint64_t>(segments.size(), 1000);
  for (std::size_t i = 0; i < segments.size(); ++i) {
    const Segment& s = segments[i];
    const double end = s.high(along), bottom = s.low(across), top = s.high(across);
    for (std::size_t j = i + 1; j < segments.size() && segments[j].low(along) <= end; ++j) {
      if (budget-- == 0) return true;
      const Segment& t = segments[j];
      if (t.low(across) <= top && t.high(across) >= bottom && cross(s, t, slack)) return true;
    }
  }
  return false;
}

}  // namespace

std::vector<Ring> boundary_rings(const Mesh& mesh, const std::vector<std::uint32_t>& labels,
                                 std::span<const std::uint32_t> faces, std::vector<std::uint8_t>& visited,
                                 std::uint8_t mark) {
  const auto inside = [&](std::uint32_t h) {  // reports whether the label continues across the edge
    return mesh.mates[h] != kNone && labels[mesh.faces[mesh.mates[h]]] == labels[mesh.faces[h]];
  };
  std::vector<Ring> rings;
  Ring ring;
  for (const std::uint32_t face : faces)
    for (std::uint32_t first = mesh.begins[face]; first < mesh.begins[face + 1]; ++first) {
      if ((visited[first] & mark) || inside(first)) continue;
      ring.clear();
      for (std::uint32_t h = first; !(visited[h] & mark);) {
        visited[h] |= mark;
        ring.push_back(h);
        h = mesh.next(h);
        while (inside(h)) h = mesh.next(mesh.mates[h]);  // turns around the vertex, across faces of the label
      }
      if (ring.size() > 2) split(mesh, ring, rings);
    }
  return rings;
}

bool bounds_surface(const Mesh& mesh, const std::vector<Ring>& rings, const glm::dvec3& normal, double area) {
  constexpr double kMaxBridging = 1e9;  // maximum number of holes times corners
  const PlaneAxes axes(normal);
  std::vector<Segment> segments;
  std::size_t outer = 0;
  double sum = 0;
  for (const Ring& ring : rings) {
    const double part = area_of(mesh, ring, normal);
    outer += part > 0;
    sum += part;
    const auto points = flattened(mesh, ring, axes);
    for (std::size_t i = 0; i < points.size(); ++i) segments.push_back({points[i], points[(i + 1) % points.size()]});
  }
  if (outer != 1 || !(std::fabs(sum - area) <= 1e-6 * area)) return false;
  if (static_cast<double>(rings.size() - 1) * static_cast<double>(segments.size()) > kMaxBridging) return false;
  return !any_crossing(std::move(segments), mesh.rounding);
}

void PolygonMaker::add_ring(const Ring& ring, bool textured, OutlinePolygons& to) const {
  for (const std::uint32_t h : ring) {
    to.positions.push_back(mesh_.positions[mesh_.vertices[h]]);
    if (textured) to.texture_coordinates.push_back(model_.texture_coordinates[mesh_.corners[h]]);
  }
  to.ring_ends.push_back(static_cast<std::uint32_t>(to.positions.size()));
}

void PolygonMaker::close_polygon(double area, OutlinePolygons& to) const {
  to.polygon_ends.push_back(static_cast<std::uint32_t>(to.ring_ends.size()));
  to.areas.push_back(area);
}

void PolygonMaker::add_face(std::uint32_t face, OutlinePolygons& to) const {
  const bool textured = !mesh_.corners.empty();
  const std::size_t first = to.positions.size();
  for (std::uint32_t h = mesh_.begins[face]; h < mesh_.begins[face + 1]; ++h) {
    if (!kept_[mesh_.vertices[h]]) continue;
    to.positions.push_back(mesh_.positions[mesh_.vertices[h]]);
    if (textured) to.texture_coordinates.push_back(model_.texture_coordinates[mesh_.corners[h]]);
  }
  if (to.positions.size() - first < 3) {
    to.positions.resize(first);
    if (textured) to.texture_coordinates.resize(first);
    return;
  }
  to.ring_ends.push_back(static_cast<std::uint32_t>(to.positions.size()));
  close_polygon(mesh_.areas[face], to);
}

void PolygonMaker::add(std::vector<Ring> rings, const glm::dvec3& normal, bool textured, OutlinePolygons& to) const {
  struct Outer {
    Ring ring;
    double area;
    std::vector<glm::dvec2> points;
    std::vector<std::size_t> holes;
  };
  std::vector<Outer> outers;
  std::vector<std::pair<double, Ring>> holes;
  for (Ring& ring : rings) {
    std::erase_if(ring, [&](std::uint32_t h) { return !kept_[mesh_.vertices[h]]; });
    const double area = area_of(mesh_, ring, normal);
    if (area > 0)
      outers.push_back({std::move(ring), area, {}, {}});
    else if (area < 0)
      holes.emplace_back(area, std::move(ring));
  }
  if (outers.empty()) return;
  std::stable_sort(outers.begin(), outers.end(), [](const Outer& a, const Outer& b) { return a.area > b.area; });
  std::stable_sort(holes.begin(), holes.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  const PlaneAxes axes(normal);
  if (outers.size() > 1 && !holes.empty())
    for (Outer& outer : outers) outer.points = flattened(mesh_, outer.ring, axes);
  std::uint64_t budget = 1u << 28;
  for (std::size_t i = 0; i < holes.size(); ++i) {
    std::size_t in = 0;
    // Finds the smallest ring that contains the hole. Tests the midpoint of an edge, because a vertex of the hole may
    // be on the ring.
    const glm::dvec2 p = axes((mesh_.position(holes[i].second[0]) + mesh_.position(holes[i].second[1])) * 0.5);
    for (std::size_t k = outers.size(); outers.size() > 1 && k-- > 0;) {
      if (budget < outers[k].points.size()) break;
      budget -= outers[k].points.size();
      if (outers[k].area < -holes[i].first || !contains(outers[k].points, p)) continue;
      in = k;
      break;
    }
    outers[in].holes.push_back(i);
  }
  for (const Outer& outer : outers) {
    add_ring(outer.ring, textured, to);
    double area = outer.area;
    for (const std::size_t hole : outer.holes) {
      add_ring(holes[hole].second, textured, to);
      area += holes[hole].first;
    }
    close_polygon(area, to);
  }
}

}  // namespace gs::qnv::outline
