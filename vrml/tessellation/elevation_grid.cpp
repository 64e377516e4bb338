#include "vrml/mesh/face_set.h"
#include "vrml/mesh/vertices.h"
#include "vrml/tessellation/properties.h"
#include "vrml/tessellation/tessellators.h"

#include <algorithm>
#include <cmath>

namespace gs::vrml {
namespace {

/// Grid of columns x rows vertices; both numbers are >= 2.
struct Grid {
  std::uint32_t columns, rows;
};

/// Returns one quadrilateral per cell, counter-clockwise seen from +Y. Their order is that of QuadColor[i, j] (VRML97
/// 6.17).
[[nodiscard]] MFInt32 quadrilaterals(Grid grid) {
  MFInt32 index;
  const std::size_t size = std::size_t{5} * (grid.columns - 1) * (grid.rows - 1);
  std::int32_t* next = index.prepare(size);
  for (std::uint32_t j = 0; j + 1 < grid.rows; ++j)
    for (std::uint32_t i = 0; i + 1 < grid.columns; ++i) {
      const auto here = static_cast<std::int32_t>(j * grid.columns + i);
      const auto below = here + static_cast<std::int32_t>(grid.columns);
      *next++ = here;
      *next++ = below;
      *next++ = below + 1;
      *next++ = here + 1;
      *next++ = -1;
    }
  index.commit(size);
  return index;
}

/// Returns texture coordinates from (0, 0) at the first vertex to (1, 1) at the last vertex. `rows` is the number of
/// rows that the node declares.
[[nodiscard]] MFVec2f unit_square(Grid grid, std::int32_t rows) {
  MFVec2f coordinates;
  const std::size_t size = std::size_t{grid.columns} * grid.rows;
  glm::vec2* next = coordinates.prepare(size);
  const auto last_column = static_cast<float>(grid.columns - 1), last_row = static_cast<float>(rows - 1);
  for (std::uint32_t j = 0; j < grid.rows; ++j)
    for (std::uint32_t i = 0; i < grid.columns; ++i)
      *next++ = {static_cast<float>(i) / last_column, static_cast<float>(j) / last_row};
  coordinates.commit(size);
  return coordinates;
}

}  // namespace

// Counts one quadrilateral with corner normals per height.
std::size_t cost_of_elevation_grid(const SceneGraph& scene, NodeId geometry) {
  constexpr std::size_t kOfHeight = 8;
  return scene.get<MFFloat>(geometry, "height").size() * kOfHeight;
}

Mesh tessellate_elevation_grid(const SceneGraph& scene, NodeId geometry, const MeshOptions&) {
  const MFFloat height = scene.get<MFFloat>(geometry, "height");
  const auto x_dimension = scene.get<SFInt32>(geometry, "xDimension");
  const auto z_dimension = scene.get<SFInt32>(geometry, "zDimension");
  const auto x_spacing = scene.get<SFFloat>(geometry, "xSpacing");
  const auto z_spacing = scene.get<SFFloat>(geometry, "zSpacing");

  FaceSet faces;
  faces.solid = scene.get<SFBool>(geometry, "solid");
  Mesh nothing;
  nothing.solid = faces.solid;
  // A spacing of 0 is drawn flat, although the ranges in the node table exclude it.
  const auto is_spacing = [](float spacing) { return spacing >= 0 && std::isfinite(spacing); };
  if (x_dimension < 2 || z_dimension < 2 || !is_spacing(x_spacing) || !is_spacing(z_spacing)) return nothing;
  // Omits rows with missing heights. The number of heights then limits the memory.
  const auto columns = static_cast<std::size_t>(x_dimension);
  const std::size_t rows = std::min(
      {static_cast<std::size_t>(z_dimension), height.size() / columns, kMaximumCorners / 5 / (columns - 1) + 1});
  if (rows < 2) return nothing;
  const Grid grid{static_cast<std::uint32_t>(columns), static_cast<std::uint32_t>(rows)};

  constexpr std::uint64_t kBytesOfPoint = 40;
  Share share(scene.budget(), Resource::meshes);
  if (!share.grow(columns * rows * kBytesOfPoint)) {
    nothing.limited = true;
    return nothing;
  }
  faces.budget = scene.budget();
  glm::vec3* point = faces.points.prepare(columns * rows);
  const float* y = height.data();
  for (std::uint32_t j = 0; j < grid.rows; ++j)
    for (std::uint32_t i = 0; i < grid.columns; ++i)
      *point++ = {x_spacing * static_cast<float>(i), *y++, z_spacing * static_cast<float>(j)};
  faces.points.commit(columns * rows);
  faces.coord_index = quadrilaterals(grid);
  set_properties(faces, scene, geometry);
  set_texture_coordinates(faces, scene, geometry);
  if (faces.texture_coordinate.values.empty()) faces.texture_coordinate = {unit_square(grid, z_dimension), true, {}};
  faces.ccw = scene.get<SFBool>(geometry, "ccw");
  faces.crease_angle = scene.get<SFFloat>(geometry, "creaseAngle");
  return make_mesh(std::move(faces));
}

}  // namespace gs::vrml
