#include "base/finite.h"
#include "vrml/behaviours/animation/rotations.h"
#include "vrml/behaviours/sensors/viewer_box.h"
#include "vrml/event_model/states.h"
#include "vrml/events/execution.h"
#include "vrml/scene/coordinates/geospatial.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace gs::vrml {
namespace {

struct Proximity {
  enum : int {
    center,
    size,
    enabled,
    is_active,
    position,
    orientation,
    enter_time,
    exit_time,
    center_of_rotation,
    geo_coord  // of GeoProximitySensor
  };
};

// Returns the centre of the box in local coordinates. The centre of a GeoProximitySensor has geospatial coordinates;
// its field `center` is an offset from there (X3D 25.3.8).
glm::dvec3 center_of(Execution& execution, EventNode node) {
  const EventNodes& nodes = execution.nodes();
  if (!nodes.has_event(node, Proximity::geo_coord)) return glm::dvec3(execution.get<SFVec3f>(node, Proximity::center));
  const EventMember& at = nodes[node];
  return geo_position(*at.scene, *at.node, "geoCenter") + *execution.get<SFVec3d>(node, Proximity::center);
}

// Makes the columns of a matrix orthonormal. Returns false if a column has no direction.
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

// Movement of the viewer between the last evaluation and now, assumed to be a straight line.
struct Look {
  bool inside = false;    // the viewer is inside the box of an instance of the sensor
  bool passed = false;    // the viewer is outside, but crossed a box on the way
  double entered_at = 0;  // time of entry if inside or passed; may precede the last evaluation if inside
  double left_at = 0;     // time of exit from the last box, if outside or passed
  glm::dmat4 sensor_from_viewer{1.0}, sensor_from_entered{1.0}, sensor_from_left{1.0};
};

// Computes the part of the path from `from` to `to` that is inside the box, as fractions 0 to 1. Returns false if no
// part is inside.
bool clip(const glm::dvec3& from, const glm::dvec3& to, const glm::dvec3& center, const glm::dvec3& size, double& first,
          double& last) {
  first = 0, last = 1;
  for (int i = 0; i < 3; ++i) {
    const double start = from[i] - center[i], way = to[i] - from[i], half = size[i] / 2;
    if (!std::isfinite(start) || !std::isfinite(way)) return false;
    if (way == 0) {
      if (std::abs(start) > half) return false;
      continue;
    }
    const double one = (-half - start) / way, other = (half - start) / way;
    first = std::max(first, std::min(one, other));
    last = std::min(last, std::max(one, other));
  }
  return first <= last;
}

glm::dmat4 moved_to(glm::dmat4 matrix, const glm::dvec3& place) {
  matrix[3] = glm::dvec4(place, 1);
  return matrix;
}

// Evaluates the movement of the viewer since the last evaluation. The times in the result are the times at which the
// viewer crossed the box (6.38). After a jump there is no path (6.53). If the sensor moved over the viewer, the time is
// now.
Look look_at(Execution& execution, EventNode node, ProximityState& state) {
  const glm::dvec3 size(execution.get<SFVec3f>(node, Proximity::size));
  const glm::dvec3 center = center_of(execution, node);
  const glm::dmat4 viewer = execution.viewer().pose();
  const double now = execution.now();
  const bool way_known = state.looked && state.viewer.jumps == execution.viewer().jumps() && state.viewer.time < now &&
                         std::isfinite(state.viewer.time);
  const bool was_inside = execution.get<SFBool>(node, Proximity::is_active);
  const auto time_at = [&](double part) { return state.viewer.time + (now - state.viewer.time) * part; };
  Look look;
  look.left_at = now;
  const auto places = execution.viewer().places_of(node);
  double best = -1;
  for (std::uint32_t i = 0; i < places.size() && !look.inside; ++i) {
    const glm::dmat4 sensor_from_world = glm::inverse(places[i]);
    const glm::dmat4 sensor_from_viewer = sensor_from_world * viewer;
    const glm::dvec3 to(sensor_from_viewer[3]), from(sensor_from_world * glm::dvec4(state.viewer.position, 1));
    look.inside = true;  // false if a coordinate is NaN
    for (int k = 0; k < 3; ++k) look.inside = look.inside && std::abs(to[k] - center[k]) <= size[k] / 2;
    double first = 0, last = 0;
    const bool met = way_known && clip(from, to, center, size, first, last);
    if (look.inside) {
      state.place = i;
      look.sensor_from_viewer = sensor_from_viewer;
      look.entered_at = met && first > 0 ? time_at(first) : now;
    } else if (was_inside ? met && last > best : met && first > 0 && first < last && !look.passed) {
      best = last;
      look.passed = !was_inside;
      look.entered_at = time_at(first);
      look.left_at = time_at(last);
      look.sensor_from_entered = moved_to(sensor_from_viewer, from + (to - from) * first);
      look.sensor_from_left = moved_to(sensor_from_viewer, from + (to - from) * last);
    } else if (best < 0 && (i == 0 || i == state.place)) {
      look.sensor_from_left = sensor_from_viewer;
    }
  }
  state.viewer = {glm::dvec3(viewer[3]), now, execution.viewer().jumps()};
  state.looked = true;
  return look;
}

// Sends the geospatial coordinates of the viewer from a GeoProximitySensor.
void send_coordinates(Execution& execution, EventNode node, const glm::dmat4& sensor_from_viewer, bool always) {
  if (!execution.nodes().has_event(node, Proximity::geo_coord)) return;
  const EventMember& at = execution.nodes()[node];
  const SFVec3d coordinates(GeoFrame::of(*at.scene, *at.node).coordinates(glm::dvec3(sensor_from_viewer[3])));
  if (!finite(*coordinates)) return;
  if (always || !(coordinates == execution.get<SFVec3d>(node, Proximity::geo_coord)))
    execution.send(node, Proximity::geo_coord, coordinates);
}

// Sends position and orientation if they have changed, or if `always` is set, as on entry and exit.
void send_place(Execution& execution, EventNode node, const glm::dmat4& sensor_from_viewer, bool always) {
  const SFVec3f position(sensor_from_viewer[3]);
  if (always || position != execution.get<SFVec3f>(node, Proximity::position))
    execution.send(node, Proximity::position, position);
  glm::dmat3 turned(sensor_from_viewer);
  const SFRotation orientation = orthonormal(turned) ? rotation_of(glm::quat_cast(turned)) : SFRotation{};
  if (always || orientation != execution.get<SFRotation>(node, Proximity::orientation))
    execution.send(node, Proximity::orientation, orientation);
  send_coordinates(execution, node, sensor_from_viewer, always);
  // centerOfRotation_changed (X3D 22.4.1)
  const std::optional<glm::dvec3> turns_about = execution.viewer().center();
  if (!turns_about || !execution.nodes().has_event(node, Proximity::center_of_rotation)) return;
  const SFVec3f about(sensor_from_viewer * glm::inverse(execution.viewer().pose()) * glm::dvec4(*turns_about, 1));
  if (always || about != execution.get<SFVec3f>(node, Proximity::center_of_rotation))
    execution.send(node, Proximity::center_of_rotation, about);
}

void enter(Execution& execution, EventNode node, double time, const glm::dmat4& sensor_from_viewer) {
  execution.send(node, Proximity::is_active, SFBool{true});
  execution.send(node, Proximity::enter_time, SFTime{time});
  send_place(execution, node, sensor_from_viewer, true);
}

void leave(Execution& execution, EventNode node, double time) {
  execution.send(node, Proximity::is_active, SFBool{false});
  execution.send(node, Proximity::exit_time, SFTime{time});
}

void proximity_time(Execution& execution, EventNode node) {
  const std::uint32_t place = execution.nodes().state_of(node);
  if (place == 0) return;  // no memory for the state
  ProximityState& state = execution.states().proximities[place];
  const auto& size = execution.get<SFVec3f>(node, Proximity::size);
  // A box without volume never contains the viewer.
  const bool on = execution.get<SFBool>(node, Proximity::enabled) && size.x > 0 && size.y > 0 && size.z > 0;
  const bool active = execution.get<SFBool>(node, Proximity::is_active);
  // isActive sends one event per timestamp (4.10.4); a second change waits for the next timestamp.
  const bool said = execution.has_sent(node, Proximity::is_active);
  execution.timers().run(node, on || (active && said));
  if (!on) {
    state.looked = false;
    if (!active || said) return;
    leave(execution, node, execution.now());
    state.passed = false;
    return;
  }
  if (state.passed && said) return;
  const Look look = look_at(execution, node, state);
  if (look.inside) {
    state.passed = false;
    if (active) {
      send_place(execution, node, look.sensor_from_viewer, false);
    } else if (!said) {
      enter(execution, node, look.entered_at, look.sensor_from_viewer);
    }
  } else if (said) {
    return;
  } else if (active) {
    const bool passed = std::exchange(state.passed, false);
    leave(execution, node, passed ? state.left_at : look.left_at);
    send_place(execution, node, passed ? state.sensor_from_left : look.sensor_from_left, true);
  } else if (look.passed) {
    enter(execution, node, look.entered_at, look.sensor_from_entered);
    state.passed = true;
    state.left_at = look.left_at;
    state.sensor_from_left = look.sensor_from_left;
  }
}

void proximity_begins(Execution& execution, EventNode node) {
  auto& states = execution.states().proximities;
  if (!states.has_spare() && !execution.budget().afford(2 * sizeof(ProximityState))) return;
  execution.nodes().state_of(node) = states.take();
  execution.timers().look_again(node);
}

// Only an enabled sensor that the viewer is outside of may rest.
std::optional<WideBox> proximity_idle_box(Execution& execution, EventNode node) {
  const std::uint32_t place = execution.nodes().state_of(node);
  if (place == 0 || execution.get<SFBool>(node, Proximity::is_active)) return {};
  const ProximityState& state = execution.states().proximities[place];
  if (!state.looked || state.passed) return {};
  return world_box_of(execution, node, center_of(execution, node),
                      glm::dvec3(execution.get<SFVec3f>(node, Proximity::size)) * 0.5);
}

void proximity_after_idle(Execution& execution, EventNode node, const ViewerMoment& last) {
  execution.states().proximities[execution.nodes().state_of(node)].viewer = last;
}

bool proximity_event(Execution& execution, EventNode node, int, const FieldValue&) {
  execution.timers().look_again(node);
  return true;
}

void proximity_ends(Execution& execution, EventNode node) {
  execution.states().proximities.give_back(execution.nodes().state_of(node));
}

}  // namespace

std::optional<WideBox> world_box_of(Execution& execution, EventNode node, const glm::dvec3& center,
                                    const glm::dvec3& half) {
  constexpr double kMaxCondition = 1e6;
  WideBox box;
  const auto places = execution.viewer().places_of(node);
  if (execution.placement().below_billboard()) return {};
  const auto size_of = [](const glm::dmat4& m) {
    double sum = 0;  // NaN if an element is NaN
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k) sum += std::abs(m[i][k]);
    return sum;
  };
  for (const glm::dmat4& world_from_sensor : places) {
    if (!(size_of(world_from_sensor) * size_of(glm::inverse(world_from_sensor)) < kMaxCondition)) return {};
    const glm::dvec3 middle(world_from_sensor * glm::dvec4(center, 1));
    glm::dvec3 reach(0);
    for (int i = 0; i < 3; ++i) reach += glm::abs(glm::dvec3(world_from_sensor[i])) * half[i];
    if (!std::isfinite(glm::dot(middle, reach))) return {};
    box.add({middle - reach, middle + reach});
  }
  return box;
}

const Behaviour kProximitySensorBehaviour = {
    .events = {"center", "size", "enabled", "isActive", "position_changed", "orientation_changed", "enterTime",
               "exitTime", "centerOfRotation_changed"},
    .initialize = proximity_begins,
    .on_event = proximity_event,
    .on_time = proximity_time,
    .sensed_place = center_of,
    .idle_box = proximity_idle_box,
    .after_idle = proximity_after_idle,
    .on_remove = proximity_ends,
};
const Behaviour kGeoProximitySensorBehaviour = {
    .events = {"center", "size", "enabled", "isActive", "position_changed", "orientation_changed", "enterTime",
               "exitTime", "centerOfRotation_changed", "geoCoord_changed", "geoCenter"},
    .initialize = proximity_begins,
    .on_event = proximity_event,
    .on_time = proximity_time,
    .sensed_place = center_of,
    .idle_box = proximity_idle_box,
    .after_idle = proximity_after_idle,
    .on_remove = proximity_ends,
};

}  // namespace gs::vrml
