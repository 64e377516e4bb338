#pragma once

#include "vrml/events/execution.h"
#include "vrml/events/states.h"

#include <cmath>

// What the pointing-device sensors have in common; see pointing.h.
namespace gs::vrml {

inline constexpr int kSensorEnabled = 0;  // of the events of each of them

/// Behaviour::on_event and on_time of all of them.
bool pointing_sensor_event(Execution& execution, EventNode node, int event, const FieldValue& value);
void pointing_sensor_time(Execution& execution, EventNode node);

[[nodiscard]] inline PointingState& pointing_state(Execution& execution, EventNode node) {
  return execution.states().pointing[execution.state_of(node)];
}

/// Sends a value whose components are finite numbers, no other one. Whether it did.
template <class Vector>
bool send_finite(Execution& execution, EventNode node, int event, const Vector& value) {
  float sum = 0;
  for (int i = 0; i < Vector::length(); ++i) sum += value[i] * 0.0f;  // NaN where one is not
  if (sum != 0) return false;
  execution.send(node, event, value);
  return true;
}

}  // namespace gs::vrml
