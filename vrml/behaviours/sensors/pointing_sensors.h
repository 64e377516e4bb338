#pragma once

#include "vrml/event_model/states.h"
#include "vrml/events/execution.h"

#include <cmath>

// Functions that all pointing-device sensors share; see pointing.h.
namespace gs::vrml {

inline constexpr int kSensorEnabled = 0;  // event index of `enabled` in all these sensors

/// Implements Behaviour::on_event for all pointing-device sensors; the next function implements on_time.
bool pointing_sensor_event(Execution& execution, EventNode node, int event, const FieldValue& value);
void pointing_sensor_time(Execution& execution, EventNode node);

[[nodiscard]] inline PointingState& pointing_state(Execution& execution, EventNode node) {
  return execution.states().pointing[execution.nodes().state_of(node)];
}

/// Sends a value only if all its components are finite. Returns true if the value was sent.
template <class Vector>
bool send_finite(Execution& execution, EventNode node, int event, const Vector& value) {
  float sum = 0;
  for (int i = 0; i < Vector::length(); ++i) sum += value[i] * 0.0f;  // becomes NaN if a component is not finite
  if (sum != 0) return false;
  execution.send(node, event, value);
  return true;
}

}  // namespace gs::vrml
