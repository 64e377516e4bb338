#include "vrml/tessellation/nurbs.h"

#include "vrml/mesh/face_set.h"
#include "vrml/mesh/vertices.h"
#include "vrml/tessellation/tessellators.h"

#include <glm/geometric.hpp>
#include <glm/vec4.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace gs::vrml {
namespace {

/// Returns x / by, or 0 if by is 0: there is no basis function between coincident knots (Cox-de Boor recurrence).
double divided(double x, double by) { return by > 0 ? x / by : 0; }

bool usable_knots(std::span<const float> knots, std::size_t points, std::size_t order) {
  return knots.size() == points + order &&
         std::all_of(knots.begin(), knots.end(), [](float knot) { return std::isfinite(knot); }) &&
         std::is_sorted(knots.begin(), knots.end()) && knots[order - 1] < knots[points];
}

/// Returns the weight of control point `i`: from the node if it has one weight per point, otherwise 1.
double weight_of(const MFFloat& weights, std::size_t points, std::size_t i) {
  return weights.size() == points && weights[i] > 0 && std::isfinite(weights[i]) ? weights[i] : 1;
}

glm::dvec3 wide(const glm::vec3& point) { return point; }
glm::dvec3 wide(const glm::vec2& point) { return {point, 0}; }

/// NURBS surface: two parameter directions, and columns x rows control points with weights, row by row.
template <class Point>
class Surface {
 public:
  Surface(NurbsAxis u, NurbsAxis v, Array<Point> points, MFFloat weights)
      : u_(std::move(u)), v_(std::move(v)), points_(std::move(points)), weights_(std::move(weights)) {}

  struct Place {
    glm::dvec3 point{}, along_u{}, along_v{};
  };

  /// Calls take(column, row, Place) for all corners of a subdivision into columns x rows, row by row.
  template <class Take>
  void sample(std::size_t columns, std::size_t rows, const Take& take) const {
    std::vector<NurbsAxis::Weights> across;
    across.reserve(columns + 1);
    for (std::size_t i = 0; i <= columns; ++i)
      across.push_back(u_.at(static_cast<double>(i) / static_cast<double>(columns)));
    // Control points (w x, w y, w z, w) of the curve for one row of corners, and their derivative in the other
    // direction.
    std::vector<glm::dvec4> curve(u_.points()), motion(u_.points());
    const std::size_t count = u_.points() * v_.points();
    for (std::size_t j = 0; j <= rows; ++j) {
      const NurbsAxis::Weights along = v_.at(static_cast<double>(j) / static_cast<double>(rows));
      for (std::size_t i = 0; i < u_.points(); ++i) {
        curve[i] = motion[i] = glm::dvec4(0);
        for (std::size_t k = 0; k < v_.order(); ++k) {
          const std::size_t at = (along.first + k) * u_.points() + i;
          const double weight = weight_of(weights_, count, at);
          const glm::dvec4 control(wide(points_[at]) * weight, weight);
          curve[i] += control * along.value[k];
          motion[i] += control * along.slope[k];
        }
      }
      for (std::size_t i = 0; i <= columns; ++i) {
        glm::dvec4 point(0), by_u(0), by_v(0);
        for (std::size_t k = 0; k < u_.order(); ++k) {
          const std::size_t at = across[i].first + k;
          point += curve[at] * across[i].value[k];
          by_u += curve[at] * across[i].slope[k];
          by_v += motion[at] * across[i].value[k];
        }
        Place place;
        place.point = glm::dvec3(point) / point.w;
        place.along_u = (glm::dvec3(by_u) - place.point * by_u.w) / point.w;
        place.along_v = (glm::dvec3(by_v) - place.point * by_v.w) / point.w;
        take(i, j, place);
      }
    }
  }

  [[nodiscard]] const NurbsAxis& u() const { return u_; }
  [[nodiscard]] const NurbsAxis& v() const { return v_; }

 private:
  NurbsAxis u_, v_;
  Array<Point> points_;
  MFFloat weights_;
};

/// Returns the surface of a NurbsSurface (vec3) or of a NurbsTextureSurface (vec2). Returns nullopt if the node does
/// not define a valid surface.
template <class Point>
std::optional<Surface<Point>> surface_of(const SceneGraph& scene, NodeId node, const Array<Point>& points) {
  const auto columns = scene.get<SFInt32>(node, "uDimension"), rows = scene.get<SFInt32>(node, "vDimension");
  if (columns < 2 || rows < 2 || static_cast<std::size_t>(columns) > points.size() / static_cast<std::size_t>(rows))
    return std::nullopt;
  auto u = NurbsAxis::make(static_cast<std::size_t>(columns), scene.get<SFInt32>(node, "uOrder"),
                           scene.get<MFFloat>(node, "uKnot").span());
  auto v = NurbsAxis::make(static_cast<std::size_t>(rows), scene.get<SFInt32>(node, "vOrder"),
                           scene.get<MFFloat>(node, "vKnot").span());
  if (!u || !v) return std::nullopt;
  return Surface<Point>(std::move(*u), std::move(*v), points, scene.get<MFFloat>(node, "weight"));
}

/// Returns texture coordinates. Their source is the control points, a texture surface, or the unit square.
MFVec2f texture_of(const SceneGraph& scene, NodeId geometry, const Surface<glm::vec3>& surface, std::size_t columns,
                   std::size_t rows) {
  const NodeId given = scene.get<SFNode>(geometry, "texCoord");
  std::optional<Surface<glm::vec2>> picture;
  if (const NodeId node = scene.resolve_as(given, NodeKind::nurbs_texture_surface)) {
    picture = surface_of(scene, node, scene.get<MFVec2f>(node, "controlPoint"));
  } else if (const NodeId list = scene.resolve_as(given, NodeKind::texture_coordinate)) {
    const MFVec2f points = scene.get<MFVec2f>(list, "point");
    if (points.size() >= surface.u().points() * surface.v().points())
      picture.emplace(surface.u(), surface.v(), points, scene.get<MFFloat>(geometry, "weight"));
  }
  MFVec2f coordinates;
  const std::size_t count = (columns + 1) * (rows + 1);
  glm::vec2* next = coordinates.prepare(count);
  if (picture) {
    picture->sample(columns, rows, [&](std::size_t, std::size_t, const Surface<glm::vec2>::Place& place) {
      *next++ = glm::vec2(place.point);
    });
  } else {
    for (std::size_t j = 0; j <= rows; ++j)
      for (std::size_t i = 0; i <= columns; ++i)
        *next++ = {static_cast<float>(i) / static_cast<float>(columns),
                   static_cast<float>(j) / static_cast<float>(rows)};
  }
  coordinates.commit(count);
  return coordinates;
}

}  // namespace

std::optional<NurbsAxis> NurbsAxis::make(std::size_t points, std::int32_t order, std::span<const float> knots) {
  if (order < 2 || order > kMaximumOrder || points < static_cast<std::size_t>(order)) return std::nullopt;
  NurbsAxis axis;
  axis.points_ = points;
  axis.order_ = static_cast<std::size_t>(order);
  axis.knots_.resize(points + axis.order_);
  if (usable_knots(knots, points, axis.order_)) {
    std::copy(knots.begin(), knots.end(), axis.knots_.begin());
  } else {
    const std::size_t pieces = points - axis.order_ + 1;
    for (std::size_t i = 0; i < axis.knots_.size(); ++i)
      axis.knots_[i] = static_cast<double>(std::clamp(i, axis.order_ - 1, axis.order_ - 1 + pieces));
  }
  return axis;
}

NurbsAxis::Weights NurbsAxis::at(double place) const {
  const double begin = knots_[order_ - 1], end = knots_[points_];
  const double t = begin + (end - begin) * (place > 0 ? std::min(place, 1.0) : 0);
  // Finds the knot interval that contains t. For the end of the axis, finds the last interval that is not empty.
  const auto from = knots_.begin() + static_cast<std::ptrdiff_t>(order_ - 1);
  const auto to = knots_.begin() + static_cast<std::ptrdiff_t>(points_);
  const auto above = t < end ? std::upper_bound(from, to, t) : std::lower_bound(from, to, end);
  const auto piece = static_cast<std::size_t>(above - knots_.begin()) - 1;

  Weights weights;
  weights.first = piece + 1 - order_;
  std::array<double, kMaximumOrder> below{};  // basis functions of the next lower order, for the slopes
  weights.value[0] = 1;
  for (std::size_t degree = 1; degree < order_; ++degree) {
    if (degree == order_ - 1) below = weights.value;
    double carried = 0;
    for (std::size_t k = 0; k < degree; ++k) {
      const double left = knots_[piece + k + 1 - degree], right = knots_[piece + k + 1];
      const double share = divided(weights.value[k], right - left);
      weights.value[k] = carried + (right - t) * share;
      carried = (t - left) * share;
    }
    weights.value[degree] = carried;
  }
  const auto degree = order_ - 1;
  double falling = 0;
  for (std::size_t k = 0; k <= degree; ++k) {
    const double left = knots_[piece + k + 1 - degree], right = k < degree ? knots_[piece + k + 1] : left;
    const double rising = k < degree ? divided(below[k], right - left) : 0;
    weights.slope[k] = static_cast<double>(degree) * (falling - rising) * (end - begin);
    falling = rising;
  }
  return weights;
}

std::size_t NurbsAxis::steps(std::int32_t tessellation) const {
  constexpr std::size_t kMax = 2048, kMin = 16;
  const auto size = static_cast<std::size_t>(std::abs(static_cast<std::int64_t>(tessellation)));
  const std::size_t points = std::min(points_, kMax);
  if (tessellation == 0) return std::clamp(2 * points, kMin, kMax);
  return std::min(tessellation > 0 ? size : std::min(size, kMax) * points, kMax);
}

// Counts one quadrilateral with normals per interval.
std::size_t cost_of_nurbs_surface(const SceneGraph& scene, NodeId geometry) {
  constexpr std::size_t kOfPiece = 16;
  const auto surface = surface_of(scene, geometry, scene.get<MFVec3f>(geometry, "controlPoint"));
  if (!surface) return 0;
  return surface->u().steps(scene.get<SFInt32>(geometry, "uTessellation")) *
         surface->v().steps(scene.get<SFInt32>(geometry, "vTessellation")) * kOfPiece;
}

Mesh tessellate_nurbs_surface(const SceneGraph& scene, NodeId geometry, const MeshOptions& options) {
  Mesh nothing;
  nothing.solid = scene.get<SFBool>(geometry, "solid");
  const auto surface = surface_of(scene, geometry, scene.get<MFVec3f>(geometry, "controlPoint"));
  if (!surface) return nothing;
  const std::size_t columns = surface->u().steps(scene.get<SFInt32>(geometry, "uTessellation"));
  const std::size_t rows = surface->v().steps(scene.get<SFInt32>(geometry, "vTessellation"));
  const std::size_t count = (columns + 1) * (rows + 1);
  constexpr std::uint64_t kBytesOfPoint = 64;
  Share share(scene.budget(), Resource::meshes);
  if (!share.grow(count * kBytesOfPoint)) {
    nothing.limited = true;
    return nothing;
  }
  FaceSet faces;
  faces.budget = scene.budget();
  faces.solid = nothing.solid;
  faces.ccw = scene.get<SFBool>(geometry, "ccw");
  MFVec3f normals;
  glm::vec3* point = faces.points.prepare(count);
  glm::vec3* normal = normals.prepare(count);
  surface->sample(columns, rows, [&](std::size_t, std::size_t, const Surface<glm::vec3>::Place& place) {
    *point++ = glm::vec3(place.point);
    const glm::dvec3 up = glm::cross(place.along_u, place.along_v);
    const double length = glm::length(up);
    *normal++ = length > 0 ? glm::vec3(up / length * (faces.ccw ? 1.0 : -1.0)) : glm::vec3(0);
  });
  faces.points.commit(count);
  normals.commit(count);
  faces.normal = {normals, true, {}};
  if (options.texture_coordinates)
    faces.texture_coordinate = {texture_of(scene, geometry, *surface, columns, rows), true, {}};
  const std::size_t size = 5 * columns * rows;
  std::int32_t* index = faces.coord_index.prepare(size);
  for (std::size_t j = 0; j < rows; ++j)
    for (std::size_t i = 0; i < columns; ++i) {
      const auto here = static_cast<std::int32_t>(j * (columns + 1) + i),
                 next_row = static_cast<std::int32_t>(columns + 1);
      for (const std::int32_t corner : {here, here + 1, here + next_row + 1, here + next_row, -1}) *index++ = corner;
    }
  faces.coord_index.commit(size);
  return make_mesh(std::move(faces));
}

Mesh tessellate_nurbs_curve(const SceneGraph& scene, NodeId geometry, const MeshOptions&) {
  Mesh mesh;
  mesh.primitive = Mesh::Primitive::lines;
  mesh.solid = false;
  mesh.lit = false;
  const MFVec3f points = scene.get<MFVec3f>(geometry, "controlPoint");
  const MFFloat weights = scene.get<MFFloat>(geometry, "weight");
  const auto axis = NurbsAxis::make(points.size(), scene.get<SFInt32>(geometry, "order"),
                                    scene.get<MFFloat>(geometry, "knot").span());
  if (!axis) return mesh;
  const std::size_t steps = axis->steps(scene.get<SFInt32>(geometry, "tessellation"));
  glm::vec3* position = mesh.positions.prepare(steps + 1);
  for (std::size_t i = 0; i <= steps; ++i)
    *position++ = nurbs_point(*axis, points, weights, static_cast<double>(i) / static_cast<double>(steps));
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

SFVec3f nurbs_point(const NurbsAxis& axis, const MFVec3f& points, const MFFloat& weights, double place) {
  const NurbsAxis::Weights at = axis.at(place);
  glm::dvec4 sum(0);
  for (std::size_t k = 0; k < axis.order(); ++k) {
    const double weight = weight_of(weights, axis.points(), at.first + k);
    sum += glm::dvec4(wide(points[at.first + k]) * weight, weight) * at.value[k];
  }
  return glm::vec3(glm::dvec3(sum) / sum.w);
}

}  // namespace gs::vrml
