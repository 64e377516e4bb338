#include "vrml/behaviours/animation/rotations.h"
#include "vrml/behaviours/sensors/pointing_sensors.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

// Drag sensors (VRML97 4.6.7.4). A drag uses the coordinate system that the sensor had at activation, because the
// sensor may move its own ancestors. If the bearing misses the plane, disk, cylinder or sphere, the sensor keeps its
// last value. Only movements send values; pressing the button does not.
namespace gs::vrml {
namespace {

bool all_finite(const glm::dmat4& m) {
  double sum = 0;
  for (int i = 0; i < 4; ++i) sum += glm::dot(m[i] * 0.0, glm::dvec4(1));
  return sum == 0;
}

void begin_drag(Execution& execution, EventNode node, const Bearing& bearing, const glm::dmat4& world_from_sensor) {
  PointingState& drag = pointing_state(execution, node);
  drag.sensor_from_world = glm::inverse(world_from_sensor);
  if (drag.is_turned) drag.sensor_from_world = glm::mat4_cast(glm::conjugate(drag.turn)) * drag.sensor_from_world;
  drag.start = glm::dvec3(drag.sensor_from_world * glm::dvec4(bearing.point, 1));
  drag.tracks = all_finite(drag.sensor_from_world) && std::isfinite(drag.start.x + drag.start.y + drag.start.z);
  drag.sent = drag.disk = drag.far_side = false;
  drag.radius = drag.turned = 0;
}

// Begins the drag of a sensor that X3D turns by axisRotation (X3D 20.4.2).
void begin_turned_drag(Execution& execution, EventNode node, int axis_rotation, const Bearing& bearing,
                       const glm::dmat4& world_from_sensor) {
  PointingState& drag = pointing_state(execution, node);
  drag.is_turned =
      execution.nodes().has_event(node, axis_rotation) && execution.get<SFRotation>(node, axis_rotation).angle != 0;
  drag.turn = drag.is_turned ? quaternion_of(execution.get<SFRotation>(node, axis_rotation)) : glm::dquat(1, 0, 0, 0);
  begin_drag(execution, node, bearing, world_from_sensor);
}

// Returns a vector of the turned coordinate system in that of the sensor.
glm::dvec3 unturned(const PointingState& drag, const glm::dvec3& vector) {
  return drag.is_turned ? drag.turn * vector : vector;
}

// Bearing in the sensor's coordinate system.
struct DragRay {
  glm::dvec3 origin, direction;

  DragRay(const PointingState& drag, const Bearing& bearing)
      : origin(drag.sensor_from_world * glm::dvec4(bearing.origin, 1)),
        direction(drag.sensor_from_world * glm::dvec4(bearing.direction, 0)) {}
  [[nodiscard]] std::optional<glm::dvec3> at(double distance) const {
    if (!(distance > 0) || !std::isfinite(distance)) return std::nullopt;
    return origin + direction * distance;
  }
};

// Returns the intersection of the ray with a plane: there, the coordinate with index `axis` equals `height`.
std::optional<glm::dvec3> on_plane(const DragRay& ray, int axis, double height) {
  return ray.at((height - ray.origin[axis]) / ray.direction[axis]);
}

// Sphere around the origin. If `across` is (1, 0, 1), cylinder around the Y axis.
struct RoundBody {
  double a, b, c;  // coefficients: a t t + 2 b t + c = 0

  RoundBody(const DragRay& ray, const glm::dvec3& across, double radius)
      : a(glm::dot(ray.direction * across, ray.direction)),
        b(glm::dot(ray.origin * across, ray.direction)),
        c(glm::dot(ray.origin * across, ray.origin) - radius * radius) {}
};

constexpr glm::dvec3 kSphere(1, 1, 1), kCylinder(1, 0, 1);

// Chooses the side that the drag moves. A viewer inside the body, as in a room, drags the far side.
void choose_side(PointingState& drag, const DragRay& ray, const glm::dvec3& across) {
  drag.radius = std::sqrt(glm::dot(drag.start * across, drag.start));
  const RoundBody body(ray, across, drag.radius);
  const double distance =
      glm::dot((drag.start - ray.origin) * across, ray.direction) / glm::dot(ray.direction * across, ray.direction);
  drag.far_side = body.a * distance + body.b > 0;
}

std::optional<glm::dvec3> on_body(const PointingState& drag, const DragRay& ray, const glm::dvec3& across) {
  const RoundBody body(ray, across, drag.radius);
  const double inner = body.b * body.b - body.a * body.c;
  if (!(inner >= 0) || !(body.a > 0) || !(drag.radius > 0)) return std::nullopt;
  return ray.at((-body.b + (drag.far_side ? 1 : -1) * std::sqrt(inner)) / body.a);
}

// ---- PlaneSensor (6.34)

struct Plane {
  enum : int {
    enabled = kSensorEnabled,
    is_active,
    auto_offset,
    max_position,
    min_position,
    offset,
    track_point,
    translation,
    is_over,
    description,
    axis_rotation
  };
};

void drag_plane(Execution& execution, EventNode node, const Bearing& bearing) {
  PointingState& drag = pointing_state(execution, node);
  const auto point = drag.tracks ? on_plane({drag, bearing}, 2, drag.start.z) : std::nullopt;
  if (!point || !send_finite(execution, node, Plane::track_point, SFVec3f(unturned(drag, *point)))) return;
  glm::dvec3 offset(execution.get<SFVec3f>(node, Plane::offset));
  if (drag.is_turned) offset = glm::conjugate(drag.turn) * offset;
  SFVec3f moved(offset + (*point - drag.start));
  const auto &least = execution.get<SFVec2f>(node, Plane::min_position),
             &most = execution.get<SFVec2f>(node, Plane::max_position);
  for (int i = 0; i < 2; ++i)
    if (least[i] <= most[i]) moved[i] = std::clamp(moved[i], least[i], most[i]);
  if (drag.is_turned) moved = SFVec3f(drag.turn * glm::dvec3(moved));
  drag.sent = send_finite(execution, node, Plane::translation, moved) || drag.sent;
}

// Ends a drag of a sensor with values of the type T.
template <class T, class Events, int value>
void end_drag(Execution& execution, EventNode node, bool) {
  if (pointing_state(execution, node).sent && execution.get<SFBool>(node, Events::auto_offset))
    execution.send(node, Events::offset, T(execution.get<T>(node, value)));
}

constexpr PointingSensor kPlaneSensor = {
    .enabled = Plane::enabled,
    .is_over = Plane::is_over,
    .is_active = Plane::is_active,
    .description = Plane::description,
    .press = [](Execution& execution, EventNode node, const Bearing& bearing,
                const glm::dmat4& place) { begin_turned_drag(execution, node, Plane::axis_rotation, bearing, place); },
    .drag = drag_plane,
    .release = end_drag<SFVec3f, Plane, Plane::translation>,
};

// ---- CylinderSensor (6.15)

struct Cylinder {
  enum : int {
    enabled = kSensorEnabled,
    is_active,
    auto_offset,
    disk_angle,
    max_angle,
    min_angle,
    offset,
    rotation,
    track_point,
    is_over,
    description,
    axis_rotation
  };
};

void press_cylinder(Execution& execution, EventNode node, const Bearing& bearing, const glm::dmat4& place) {
  begin_turned_drag(execution, node, Cylinder::axis_rotation, bearing, place);
  PointingState& drag = pointing_state(execution, node);
  const DragRay ray(drag, bearing);
  const double angle =
      std::atan2(std::hypot(ray.direction.x, ray.direction.z), std::abs(ray.direction.y));  // acute angle to the Y axis
  drag.disk = angle < execution.get<SFFloat>(node, Cylinder::disk_angle);
  if (!drag.disk) choose_side(drag, ray, kCylinder);
}

void drag_cylinder(Execution& execution, EventNode node, const Bearing& bearing) {
  PointingState& drag = pointing_state(execution, node);
  if (!drag.tracks) return;
  const DragRay ray(drag, bearing);
  const auto point = drag.disk ? on_plane(ray, 1, drag.start.y) : on_body(drag, ray, kCylinder);
  if (!point || !send_finite(execution, node, Cylinder::track_point, SFVec3f(unturned(drag, *point)))) return;
  // The angle is undefined on the axis. A drag may exceed a full turn, so the angle continues from the last one.
  const double sine = drag.start.z * point->x - drag.start.x * point->z,
               cosine = drag.start.x * point->x + drag.start.z * point->z;
  if (!(sine != 0 || cosine != 0) || !std::isfinite(sine + cosine)) return;
  constexpr double kTurn = 2 * std::numbers::pi;
  const double angle = std::atan2(sine, cosine);
  drag.turned = angle + kTurn * std::round((drag.turned - angle) / kTurn);
  auto turned = static_cast<float>(drag.turned + execution.get<SFFloat>(node, Cylinder::offset));
  const float least = execution.get<SFFloat>(node, Cylinder::min_angle),
              most = execution.get<SFFloat>(node, Cylinder::max_angle);
  if (least <= most) turned = std::clamp(turned, least, most);
  if (!std::isfinite(turned)) return;
  const SFVec3f axis(unturned(drag, {0, 1, 0}));
  execution.send(node, Cylinder::rotation, SFRotation{axis.x, axis.y, axis.z, turned});
  drag.sent = true;
}

constexpr PointingSensor kCylinderSensor = {
    .enabled = Cylinder::enabled,
    .is_over = Cylinder::is_over,
    .is_active = Cylinder::is_active,
    .description = Cylinder::description,
    .press = press_cylinder,
    .drag = drag_cylinder,
    .release =
        [](Execution& execution, EventNode node, bool) {
          if (pointing_state(execution, node).sent && execution.get<SFBool>(node, Cylinder::auto_offset))
            execution.send(node, Cylinder::offset, execution.get<SFRotation>(node, Cylinder::rotation).angle);
        },
};

// ---- SphereSensor (6.44)

struct Sphere {
  enum : int { enabled = kSensorEnabled, is_active, auto_offset, offset, rotation, track_point, is_over, description };
};

// Returns the shortest rotation from the direction `from` to the direction `to`.
glm::dquat rotation_between(const glm::dvec3& from, const glm::dvec3& to) {
  const glm::dvec3 a = glm::normalize(from), b = glm::normalize(to);
  const double cosine = glm::dot(a, b);
  constexpr double kOpposite = -1 + 1e-12;
  if (cosine > kOpposite) return glm::normalize(glm::dquat(1 + cosine, glm::cross(a, b)));
  const glm::dvec3 other = std::abs(a.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  return {0, glm::normalize(glm::cross(a, other))};
}

void press_sphere(Execution& execution, EventNode node, const Bearing& bearing, const glm::dmat4& place) {
  begin_drag(execution, node, bearing, place);
  PointingState& drag = pointing_state(execution, node);
  choose_side(drag, DragRay(drag, bearing), kSphere);
}

void drag_sphere(Execution& execution, EventNode node, const Bearing& bearing) {
  PointingState& drag = pointing_state(execution, node);
  const auto point = drag.tracks ? on_body(drag, DragRay(drag, bearing), kSphere) : std::nullopt;
  if (!point || !send_finite(execution, node, Sphere::track_point, SFVec3f(*point))) return;
  // Applies `offset` first, then the drag, so that `offset` does not turn the axes of the drag.
  const SFRotation& offset = execution.get<SFRotation>(node, Sphere::offset);
  const glm::dquat turned = rotation_between(drag.start, *point) * quaternion_of(offset);
  if (!std::isfinite(turned.w + turned.x + turned.y + turned.z)) return;
  execution.send(node, Sphere::rotation, rotation_of(turned, {0, 1, 0}));
  drag.sent = true;
}

constexpr PointingSensor kSphereSensor = {
    .enabled = Sphere::enabled,
    .is_over = Sphere::is_over,
    .is_active = Sphere::is_active,
    .description = Sphere::description,
    .press = press_sphere,
    .drag = drag_sphere,
    .release = end_drag<SFRotation, Sphere, Sphere::rotation>,
};

}  // namespace

const Behaviour kPlaneSensorBehaviour = {
    .events = {"enabled", "isActive", "autoOffset", "maxPosition", "minPosition", "offset", "trackPoint_changed",
               "translation_changed", "isOver", "description", "axisRotation"},
    .on_event = pointing_sensor_event,
    .on_time = pointing_sensor_time,
    .pointing = &kPlaneSensor,
};
const Behaviour kCylinderSensorBehaviour = {
    .events = {"enabled", "isActive", "autoOffset", "diskAngle", "maxAngle", "minAngle", "offset", "rotation_changed",
               "trackPoint_changed", "isOver", "description", "axisRotation"},
    .on_event = pointing_sensor_event,
    .on_time = pointing_sensor_time,
    .pointing = &kCylinderSensor,
};
const Behaviour kSphereSensorBehaviour = {
    .events = {"enabled", "isActive", "autoOffset", "offset", "rotation_changed", "trackPoint_changed", "isOver",
               "description"},
    .on_event = pointing_sensor_event,
    .on_time = pointing_sensor_time,
    .pointing = &kSphereSensor,
};

}  // namespace gs::vrml
