#include "vrml/mesh/face_set.h"
#include "vrml/mesh/vertices.h"
#include "vrml/tessellation/nurbs_nodes.h"
#include "vrml/tessellation/tessellators.h"
#include "vrml/tessellation/trimming.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <cmath>
#include <string>
#include <utility>

// Tessellators of NurbsCurve, NurbsSurface, NurbsPatchSurface and NurbsTrimmedSurface.
namespace gs::vrml {
namespace {

SFBool flag_of(const SceneGraph& scene, NodeId node, std::string_view field, bool otherwise) {
  return scene.node(node).type->find_field(field) ? scene.get<SFBool>(node, field) : otherwise;
}

/// Subdivision of a surface into columns x rows.
struct SurfaceSteps {
  std::size_t columns = 0, rows = 0;
};
SurfaceSteps surface_steps(const SceneGraph& scene, NodeId geometry, const NurbsSurface& surface) {
  return {surface.u().steps(scene.get<SFInt32>(geometry, "uTessellation")),
          surface.v().steps(scene.get<SFInt32>(geometry, "vTessellation"))};
}

// Returns the surface of texture coordinates: that of a NurbsTextureSurface or NurbsTextureCoordinate, or one with a
// TextureCoordinate per control point. Returns nullopt if the coordinates are those of the unit square.
std::optional<NurbsSurface> texture_surface(const SceneGraph& scene, NodeId geometry, const NurbsSurface& surface) {
  const NodeId given = scene.get<SFNode>(geometry, "texCoord");
  if (const NodeId node = scene.resolve_as(given, NodeKind::nurbs_texture_surface))
    return NurbsSurface::make(scene, node);
  if (!scene.resolve_as(given, NodeKind::texture_coordinate)) return std::nullopt;
  return surface.with_points(points_of(scene, geometry, "texCoord"));
}

// Returns the normal of a surface at the parameters u and v, or a zero vector where it has none. At a pole, where an
// edge of the surface shrinks to a point, one derivative is only rounding; the normal beside the pole replaces it.
glm::vec3 surface_normal(const NurbsSurface& surface, const NurbsSurface::Place& place, double u, double v, bool ccw) {
  constexpr double kSmall = 1e-3, kAside = 1e-3;
  glm::dvec3 up = glm::cross(place.along_u, place.along_v);
  const double scale = glm::length(place.along_u) + glm::length(place.along_v);
  const bool on_edge = u == 0 || u == 1 || v == 0 || v == 1;
  if (on_edge && glm::length(up) <= kSmall * scale * scale) {
    const NurbsSurface::Place beside = surface.at(glm::mix(u, 0.5, kAside), glm::mix(v, 0.5, kAside));
    up = glm::cross(beside.along_u, beside.along_v);
  }
  const double length = glm::length(up);
  return length > 0 ? glm::vec3(up / length * (ccw ? 1.0 : -1.0)) : glm::vec3(0);
}

MFVec2f surface_texture(const std::optional<NurbsSurface>& picture, SurfaceSteps steps) {
  MFVec2f coordinates;
  const std::size_t count = (steps.columns + 1) * (steps.rows + 1);
  glm::vec2* next = coordinates.prepare(count);
  if (picture) {
    picture->sample(steps.columns, steps.rows, [&](std::size_t, std::size_t, const NurbsSurface::Place& place) {
      *next++ = glm::vec2(place.point);
    });
  } else {
    for (std::size_t j = 0; j <= steps.rows; ++j)
      for (std::size_t i = 0; i <= steps.columns; ++i)
        *next++ = {static_cast<float>(i) / static_cast<float>(steps.columns),
                   static_cast<float>(j) / static_cast<float>(steps.rows)};
  }
  coordinates.commit(count);
  return coordinates;
}

// Returns the trimming contours of a NurbsTrimmedSurface in the parameters 0 to 1. Each contour is closed.
std::vector<std::vector<glm::dvec2>> contours_of(const SceneGraph& scene, NodeId geometry,
                                                 const NurbsSurface& surface) {
  std::vector<std::vector<glm::dvec2>> contours;
  for (const NodeId given : scene.get<MFNode>(geometry, "trimmingContour")) {
    const NodeId node = scene.resolve(given);
    if (!node || !scene.node(node).type->find_field("children")) continue;
    std::vector<glm::dvec2>& contour = contours.emplace_back();
    for (const NodeId part : scene.get<MFNode>(node, "children"))
      for (const glm::dvec3& point : polyline_of(scene, part))
        if (std::isfinite(point.x) && std::isfinite(point.y))
          contour.emplace_back(surface.u().place_of(point.x), surface.v().place_of(point.y));
  }
  return contours;
}

// Makes the part of a surface inside its trimming contours.
Mesh trimmed_mesh(const SceneGraph& scene, NodeId geometry, const NurbsSurface& surface, const MeshOptions& options) {
  Mesh nothing;
  nothing.solid = scene.get<SFBool>(geometry, "solid");
  const SurfaceSteps steps = surface_steps(scene, geometry, surface);
  const std::vector<std::vector<glm::dvec2>> contours = contours_of(scene, geometry, surface);
  const std::size_t count = most_corners(contours, steps.columns, steps.rows);
  constexpr std::uint64_t kBytesOfCorner = 160;
  Share share(scene.budget(), Resource::meshes);
  if (!share.grow(count * kBytesOfCorner)) {
    nothing.limited = true;
    return nothing;
  }
  const std::optional<NurbsSurface> picture =
      options.texture_coordinates ? texture_surface(scene, geometry, surface) : std::nullopt;
  FaceSet faces;
  faces.budget = scene.budget();
  faces.solid = nothing.solid;
  MFVec3f normals;
  MFVec2f coordinates;
  for (const std::vector<glm::dvec2>& polygon : trim(contours, steps.columns, steps.rows)) {
    if (faces.budget->stopped()) break;
    for (const glm::dvec2& corner : polygon) {
      const NurbsSurface::Place place = surface.at(corner.x, corner.y);
      faces.coord_index.push_back(static_cast<std::int32_t>(faces.points.size()));
      faces.points.push_back(glm::vec3(place.point));
      normals.push_back(surface_normal(surface, place, corner.x, corner.y, true));
      if (options.texture_coordinates)
        coordinates.push_back(glm::vec2(picture ? glm::dvec2(picture->at(corner.x, corner.y).point) : corner));
    }
    faces.coord_index.push_back(-1);
  }
  faces.normal = {normals, true, {}};
  if (options.texture_coordinates) faces.texture_coordinate = {coordinates, true, {}};
  return make_mesh(std::move(faces));
}

}  // namespace

// Counts one quadrilateral with normals per interval.
std::size_t cost_of_nurbs_surface(const SceneGraph& scene, NodeId geometry) {
  constexpr std::size_t kOfPiece = 16;
  const auto surface = NurbsSurface::make(scene, geometry);
  if (!surface) return 0;
  const SurfaceSteps steps = surface_steps(scene, geometry, *surface);
  return steps.columns * steps.rows * kOfPiece;
}

Mesh tessellate_nurbs_surface(const SceneGraph& scene, NodeId geometry, const MeshOptions& options) {
  Mesh nothing;
  nothing.solid = scene.get<SFBool>(geometry, "solid");
  const auto surface = NurbsSurface::make(scene, geometry);
  if (!surface) return nothing;
  const SurfaceSteps steps = surface_steps(scene, geometry, *surface);
  const std::size_t count = (steps.columns + 1) * (steps.rows + 1);
  constexpr std::uint64_t kBytesOfPoint = 64;
  Share share(scene.budget(), Resource::meshes);
  if (!share.grow(count * kBytesOfPoint)) {
    nothing.limited = true;
    return nothing;
  }
  FaceSet faces;
  faces.budget = scene.budget();
  faces.solid = nothing.solid;
  faces.ccw = flag_of(scene, geometry, "ccw", true);
  MFVec3f normals;
  glm::vec3* point = faces.points.prepare(count);
  glm::vec3* normal = normals.prepare(count);
  surface->sample(steps.columns, steps.rows, [&](std::size_t i, std::size_t j, const NurbsSurface::Place& place) {
    const double u = static_cast<double>(i) / static_cast<double>(steps.columns),
                 v = static_cast<double>(j) / static_cast<double>(steps.rows);
    *point++ = glm::vec3(place.point);
    *normal++ = surface_normal(*surface, place, u, v, faces.ccw);
  });
  faces.points.commit(count);
  normals.commit(count);
  faces.normal = {normals, true, {}};
  if (options.texture_coordinates)
    faces.texture_coordinate = {surface_texture(texture_surface(scene, geometry, *surface), steps), true, {}};
  const std::size_t size = 5 * steps.columns * steps.rows;
  std::int32_t* index = faces.coord_index.prepare(size);
  for (std::size_t j = 0; j < steps.rows; ++j)
    for (std::size_t i = 0; i < steps.columns; ++i) {
      const auto here = static_cast<std::int32_t>(j * (steps.columns + 1) + i),
                 next_row = static_cast<std::int32_t>(steps.columns + 1);
      for (const std::int32_t corner : {here, here + 1, here + next_row + 1, here + next_row, -1}) *index++ = corner;
    }
  faces.coord_index.commit(size);
  return make_mesh(std::move(faces));
}

Mesh tessellate_nurbs_trimmed_surface(const SceneGraph& scene, NodeId geometry, const MeshOptions& options) {
  const auto surface = NurbsSurface::make(scene, geometry);
  if (!surface || scene.get<MFNode>(geometry, "trimmingContour").empty())
    return tessellate_nurbs_surface(scene, geometry, options);
  return trimmed_mesh(scene, geometry, *surface, options);
}

Mesh tessellate_nurbs_curve(const SceneGraph& scene, NodeId geometry, const MeshOptions&) {
  Mesh mesh;
  mesh.primitive = Mesh::Primitive::lines;
  mesh.solid = false;
  mesh.lit = false;
  const auto curve = NurbsCurve::make(scene, geometry);
  if (!curve) return mesh;
  const std::size_t steps = curve->axis().steps(scene.get<SFInt32>(geometry, "tessellation"));
  glm::vec3* position = mesh.positions.prepare(steps + 1);
  for (std::size_t i = 0; i <= steps; ++i)
    *position++ = glm::vec3(curve->at(static_cast<double>(i) / static_cast<double>(steps)));
  mesh.positions.commit(steps + 1);
  const UsableVertices vertices(mesh.positions.span());
  std::vector<std::uint8_t> used(steps + 1, 0);
  for (std::uint32_t i = 0; i < steps; ++i) {
    if (!vertices.contains(i) || !vertices.contains(i + 1)) continue;
    used[i] = used[i + 1] = 1;
    mesh.indices.push_back(i);
    mesh.indices.push_back(i + 1);
  }
  if (!mesh.indices.empty()) mesh.bounds = bounds_of(mesh.positions.span(), used);
  return mesh;
}

}  // namespace gs::vrml
