#include "vrml/mesh/face_set.h"
#include "vrml/tessellation/nurbs_nodes.h"
#include "vrml/tessellation/spine.h"
#include "vrml/tessellation/tessellators.h"

#include <glm/gtc/constants.hpp>

#include <utility>

// Tessellators of NurbsSweptSurface and NurbsSwungSurface (ISO/IEC 19775-1 27.4.11, 27.4.12).
namespace gs::vrml {
namespace {

/// SweptGrid of columns x rows points, row by row.
struct SweptGrid {
  MFVec3f points;
  std::size_t columns = 0, rows = 0;
};

// Makes a smooth mesh of quadrilaterals. If the first and last column or row coincide, normals are smooth across the
// seam, because equal points share a vertex there.
Mesh mesh_of(const SceneGraph& scene, NodeId geometry, SweptGrid grid) {
  const auto point = [&](std::size_t column, std::size_t row) { return grid.points[row * grid.columns + column]; };
  bool round = true, ring = true;
  for (std::size_t j = 0; j < grid.rows; ++j) round = round && point(0, j) == point(grid.columns - 1, j);
  for (std::size_t i = 0; i < grid.columns; ++i) ring = ring && point(i, 0) == point(i, grid.rows - 1);
  FaceSet faces;
  MFInt32 texture_index;
  MFVec2f coordinates;
  const auto put = [&](std::size_t column, std::size_t row) {
    texture_index.push_back(static_cast<std::int32_t>(row * grid.columns + column));
    if (round && column + 1 == grid.columns) column = 0;
    if (ring && row + 1 == grid.rows) row = 0;
    faces.coord_index.push_back(static_cast<std::int32_t>(row * grid.columns + column));
  };
  for (std::size_t j = 0; j + 1 < grid.rows; ++j)
    for (std::size_t i = 0; i + 1 < grid.columns; ++i) {
      put(i, j);
      put(i + 1, j);
      put(i + 1, j + 1);
      put(i, j + 1);
      faces.coord_index.push_back(-1);
      texture_index.push_back(-1);
    }
  for (std::size_t j = 0; j < grid.rows; ++j)
    for (std::size_t i = 0; i < grid.columns; ++i)
      coordinates.push_back({static_cast<float>(i) / static_cast<float>(grid.columns - 1),
                             static_cast<float>(j) / static_cast<float>(grid.rows - 1)});
  faces.points = std::move(grid.points);
  faces.texture_coordinate = {std::move(coordinates), true, std::move(texture_index)};
  faces.ccw = scene.get<SFBool>(geometry, "ccw");
  faces.solid = scene.get<SFBool>(geometry, "solid");
  faces.crease_angle = glm::pi<float>();
  faces.budget = scene.budget();
  return make_mesh(std::move(faces));
}

// Makes the mesh of a grid. `place` returns the point for a point of the profile and the index of a point of the
// trajectory.
template <class Place>
Mesh swept_mesh(const SceneGraph& scene, NodeId geometry, const std::vector<glm::dvec3>& profile, std::size_t rows,
                const Place& place) {
  Mesh nothing;
  nothing.solid = scene.get<SFBool>(geometry, "solid");
  if (profile.size() < 2 || rows < 2) return nothing;
  constexpr std::uint64_t kBytesOfPoint = 160;
  Share share(scene.budget(), Resource::meshes);
  if (!share.grow(profile.size() * rows * kBytesOfPoint)) {
    nothing.limited = true;
    return nothing;
  }
  SweptGrid grid{{}, profile.size(), rows};
  for (std::size_t j = 0; j < rows; ++j)
    for (const glm::dvec3& point : profile) grid.points.push_back(glm::vec3(place(point, j)));
  return mesh_of(scene, geometry, std::move(grid));
}

}  // namespace

Mesh tessellate_nurbs_swept_surface(const SceneGraph& scene, NodeId geometry, const MeshOptions&) {
  const std::vector<glm::dvec3> profile = polyline_of(scene, scene.get<SFNode>(geometry, "crossSectionCurve"));
  const std::vector<glm::dvec3> way = polyline_of(scene, scene.get<SFNode>(geometry, "trajectoryCurve"));
  std::vector<glm::vec3> spine(way.begin(), way.end());
  const std::vector<CrossSectionPlane> planes = cross_section_planes(spine);
  return swept_mesh(scene, geometry, profile, way.size(), [&](const glm::dvec3& point, std::size_t j) {
    return way[j] + planes[j].x * point.x + planes[j].z * point.y;
  });
}

// Each point of the trajectory, in the x-z plane, turns the profile around the y axis and scales it.
Mesh tessellate_nurbs_swung_surface(const SceneGraph& scene, NodeId geometry, const MeshOptions&) {
  const std::vector<glm::dvec3> profile = polyline_of(scene, scene.get<SFNode>(geometry, "profileCurve"));
  const std::vector<glm::dvec3> way = polyline_of(scene, scene.get<SFNode>(geometry, "trajectoryCurve"));
  return swept_mesh(scene, geometry, profile, way.size(), [&](const glm::dvec3& point, std::size_t j) {
    return glm::dvec3(point.x * way[j].x, point.y, point.x * way[j].y);
  });
}

}  // namespace gs::vrml
