#include "vrml/tessellation/nurbs_nodes.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace gs::vrml {
namespace {

const FieldValue* value_of(const SceneGraph& scene, NodeId node, std::string_view field) {
  const InterfaceDeclaration* const declared = scene.node(node).type->find_field(field);
  return declared ? &scene.node(node).values[declared->slot] : nullptr;
}

template <class T>
T given_or(const SceneGraph& scene, NodeId node, std::string_view field, T otherwise) {
  const FieldValue* const value = value_of(scene, node, field);
  const T* const given = value ? std::get_if<T>(value) : nullptr;
  return given ? *given : otherwise;
}

std::vector<glm::dvec3> points_of_value(const FieldValue& value) {
  std::vector<glm::dvec3> points;
  if (const auto* list = std::get_if<MFVec3f>(&value)) points.assign(list->begin(), list->end());
  if (const auto* list = std::get_if<MFVec3d>(&value)) points.assign(list->begin(), list->end());
  if (const auto* list = std::get_if<MFVec2f>(&value))
    for (const SFVec2f& point : *list) points.emplace_back(point, 0);
  if (const auto* list = std::get_if<MFVec2d>(&value))
    for (const SFVec2d& point : *list) points.emplace_back(point, 0);
  return points;
}

// Returns control points with their weights. Points are homogeneous: files contain (w x, w y, w z). Weights <= 0 count
// as 1, and all of them if their number differs.
std::vector<glm::dvec4> weighted(const std::vector<glm::dvec3>& points, const std::vector<double>& weights) {
  std::vector<glm::dvec4> result;
  result.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const bool given = weights.size() == points.size() && weights[i] > 0 && std::isfinite(weights[i]);
    result.emplace_back(points[i], given ? weights[i] : 1);
  }
  return result;
}

/// Axis for `points` control points. A closed axis repeats the first points after the last one.
struct ClosableAxis {
  std::optional<NurbsAxis> axis;
  std::size_t own = 0;  // number of different points; point i of the axis is point i % own
};
// Reports whether knots make a curve begin at its first and end at its last point.
bool are_clamped(const std::vector<double>& knots, std::size_t points, std::size_t order) {
  return knots.size() == points + order && knots.front() == knots[order - 1] && knots[points] == knots.back() &&
         knots.front() < knots.back();
}

// Makes an axis. If `closed` and the first and last point are equal, the axis joins itself smoothly: it gets uniform
// knots that reach neither end. Clamped knots remain, because they close the curve already, as those of a circle do.
ClosableAxis make_axis(std::size_t points, std::int32_t order, const std::vector<double>& knots, bool closed) {
  const auto size = static_cast<std::size_t>(std::clamp(order, 2, NurbsAxis::kMaximumOrder));
  if (!closed || points < size + 1 || order != static_cast<std::int32_t>(size) || are_clamped(knots, points, size))
    return {NurbsAxis::make(points, order, std::span<const double>(knots)), points};
  const std::size_t own = points - 1, repeated = own + size - 1;
  std::vector<double> uniform(repeated + size);
  for (std::size_t i = 0; i < uniform.size(); ++i) uniform[i] = static_cast<double>(i);
  return {NurbsAxis::make(repeated, order, std::span<const double>(uniform)), own};
}

}  // namespace

std::vector<double> numbers_of(const SceneGraph& scene, NodeId node, std::string_view field) {
  const FieldValue* const value = value_of(scene, node, field);
  if (!value) return {};
  if (const auto* list = std::get_if<MFFloat>(value)) return {list->begin(), list->end()};
  if (const auto* list = std::get_if<MFDouble>(value)) return {list->begin(), list->end()};
  return {};
}

std::vector<glm::dvec3> points_of(const SceneGraph& scene, NodeId node, std::string_view field) {
  const FieldValue* value = value_of(scene, node, field);
  if (const auto* given = value ? std::get_if<SFNode>(value) : nullptr) {
    const NodeId list = scene.resolve(*given);
    value = list ? value_of(scene, list, "point") : nullptr;
  }
  return value ? points_of_value(*value) : std::vector<glm::dvec3>();
}

std::optional<NurbsCurve> NurbsCurve::make(const SceneGraph& scene, NodeId node) {
  std::vector<glm::dvec4> points = weighted(points_of(scene, node, "controlPoint"), numbers_of(scene, node, "weight"));
  const bool closed =
      given_or<SFBool>(scene, node, "closed", false) && points.size() > 1 && points.front() == points.back();
  ClosableAxis made =
      make_axis(points.size(), given_or<SFInt32>(scene, node, "order", 3), numbers_of(scene, node, "knot"), closed);
  if (!made.axis) return std::nullopt;
  const std::size_t own = made.own;
  points.resize(made.axis->points());
  for (std::size_t i = own; i < points.size(); ++i) points[i] = points[i % own];
  return NurbsCurve(std::move(*made.axis), std::move(points));
}

glm::dvec3 NurbsCurve::at(double place) const {
  const NurbsAxis::Weights weights = axis_.at(place);
  glm::dvec4 sum(0);
  for (std::size_t k = 0; k < axis_.order(); ++k) sum += points_[weights.first + k] * weights.value[k];
  return glm::dvec3(sum) / sum.w;
}

std::vector<glm::dvec3> polyline_of(const SceneGraph& scene, NodeId node) {
  const NodeId curve_node = scene.resolve(node);
  if (!curve_node) return {};
  if (!scene.node(curve_node).type->find_field("order")) return points_of(scene, curve_node, "controlPoint");
  const auto curve = NurbsCurve::make(scene, curve_node);
  if (!curve) return {};
  const std::size_t steps = curve->axis().steps(given_or<SFInt32>(scene, curve_node, "tessellation", 0));
  std::vector<glm::dvec3> points;
  points.reserve(steps + 1);
  for (std::size_t i = 0; i <= steps; ++i)
    points.push_back(curve->at(static_cast<double>(i) / static_cast<double>(steps)));
  return points;
}

std::optional<NurbsSurface> NurbsSurface::make(const SceneGraph& scene, NodeId node) {
  const auto given_columns = given_or<SFInt32>(scene, node, "uDimension", 0);
  const auto given_rows = given_or<SFInt32>(scene, node, "vDimension", 0);
  if (given_columns < 2 || given_rows < 2) return std::nullopt;
  const auto columns = static_cast<std::size_t>(given_columns), rows = static_cast<std::size_t>(given_rows);
  std::vector<glm::dvec3> given = points_of(scene, node, "controlPoint");
  if (columns > given.size() / rows) return std::nullopt;
  given.resize(columns * rows);
  const std::vector<glm::dvec4> points = weighted(given, numbers_of(scene, node, "weight"));
  const auto all = [](std::size_t count, const auto& test) {
    for (std::size_t i = 0; i < count; ++i)
      if (!test(i)) return false;
    return true;
  };
  const bool u_closed = given_or<SFBool>(scene, node, "uClosed", false) &&
                        all(rows, [&](std::size_t j) { return points[j * columns] == points[(j + 1) * columns - 1]; });
  const bool v_closed = given_or<SFBool>(scene, node, "vClosed", false) &&
                        all(columns, [&](std::size_t i) { return points[i] == points[(rows - 1) * columns + i]; });
  ClosableAxis u =
      make_axis(columns, given_or<SFInt32>(scene, node, "uOrder", 3), numbers_of(scene, node, "uKnot"), u_closed);
  ClosableAxis v =
      make_axis(rows, given_or<SFInt32>(scene, node, "vOrder", 3), numbers_of(scene, node, "vKnot"), v_closed);
  if (!u.axis || !v.axis) return std::nullopt;
  std::vector<glm::dvec4> repeated;
  repeated.reserve(u.axis->points() * v.axis->points());
  for (std::size_t j = 0; j < v.axis->points(); ++j)
    for (std::size_t i = 0; i < u.axis->points(); ++i) repeated.push_back(points[(j % v.own) * columns + i % u.own]);
  return NurbsSurface(std::move(*u.axis), std::move(*v.axis), std::move(repeated));
}

std::optional<NurbsSurface> NurbsSurface::with_points(const std::vector<glm::dvec3>& points) const {
  if (points.size() < points_.size()) return std::nullopt;
  NurbsSurface result = *this;
  for (std::size_t i = 0; i < points_.size(); ++i)
    result.points_[i] = glm::dvec4(points[i] * points_[i].w, points_[i].w);
  return result;
}

NurbsSurface::Place NurbsSurface::at(double u, double v) const {
  Row row;
  read_row(v_.at(v), row);
  return place_in(row, u_.at(u));
}

void NurbsSurface::read_row(const NurbsAxis::Weights& along, Row& row) const {
  row.curve.assign(u_.points(), glm::dvec4(0));
  row.motion.assign(u_.points(), glm::dvec4(0));
  for (std::size_t i = 0; i < u_.points(); ++i)
    for (std::size_t k = 0; k < v_.order(); ++k) {
      const glm::dvec4& control = points_[(along.first + k) * u_.points() + i];
      row.curve[i] += control * along.value[k];
      row.motion[i] += control * along.slope[k];
    }
}

NurbsSurface::Place NurbsSurface::place_in(const Row& row, const NurbsAxis::Weights& across) const {
  glm::dvec4 point(0), by_u(0), by_v(0);
  for (std::size_t k = 0; k < u_.order(); ++k) {
    const std::size_t at = across.first + k;
    point += row.curve[at] * across.value[k];
    by_u += row.curve[at] * across.slope[k];
    by_v += row.motion[at] * across.value[k];
  }
  Place place;
  place.point = glm::dvec3(point) / point.w;
  place.along_u = (glm::dvec3(by_u) - place.point * by_u.w) / point.w;
  place.along_v = (glm::dvec3(by_v) - place.point * by_v.w) / point.w;
  return place;
}

}  // namespace gs::vrml
