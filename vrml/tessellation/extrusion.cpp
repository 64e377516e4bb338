#include "vrml/mesh/face_set.h"
#include "vrml/tessellation/spine.h"
#include "vrml/tessellation/tessellators.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

namespace gs::vrml {
namespace {

/// Columns of a rotation matrix. They are the identity if the axis has no direction (VRML97 5.8).
struct Turn {
  glm::dvec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};

  explicit Turn(const Rotation& rotation) {
    const glm::dvec3 axis(rotation.x, rotation.y, rotation.z);
    const double length = glm::length(axis);
    if (!(length > 0) || !std::isfinite(length) || !std::isfinite(rotation.angle)) return;
    const glm::dvec3 a = axis / length;
    const double c = std::cos(static_cast<double>(rotation.angle)), s = std::sin(static_cast<double>(rotation.angle));
    const double d = 1 - c;
    x = {a.x * a.x * d + c, a.x * a.y * d + a.z * s, a.x * a.z * d - a.y * s};
    y = {a.x * a.y * d - a.z * s, a.y * a.y * d + c, a.y * a.z * d + a.x * s};
    z = {a.x * a.z * d + a.y * s, a.y * a.z * d - a.x * s, a.z * a.z * d + c};
  }
};

/// Returns the value for spine point `i`. If the list is too short, returns its last value (VRML97 6.18.3).
template <class T>
[[nodiscard]] T value_at(const Array<T>& values, std::size_t i, const T& otherwise) {
  return values.empty() ? otherwise : values[std::min(i, values.size() - 1)];
}

/// Returns the relative arc length at each point, 0 to 1. If the curve has no length, the values are evenly spaced.
template <class Point>
[[nodiscard]] std::vector<float> fractions(const Array<Point>& curve) {
  std::vector<double> way(curve.size(), 0);
  for (std::size_t i = 1; i < curve.size(); ++i) {
    double square = 0;
    for (int axis = 0; axis < Point::length(); ++axis) {
      const double step = static_cast<double>(curve[i][axis]) - static_cast<double>(curve[i - 1][axis]);
      square += step * step;
    }
    way[i] = way[i - 1] + (std::isfinite(square) ? std::sqrt(square) : 0);
  }
  std::vector<float> result(curve.size(), 0);
  for (std::size_t i = 1; i < curve.size(); ++i)
    result[i] = static_cast<float>(way.back() > 0 ? way[i] / way.back()
                                                  : static_cast<double>(i) / static_cast<double>(curve.size() - 1));
  return result;
}

struct Extrusion {
  MFVec2f cross_section;
  MFVec3f spine;
  MFVec2f scale;
  MFRotation orientation;
  bool ccw = true, solid = true;
  float crease_angle = 0;
  std::size_t rings = 0;  // number of spine points that are drawn
  std::shared_ptr<Budget> budget;

  [[nodiscard]] bool cross_section_closed() const {
    return cross_section.size() > 2 && cross_section.front() == cross_section.back();
  }
  [[nodiscard]] MFVec3f place_cross_sections() const;
  [[nodiscard]] Mesh sides(const MFVec3f& points) const;
  [[nodiscard]] Mesh cap(const MFVec3f& points, bool begin) const;
  [[nodiscard]] MFVec2f cap_texture_coordinates() const;
};

/// Returns the points of the cross-section at each spine point, ring after ring.
MFVec3f Extrusion::place_cross_sections() const {
  const std::vector<CrossSectionPlane> planes = cross_section_planes(spine.span());
  MFVec3f points;
  glm::vec3* next = points.prepare(rings * cross_section.size());
  for (std::size_t i = 0; i < rings; ++i) {
    const glm::dvec2 size(value_at(scale, i, glm::vec2(1)));
    const Turn turn(value_at(orientation, i, Rotation{}));
    const CrossSectionPlane& plane = planes[i];
    const auto to_node = [&](const glm::dvec3& v) { return plane.x * v.x + plane.y * v.y + plane.z * v.z; };
    const glm::dvec3 x = to_node(turn.x) * size.x, z = to_node(turn.z) * size.y, origin(spine[i]);
    for (const glm::vec2& p : cross_section)
      *next++ = glm::vec3(origin + x * static_cast<double>(p.x) + z * static_cast<double>(p.y));
  }
  points.commit(rings * cross_section.size());
  return points;
}

/// Builds the sides. On a closed curve, the last column or ring of quadrilaterals uses the first vertices again, so
/// that normals are smooth across the seam. Texture coordinates at the seam are separate.
Mesh Extrusion::sides(const MFVec3f& points) const {
  const std::size_t columns = cross_section.size();
  const std::size_t last_ring = (rings - 1) * columns;
  const bool tube = cross_section_closed();
  const bool torus = rings > 2 && rings == spine.size() &&
                     std::equal(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(columns),
                                points.begin() + static_cast<std::ptrdiff_t>(last_ring));
  const auto vertex = [&](std::size_t ring, std::size_t column) {
    if (tube && column + 1 == columns) column = 0;
    if (torus && ring + 1 == rings) ring = 0;
    return static_cast<std::int32_t>(ring * columns + column);
  };
  FaceSet faces;
  MFInt32 texture_index;
  const std::size_t size = 5 * (rings - 1) * (columns - 1);
  std::int32_t* next = faces.coord_index.prepare(size);
  std::int32_t* next_texture = texture_index.prepare(size);
  const auto put = [&](std::size_t ring, std::size_t column) {
    *next++ = vertex(ring, column);
    *next_texture++ = static_cast<std::int32_t>(ring * columns + column);
  };
  // Writes each corner separately: GCC 12 at -O3 miscompiles a loop over the four corners.
  for (std::size_t i = 0; i + 1 < rings; ++i)
    for (std::size_t j = 0; j + 1 < columns; ++j) {
      put(i, j);
      put(i, j + 1);
      put(i + 1, j + 1);
      put(i + 1, j);
      *next++ = -1;
      *next_texture++ = -1;
    }
  faces.coord_index.commit(size);
  texture_index.commit(size);

  const std::vector<float> u = fractions(cross_section), v = fractions(spine);
  MFVec2f coordinates;
  glm::vec2* next_coordinate = coordinates.prepare(rings * columns);
  for (std::size_t i = 0; i < rings; ++i)
    for (std::size_t j = 0; j < columns; ++j) *next_coordinate++ = {u[j], v[i]};
  coordinates.commit(rings * columns);

  faces.points = points;
  faces.texture_coordinate = {std::move(coordinates), true, std::move(texture_index)};
  faces.ccw = ccw;
  faces.solid = solid;
  faces.crease_angle = crease_angle;
  faces.budget = budget;
  return make_mesh(std::move(faces));
}

/// Returns the texture coordinates of a cap: the cross-section, scaled uniformly so that its longer side becomes 0..1.
MFVec2f Extrusion::cap_texture_coordinates() const {
  glm::dvec2 lower(HUGE_VAL), upper(-HUGE_VAL);
  for (const glm::vec2& p : cross_section) {
    if (!std::isfinite(p.x) || !std::isfinite(p.y)) continue;
    lower = glm::min(lower, glm::dvec2(p));
    upper = glm::max(upper, glm::dvec2(p));
  }
  const double side = std::max(upper.x - lower.x, upper.y - lower.y);
  const double factor = side > 0 ? 1 / side : 0;
  MFVec2f coordinates;
  for (const glm::vec2& p : cross_section) coordinates.push_back(glm::vec2((glm::dvec2(p) - lower) * factor));
  return coordinates;
}

/// Builds a cap from the first or last ring as one flat face. Always triangulates the face as concave: `convex`
/// defaults to TRUE, and many worlds do not change the default for concave cross-sections.
Mesh Extrusion::cap(const MFVec3f& points, bool begin) const {
  const std::size_t columns = cross_section.size();
  const std::size_t corners = cross_section_closed() ? columns - 1 : columns;
  if (corners < 3) return {};
  FaceSet faces;
  faces.points = MFVec3f(points.span().subspan(begin ? 0 : (rings - 1) * columns, columns));
  for (std::size_t i = 0; i < corners; ++i)
    faces.coord_index.push_back(static_cast<std::int32_t>(begin ? corners - 1 - i : i));
  faces.texture_coordinate = {cap_texture_coordinates(), true, {}};
  faces.ccw = ccw;
  faces.solid = solid;
  faces.convex = false;
  faces.budget = budget;
  return make_mesh(std::move(faces));
}

}  // namespace

// Counts one corner of a quadrilateral per pair of a spine point and a cross-section point.
std::size_t cost_of_extrusion(const SceneGraph& scene, NodeId geometry) {
  constexpr std::size_t kOfPoint = 8;
  return scene.get<MFVec2f>(geometry, "crossSection").size() * scene.get<MFVec3f>(geometry, "spine").size() * kOfPoint;
}

Mesh tessellate_extrusion(const SceneGraph& scene, NodeId geometry, const MeshOptions&) {
  Extrusion extrusion;
  extrusion.cross_section = scene.get<MFVec2f>(geometry, "crossSection");
  extrusion.spine = scene.get<MFVec3f>(geometry, "spine");
  extrusion.scale = scene.get<MFVec2f>(geometry, "scale");
  extrusion.orientation = scene.get<MFRotation>(geometry, "orientation");
  extrusion.ccw = scene.get<SFBool>(geometry, "ccw");
  extrusion.solid = scene.get<SFBool>(geometry, "solid");
  extrusion.crease_angle = scene.get<SFFloat>(geometry, "creaseAngle");
  extrusion.budget = scene.budget();

  Mesh mesh;
  if (extrusion.cross_section.size() >= 2) {
    // Two short lists can give a large mesh. Beyond the limit, omits the end of the spine.
    constexpr std::size_t kBytesOfPoint = 60, kBytesAtWorst = 600;  // during extrusion; in total with faces and mesh
    const std::size_t columns = extrusion.cross_section.size();
    const std::size_t points = scene.budget()->left(Resource::meshes) / (2 * kBytesAtWorst);
    extrusion.rings = std::min(extrusion.spine.size(), points / columns);
    Share share(scene.budget(), Resource::meshes);
    mesh.limited = extrusion.rings < extrusion.spine.size();
    if (extrusion.rings >= 2 && share.grow(extrusion.rings * columns * kBytesOfPoint)) {
      const bool cut = mesh.limited;
      const MFVec3f placed = extrusion.place_cross_sections();
      mesh = extrusion.sides(placed);
      if (scene.get<SFBool>(geometry, "beginCap")) append(mesh, extrusion.cap(placed, true));
      if (scene.get<SFBool>(geometry, "endCap")) append(mesh, extrusion.cap(placed, false));
      mesh.limited = mesh.limited || cut;
    }
  }
  mesh.solid = extrusion.solid;
  return mesh;
}

}  // namespace gs::vrml
