#include "base/finite.h"
#include "vrml/behaviours/sensors/pointing_sensors.h"
#include "vrml/scene/coordinates/geospatial.h"

#include <glm/glm.hpp>

namespace gs::vrml {
namespace {

struct Touch {
  enum : int {
    enabled = kSensorEnabled,
    is_over,
    is_active,
    touch_time,
    hit_point,
    hit_normal,
    hit_tex_coord,
    description,
    hit_geo_coord  // of GeoTouchSensor
  };
};

// Sends the hit point in the coordinate system of the sensor (6.51). If that system is singular, does not send
// undefined values. A GeoTouchSensor also sends its geospatial coordinates (X3D 25.3.10).
void touch_hover(Execution& execution, EventNode node, const Bearing& bearing, const glm::dmat4& world_from_sensor) {
  const glm::dvec3 point(glm::inverse(world_from_sensor) * glm::dvec4(bearing.point, 1));
  send_finite(execution, node, Touch::hit_point, SFVec3f(point));
  // Normals transform by the inverse transpose of the matrix for points.
  const glm::dvec3 normal = glm::transpose(glm::dmat3(world_from_sensor)) * bearing.normal;
  const SFVec3f direction(normal / glm::length(normal));
  send_finite(execution, node, Touch::hit_normal, direction);
  send_finite(execution, node, Touch::hit_tex_coord, SFVec2f(bearing.texture_coordinate));
  if (!execution.nodes().has_event(node, Touch::hit_geo_coord)) return;
  const EventMember& at = execution.nodes()[node];
  const glm::dvec3 coordinates = GeoFrame::of(*at.scene, *at.node).coordinates(point);
  if (finite(coordinates)) execution.send(node, Touch::hit_geo_coord, SFVec3d(coordinates));
}

constexpr PointingSensor kTouchSensor = {
    .enabled = Touch::enabled,
    .is_over = Touch::is_over,
    .is_active = Touch::is_active,
    .description = Touch::description,
    .hover = touch_hover,
    .release =
        [](Execution& execution, EventNode node, bool over) {
          if (over) execution.send(node, Touch::touch_time, SFTime{execution.now()});
        },
};

}  // namespace

bool pointing_sensor_event(Execution& execution, EventNode node, int event, const FieldValue& value) {
  if (event == kSensorEnabled) execution.pointing().enable(node, std::get<SFBool>(value));
  return true;
}

void pointing_sensor_time(Execution& execution, EventNode node) { execution.pointing().settle(node); }

const Behaviour kTouchSensorBehaviour = {
    .events = {"enabled", "isOver", "isActive", "touchTime", "hitPoint_changed", "hitNormal_changed",
               "hitTexCoord_changed", "description"},
    .on_event = pointing_sensor_event,
    .on_time = pointing_sensor_time,
    .pointing = &kTouchSensor,
};

const Behaviour kGeoTouchSensorBehaviour = {
    .events = {"enabled", "isOver", "isActive", "touchTime", "hitPoint_changed", "hitNormal_changed",
               "hitTexCoord_changed", "description", "hitGeoCoord_changed"},
    .on_event = pointing_sensor_event,
    .on_time = pointing_sensor_time,
    .pointing = &kTouchSensor,
};

}  // namespace gs::vrml
