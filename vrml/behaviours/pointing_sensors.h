#pragma once

#include "vrml/events/execution.h"
#include "vrml/event_model/states.h"

#include <cmath>

// Functions that all pointing-device sensors share; see pointing.h.
namespace gs::vrml {

inline constexpr int kSensorEnabled = 0;  // event index that all of them share

/// Implement Behaviour::on_event and on_time for all pointing-device sensors.
bool pointing_sensor_event(Execution& execution, EventNode node, int event, const FieldValue& value);
void pointing_sensor_time(Execution& execution, EventNode node);

[[nodiscard]] inline PointingState& pointing_state(Execution& execution, EventNode node) {
  return execution.states().pointing[execution.nodes().state_of(node)];
}

/// Sends a value only if all its components are finite. Returns whether it was sent.
template <class Vector>
bool send_finite(Execution& execution, EventNode node, int event, const Vector& value) {
  float sum = 0;
  for (int i = 0; i < Vector::length(); ++i) sum += value[i] * 0.0f;  // NaN if a component is not finite
  if (sum != 0) return false;
  execution.send(node, event, value);
  return true;
}

}  // namespace gs::vrml
