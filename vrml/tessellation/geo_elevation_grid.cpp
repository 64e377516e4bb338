#include "vrml/mesh/face_set.h"
#include "vrml/mesh/vertices.h"
#include "vrml/scene/coordinates/geospatial.h"
#include "vrml/tessellation/properties.h"
#include "vrml/tessellation/tessellators.h"

#include <algorithm>
#include <cmath>
#include <vector>

// Tessellator of GeoElevationGrid (ISO/IEC 19775-1 25.3.2).
namespace gs::vrml {

std::size_t cost_of_geo_elevation_grid(const SceneGraph& scene, NodeId geometry) {
  constexpr std::size_t kOfHeight = 16;
  return scene.get<MFDouble>(geometry, "height").size() * kOfHeight;
}

Mesh tessellate_geo_elevation_grid(const SceneGraph& scene, NodeId geometry, const MeshOptions&) {
  const MFDouble height = scene.get<MFDouble>(geometry, "height");
  const auto x_dimension = scene.get<SFInt32>(geometry, "xDimension");
  const auto z_dimension = scene.get<SFInt32>(geometry, "zDimension");
  const double x_spacing = scene.get<SFDouble>(geometry, "xSpacing"),
               z_spacing = scene.get<SFDouble>(geometry, "zSpacing");
  const auto y_scale = static_cast<double>(scene.get<SFFloat>(geometry, "yScale"));
  FaceSet faces;
  faces.solid = scene.get<SFBool>(geometry, "solid");
  Mesh nothing;
  nothing.solid = faces.solid;
  if (x_dimension < 2 || z_dimension < 2) return nothing;
  // Omits rows with missing heights. The number of heights then limits the memory.
  const auto columns = static_cast<std::size_t>(x_dimension);
  const std::size_t rows = std::min(
      {static_cast<std::size_t>(z_dimension), height.size() / columns, kMaximumCorners / 5 / (columns - 1) + 1});
  constexpr std::uint64_t kBytesOfPoint = 64;
  Share share(scene.budget(), Resource::meshes);
  if (rows < 2 || !share.grow(columns * rows * kBytesOfPoint)) {
    nothing.limited = rows >= 2;
    return nothing;
  }
  const GeoFrame frame = GeoFrame::of(scene, scene.node(geometry));
  const glm::dvec3 corner = *scene.get<SFVec3d>(geometry, "geoGridOrigin");
  std::vector<glm::dvec3> points;
  points.reserve(columns * rows);
  MFVec2f texture;
  // The grid lies north and east of its origin. The first coordinate is the latitude or northing, unless geoSystem
  // swaps them.
  const bool swapped = frame.is_swapped();
  for (std::size_t j = 0; j < rows; ++j)
    for (std::size_t i = 0; i < columns; ++i) {
      const double north = z_spacing * static_cast<double>(j), east = x_spacing * static_cast<double>(i);
      const double up = static_cast<double>(height[j * columns + i]) * y_scale;
      points.push_back(frame.position(corner + (swapped ? glm::dvec3(east, north, up) : glm::dvec3(north, east, up))));
      texture.push_back({static_cast<float>(i) / static_cast<float>(x_dimension - 1),
                         static_cast<float>(j) / static_cast<float>(z_dimension - 1)});
    }
  for (std::size_t j = 0; j + 1 < rows; ++j)
    for (std::size_t i = 0; i + 1 < columns; ++i) {
      const auto here = static_cast<std::int32_t>(j * columns + i), above = here + static_cast<std::int32_t>(columns);
      for (const std::int32_t index : {here, here + 1, above + 1, above, -1}) faces.coord_index.push_back(index);
    }
  Coordinates relative = relative_points(points);
  faces.points = std::move(relative.points);
  faces.budget = scene.budget();
  set_properties(faces, scene, geometry);
  set_texture_coordinates(faces, scene, geometry);
  if (faces.texture_coordinate.values.empty()) faces.texture_coordinate = {std::move(texture), true, {}};
  faces.ccw = scene.get<SFBool>(geometry, "ccw");
  faces.crease_angle = static_cast<float>(scene.get<SFDouble>(geometry, "creaseAngle"));
  Mesh mesh = make_mesh(std::move(faces));
  mesh.origin = relative.origin;
  return mesh;
}

}  // namespace gs::vrml
