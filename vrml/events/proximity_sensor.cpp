#include "vrml/events/execution.h"
#include "vrml/events/rotations.h"

#include <glm/glm.hpp>

#include <cmath>

namespace gs::vrml {
namespace {

struct Proximity {
  enum : int { center, size, enabled, is_active, position, orientation, enter_time, exit_time };
};

// The columns made perpendicular and of length 1; false where they have no direction.
bool orthonormal(glm::dmat3& m) {
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < i; ++k) m[i] -= m[k] * glm::dot(m[k], m[i]);
    const double length = glm::length(m[i]);
    if (!(length > 0) || !std::isfinite(length)) return false;
    m[i] /= length;
  }
  if (glm::determinant(m) < 0) m[2] = -m[2];
  return true;
}

// The first place of the sensor whose box the viewer is in (6.38): viewer in the sensor's space.
bool viewer_inside(Execution& execution, EventNode node, glm::dmat4& sensor_from_viewer) {
  const auto& size = execution.get<SFVec3f>(node, Proximity::size);
  const auto& center = execution.get<SFVec3f>(node, Proximity::center);
  const glm::dmat4 viewer = execution.viewer();
  for (const glm::dmat4& world_from_sensor : execution.places_of(node)) {
    sensor_from_viewer = glm::inverse(world_from_sensor) * viewer;
    const glm::dvec3 offset = glm::dvec3(sensor_from_viewer[3]) - glm::dvec3(center);
    bool inside = true;  // false for what is no number
    for (int i = 0; i < 3; ++i) inside = inside && std::abs(offset[i]) <= double{size[i]} / 2;
    if (inside) return true;
  }
  return false;
}

void leave(Execution& execution, EventNode node) {
  execution.send(node, Proximity::is_active, SFBool{false});
  execution.send(node, Proximity::exit_time, SFTime{execution.now()});
}

void proximity_time(Execution& execution, EventNode node) {
  const auto& size = execution.get<SFVec3f>(node, Proximity::size);
  // A box without volume is never entered.
  const bool on = execution.get<SFBool>(node, Proximity::enabled) && size.x > 0 && size.y > 0 && size.z > 0;
  const bool active = execution.get<SFBool>(node, Proximity::is_active);
  execution.run(node, on);
  glm::dmat4 sensor_from_viewer(1);
  if (!on || !viewer_inside(execution, node, sensor_from_viewer)) {
    if (active && !execution.has_sent(node, Proximity::is_active)) {
      leave(execution, node);
    } else if (active) {
      execution.run(node, true);
    }
    return;
  }
  if (!active && execution.has_sent(node, Proximity::is_active)) return;
  if (!active) {
    execution.send(node, Proximity::is_active, SFBool{true});
    execution.send(node, Proximity::enter_time, SFTime{execution.now()});
  }
  const SFVec3f position(sensor_from_viewer[3]);
  if (!active || position != execution.get<SFVec3f>(node, Proximity::position))
    execution.send(node, Proximity::position, position);
  glm::dmat3 turned(sensor_from_viewer);
  const SFRotation orientation = orthonormal(turned) ? rotation_of(glm::quat_cast(turned)) : SFRotation{};
  if (!active || orientation != execution.get<SFRotation>(node, Proximity::orientation))
    execution.send(node, Proximity::orientation, orientation);
}

bool proximity_event(Execution& execution, EventNode node, int, const FieldValue&) {
  execution.look_again(node);
  return true;
}

}  // namespace

const Behaviour kProximitySensorBehaviour = {
    {"center", "size", "enabled", "isActive", "position_changed", "orientation_changed", "enterTime", "exitTime"},
    [](Execution& execution, EventNode node) { execution.look_again(node); },
    proximity_event,
    proximity_time};

}  // namespace gs::vrml
