#include "vrml/events/execution.h"
#include "vrml/tessellation/nurbs_nodes.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <optional>

// Interpolators along NURBS curves and surfaces of X3D (ISO/IEC 19775-1 27.4.5, 27.4.7, 27.4.9). Their control points
// are in a node that other nodes may share.
namespace gs::vrml {
namespace {

enum : int { kSetFraction, kValueChanged };                  // events of curves
enum : int { kSetPlace, kPositionChanged, kNormalChanged };  // events of surfaces

// Returns the number of control points, for the budget of events.
std::size_t size_of(const SceneGraph& scene, NodeId node) {
  const NodeId points = scene.resolve(scene.get<SFNode>(node, "controlPoint"));
  const InterfaceDeclaration* const list = points ? scene.node(points).type->find_field("point") : nullptr;
  return list ? element_count(scene.node(points).values[list->slot]) : 0;
}

std::optional<NurbsCurve> curve_of(Execution& execution, EventNode node) {
  const NodePlace at = execution.nodes().place_of(node);
  if (!execution.budget().spend(size_of(*at.scene, at.node))) return std::nullopt;
  return NurbsCurve::make(*at.scene, at.node);
}

bool is_finite(const glm::dvec3& value) {
  return std::isfinite(value.x) && std::isfinite(value.y) && std::isfinite(value.z);
}

bool set_position(Execution& execution, EventNode node, int event, const FieldValue& value) {
  if (event != kSetFraction) return true;
  const auto curve = curve_of(execution, node);
  if (!curve) return false;
  const glm::dvec3 point = curve->at(std::get<SFFloat>(value));
  if (is_finite(point)) execution.send(node, kValueChanged, SFVec3f(point));
  return false;
}

// Returns the rotation from the z axis to a direction.
SFRotation rotation_to(const glm::dvec3& direction) {
  const glm::dvec3 axis = glm::cross(glm::dvec3(0, 0, 1), direction);
  const double sine = glm::length(axis);
  const double angle = std::atan2(sine, direction.z);
  if (sine < 1e-12) return {0, 1, 0, static_cast<float>(direction.z < 0 ? angle : 0)};
  const glm::dvec3 unit = axis / sine;
  return {static_cast<float>(unit.x), static_cast<float>(unit.y), static_cast<float>(unit.z),
          static_cast<float>(angle)};
}

// Sends the orientation along the tangent. The tangent is that of a short chord.
bool set_orientation(Execution& execution, EventNode node, int event, const FieldValue& value) {
  if (event != kSetFraction) return true;
  const auto curve = curve_of(execution, node);
  if (!curve) return false;
  constexpr double kHalfChord = 1e-4;
  const double place = std::clamp(static_cast<double>(std::get<SFFloat>(value)), 0.0, 1.0);
  const glm::dvec3 chord = curve->at(std::min(place + kHalfChord, 1.0)) - curve->at(std::max(place - kHalfChord, 0.0));
  const double length = glm::length(chord);
  if (length > 0 && std::isfinite(length)) execution.send(node, kValueChanged, rotation_to(chord / length));
  return false;
}

bool set_place(Execution& execution, EventNode node, int event, const FieldValue& value) {
  if (event != kSetPlace) return true;
  const NodePlace at = execution.nodes().place_of(node);
  if (!execution.budget().spend(size_of(*at.scene, at.node))) return false;
  const auto surface = NurbsSurface::make(*at.scene, at.node);
  if (!surface) return false;
  const auto& given = std::get<SFVec2f>(value);
  const NurbsSurface::Place place = surface->at(given.x, given.y);
  if (!is_finite(place.point)) return false;
  execution.send(node, kPositionChanged, SFVec3f(place.point));
  const glm::dvec3 normal = glm::cross(place.along_u, place.along_v);
  const double length = glm::length(normal);
  if (length > 0 && std::isfinite(length)) execution.send(node, kNormalChanged, SFVec3f(normal / length));
  return false;
}

}  // namespace

const Behaviour kNurbsCurvePositionBehaviour = {.events = {"set_fraction", "value_changed"}, .on_event = set_position};
const Behaviour kNurbsOrientationInterpolatorBehaviour = {.events = {"set_fraction", "value_changed"},
                                                          .on_event = set_orientation};
const Behaviour kNurbsSurfaceInterpolatorBehaviour = {.events = {"set_fraction", "position_changed", "normal_changed"},
                                                      .on_event = set_place};

}  // namespace gs::vrml
