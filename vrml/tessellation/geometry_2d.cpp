// Tessellators of the X3D component Geometry2D (X3D 14). All nodes lie in the plane z = 0 and face +Z.
#include "vrml/tessellation/line_set.h"
#include "vrml/tessellation/properties.h"
#include "vrml/tessellation/tessellators.h"

#include "vrml/mesh/vertices.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

namespace gs::vrml {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;
constexpr int kMostSegments = 4096;
constexpr int kCurveSegments = 64;  // least segments of a circle; no mesh has other levels of detail

[[nodiscard]] bool is_length(float value) { return std::isfinite(value) && value > 0; }

/// Points on an arc around the origin.
struct Arc {
  double start = 0, end = kTurn;  // radians, counter-clockwise; the end is above the start
  bool whole = true;              // the arc is a whole circle
};

/// Returns the arc from the start angle to the end angle. Equal angles, or angles that differ by a turn or more, mean a
/// whole circle (X3D 14.3.1).
[[nodiscard]] Arc arc_of(const SceneGraph& scene, NodeId geometry) {
  const double start = scene.get<SFFloat>(geometry, "startAngle"), end = scene.get<SFFloat>(geometry, "endAngle");
  constexpr double kTolerance = 1e-6;
  if (!std::isfinite(start) || !std::isfinite(end)) return {};
  const double from = std::fmod(start, kTurn);
  if (std::abs(end - start) < kTolerance || std::abs(end - start) >= kTurn - 1e-4) return {from, from + kTurn, true};
  double sweep = std::fmod(end - start, kTurn);
  if (sweep < 0) sweep += kTurn;
  return {from, from + sweep, false};
}

/// Returns unit directions along an arc. Those of a whole circle include the first one again at the end.
[[nodiscard]] std::vector<glm::vec2> directions(const Arc& arc, const MeshOptions& options) {
  const int circle = std::clamp(std::max(options.segments, kCurveSegments), 3, kMostSegments);
  const int count = std::max(1, static_cast<int>(std::ceil((arc.end - arc.start) / kTurn * circle)));
  std::vector<glm::vec2> points(static_cast<std::size_t>(count) + 1);
  for (int i = 0; i <= count; ++i) {
    const double angle = arc.start + (arc.end - arc.start) * i / count;
    points[static_cast<std::size_t>(i)] = {static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle))};
  }
  if (arc.whole) points.back() = points.front();
  return points;
}

/// Returns the lines through points of a plane, as one polyline.
[[nodiscard]] Mesh polyline(std::span<const glm::vec2> points, const SceneGraph& scene, const MeshOptions& options) {
  LineSet lines;
  lines.lengths = options.line_lengths;
  glm::vec3* point = lines.points.prepare(points.size());
  std::int32_t* index = lines.coord_index.prepare(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    point[i] = {points[i], 0};
    index[i] = static_cast<std::int32_t>(i);
  }
  lines.points.commit(points.size());
  lines.coord_index.commit(points.size());
  return make_lines(std::move(lines), scene.budget());
}

/// Builder of a flat surface that faces +Z.
class Flat {
 public:
  std::uint32_t vertex(const glm::vec2& point, const glm::vec2& texture_coordinate) {
    mesh_.positions.push_back({point, 0});
    mesh_.normals.push_back({0, 0, 1});
    mesh_.texture_coordinates.push_back(texture_coordinate);
    mesh_.bounds.add({point, 0});
    return static_cast<std::uint32_t>(mesh_.positions.size() - 1);
  }
  void triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    mesh_.indices.push_back(a);
    mesh_.indices.push_back(b);
    mesh_.indices.push_back(c);
  }
  [[nodiscard]] Mesh finish(bool solid) {
    if (mesh_.indices.empty()) mesh_ = {};
    mesh_.solid = solid;
    return std::move(mesh_);
  }

 private:
  Mesh mesh_;
};

[[nodiscard]] glm::vec2 on_square(const glm::vec2& unit) { return unit * 0.5f + 0.5f; }

/// Returns the surface between an arc and its centre, or its chord.
[[nodiscard]] Mesh sector(const Arc& arc, float radius, bool pie, bool solid, const MeshOptions& options) {
  const std::vector<glm::vec2> around = directions(arc, options);
  Flat flat;
  // A chord's polygon is convex, so a fan around its first point covers it.
  const bool centred = pie || arc.whole;
  const std::uint32_t center =
      centred ? flat.vertex({0, 0}, on_square({0, 0})) : flat.vertex(around[0] * radius, on_square(around[0]));
  std::uint32_t last = center;
  for (std::size_t i = centred ? 0 : 1; i < around.size(); ++i) {
    const std::uint32_t next = flat.vertex(around[i] * radius, on_square(around[i]));
    if (last != center) flat.triangle(center, last, next);
    last = next;
  }
  return flat.finish(solid);
}

[[nodiscard]] Mesh no_surface(bool solid) {
  Mesh mesh;
  mesh.solid = solid;
  return mesh;
}

[[nodiscard]] Mesh no_marks(Mesh::Primitive primitive) {
  Mesh mesh;
  mesh.primitive = primitive;
  mesh.solid = mesh.lit = false;
  return mesh;
}

}  // namespace

Mesh tessellate_arc_2d(const SceneGraph& scene, NodeId geometry, const MeshOptions& options) {
  const auto radius = scene.get<SFFloat>(geometry, "radius");
  if (!is_length(radius)) return no_marks(Mesh::Primitive::lines);
  std::vector<glm::vec2> points = directions(arc_of(scene, geometry), options);
  for (glm::vec2& point : points) point *= radius;
  return polyline(points, scene, options);
}

Mesh tessellate_arc_close_2d(const SceneGraph& scene, NodeId geometry, const MeshOptions& options) {
  const auto solid = scene.get<SFBool>(geometry, "solid");
  const auto radius = scene.get<SFFloat>(geometry, "radius");
  if (!is_length(radius)) return no_surface(solid);
  const bool pie = scene.get<SFString>(geometry, "closureType") != "CHORD";
  return sector(arc_of(scene, geometry), radius, pie, solid, options);
}

Mesh tessellate_circle_2d(const SceneGraph& scene, NodeId geometry, const MeshOptions& options) {
  const auto radius = scene.get<SFFloat>(geometry, "radius");
  if (!is_length(radius)) return no_marks(Mesh::Primitive::lines);
  std::vector<glm::vec2> points = directions({}, options);
  for (glm::vec2& point : points) point *= radius;
  return polyline(points, scene, options);
}

// With innerRadius 0, the disk is filled; with equal radii, it is a circle (X3D 14.3.4).
Mesh tessellate_disk_2d(const SceneGraph& scene, NodeId geometry, const MeshOptions& options) {
  const auto solid = scene.get<SFBool>(geometry, "solid");
  auto inner = scene.get<SFFloat>(geometry, "innerRadius"), outer = scene.get<SFFloat>(geometry, "outerRadius");
  if (!std::isfinite(inner) || inner < 0 || !is_length(outer)) return no_surface(solid);
  if (inner > outer) std::swap(inner, outer);
  if (inner == outer) {
    std::vector<glm::vec2> points = directions({}, options);
    for (glm::vec2& point : points) point *= outer;
    return polyline(points, scene, options);
  }
  if (inner == 0) return sector({}, outer, true, solid, options);
  const std::vector<glm::vec2> around = directions({}, options);
  Flat flat;
  for (std::size_t i = 0; i < around.size(); ++i) {
    const std::uint32_t a = flat.vertex(around[i] * inner, on_square(around[i] * (inner / outer)));
    const std::uint32_t b = flat.vertex(around[i] * outer, on_square(around[i]));
    if (i == 0) continue;
    flat.triangle(a - 2, b - 2, b);
    flat.triangle(a - 2, b, a);
  }
  return flat.finish(solid);
}

Mesh tessellate_polyline_2d(const SceneGraph& scene, NodeId geometry, const MeshOptions& options) {
  const MFVec2f points = scene.get<MFVec2f>(geometry, "lineSegments");
  constexpr std::uint64_t kBytesOfPoint = 16;
  Share share(scene.budget(), Resource::meshes);
  Mesh nothing = no_marks(Mesh::Primitive::lines);
  nothing.limited = points.size() > kMaximumCorners || !share.grow(points.size() * kBytesOfPoint);
  return nothing.limited || points.empty() ? nothing : polyline(points.span(), scene, options);
}

Mesh tessellate_polypoint_2d(const SceneGraph& scene, NodeId geometry, const MeshOptions&) {
  const MFVec2f points = scene.get<MFVec2f>(geometry, "point");
  constexpr std::uint64_t kBytesOfPoint = 12;
  Share share(scene.budget(), Resource::meshes);
  if (!share.grow(points.size() * kBytesOfPoint)) {
    Mesh nothing = no_marks(Mesh::Primitive::points);
    nothing.limited = true;
    return nothing;
  }
  PointCloud cloud;
  glm::vec3* to = cloud.points.prepare(points.size());
  for (const glm::vec2& point : points) *to++ = {point, 0};
  cloud.points.commit(points.size());
  return make_points(std::move(cloud), scene.budget());
}

Mesh tessellate_rectangle_2d(const SceneGraph& scene, NodeId geometry, const MeshOptions&) {
  const auto solid = scene.get<SFBool>(geometry, "solid");
  const auto size = scene.get<SFVec2f>(geometry, "size");
  if (!is_length(size.x) || !is_length(size.y)) return no_surface(solid);
  const glm::vec2 half = size * 0.5f;
  Flat flat;
  const std::uint32_t a = flat.vertex(-half, {0, 0}), b = flat.vertex({half.x, -half.y}, {1, 0});
  const std::uint32_t c = flat.vertex(half, {1, 1}), d = flat.vertex({-half.x, half.y}, {0, 1});
  flat.triangle(a, b, c);
  flat.triangle(a, c, d);
  return flat.finish(solid);
}

// Three vertices are a triangle (X3D 14.3.8). Triangles that are clockwise face +Z, too. The texture covers the box of
// all vertices.
Mesh tessellate_triangle_set_2d(const SceneGraph& scene, NodeId geometry, const MeshOptions&) {
  const auto solid = scene.get<SFBool>(geometry, "solid");
  const MFVec2f points = scene.get<MFVec2f>(geometry, "vertices");
  Mesh nothing = no_surface(solid);
  constexpr std::uint64_t kBytesOfPoint = 72;
  Share share(scene.budget(), Resource::meshes);
  nothing.limited = points.size() > kMaximumCorners || !share.grow(points.size() * kBytesOfPoint);
  if (nothing.limited) return nothing;
  glm::vec2 lower(HUGE_VALF), upper(-HUGE_VALF);
  const auto finite = [](const glm::vec2& p) { return std::isfinite(p.x) && std::isfinite(p.y); };
  for (const glm::vec2& point : points) {
    if (!finite(point)) continue;
    lower = glm::min(lower, point);
    upper = glm::max(upper, point);
  }
  const glm::vec2 size = upper - lower;
  const glm::vec2 scale(size.x > 0 ? 1 / size.x : 0, size.y > 0 ? 1 / size.y : 0);
  Flat flat;
  for (std::size_t i = 0; i + 2 < points.size(); i += 3) {
    const glm::vec2 a = points[i], b = points[i + 1], c = points[i + 2];
    if (!finite(a) || !finite(b) || !finite(c)) continue;
    const glm::dvec2 ab = glm::dvec2(b) - glm::dvec2(a), ac = glm::dvec2(c) - glm::dvec2(a);
    const double area = ab.x * ac.y - ab.y * ac.x;
    if (area == 0) continue;
    const std::uint32_t first = flat.vertex(a, (a - lower) * scale);
    flat.vertex(b, (b - lower) * scale);
    flat.vertex(c, (c - lower) * scale);
    area > 0 ? flat.triangle(first, first + 1, first + 2) : flat.triangle(first, first + 2, first + 1);
  }
  return flat.finish(solid);
}

}  // namespace gs::vrml
