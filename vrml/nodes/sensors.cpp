#include "vrml/event_model/behaviour.h"
#include "vrml/nodes/families.h"

namespace gs::vrml {
namespace {

// Rows of the sensors (VRML97 4.6.7).
constexpr NodeRow kSensorsRows[] = {
    {"CylinderSensor", "6.15", Role::child | Role::sensor, NodeKind::other, R"(
  exposedField SFBool     autoOffset       TRUE
  exposedField SFFloat    diskAngle        0.262            # (0,pi/2)
  exposedField SFBool     enabled          TRUE
  exposedField SFFloat    maxAngle         -1               # [-2pi,2pi]
  exposedField SFFloat    minAngle         0                # [-2pi,2pi]
  exposedField SFFloat    offset           0                # (-inf,inf)
  eventOut     SFBool     isActive
  eventOut     SFRotation rotation_changed
  eventOut     SFVec3f    trackPoint_changed
)",
     nullptr, &kCylinderSensorBehaviour},
    {"PlaneSensor", "6.34", Role::child | Role::sensor, NodeKind::other, R"(
  exposedField SFBool     autoOffset       TRUE
  exposedField SFBool     enabled          TRUE
  exposedField SFVec2f    maxPosition      -1 -1            # (-inf,inf)
  exposedField SFVec2f    minPosition      0 0              # (-inf,inf)
  exposedField SFVec3f    offset           0 0 0            # (-inf,inf)
  eventOut     SFBool     isActive
  eventOut     SFVec3f    trackPoint_changed
  eventOut     SFVec3f    translation_changed
)",
     nullptr, &kPlaneSensorBehaviour},
    {"ProximitySensor", "6.38", Role::child | Role::sensor, NodeKind::other, R"(
  exposedField SFVec3f    center           0 0 0            # (-inf,inf)
  exposedField SFVec3f    size             0 0 0            # [0,inf)
  exposedField SFBool     enabled          TRUE
  eventOut     SFBool     isActive
  eventOut     SFVec3f    position_changed
  eventOut     SFRotation orientation_changed
  eventOut     SFTime     enterTime
  eventOut     SFTime     exitTime
)",
     nullptr, &kProximitySensorBehaviour},
    {"SphereSensor", "6.44", Role::child | Role::sensor, NodeKind::other, R"(
  exposedField SFBool     autoOffset       TRUE
  exposedField SFBool     enabled          TRUE
  exposedField SFRotation offset           0 1 0 0          # [-1,1],(-inf,inf)
  eventOut     SFBool     isActive
  eventOut     SFRotation rotation_changed
  eventOut     SFVec3f    trackPoint_changed
)",
     nullptr, &kSphereSensorBehaviour},
    {"TimeSensor", "6.50", Role::child | Role::sensor | Role::time_dependent, NodeKind::other, R"(
  exposedField SFTime     cycleInterval    1                # (0,inf)
  exposedField SFBool     enabled          TRUE
  exposedField SFBool     loop             FALSE
  exposedField SFTime     startTime        0                # (-inf,inf)
  exposedField SFTime     stopTime         0                # (-inf,inf)
  eventOut     SFTime     cycleTime
  eventOut     SFFloat    fraction_changed                  # [0,1]
  eventOut     SFBool     isActive
  eventOut     SFTime     time
)",
     nullptr, &kTimeSensorBehaviour},
    {"TouchSensor", "6.51", Role::child | Role::sensor, NodeKind::other, R"(
  exposedField SFBool     enabled          TRUE
  eventOut     SFVec3f    hitNormal_changed
  eventOut     SFVec3f    hitPoint_changed
  eventOut     SFVec2f    hitTexCoord_changed
  eventOut     SFBool     isActive
  eventOut     SFBool     isOver
  eventOut     SFTime     touchTime
)",
     nullptr, &kTouchSensorBehaviour},
    {"VisibilitySensor", "6.54", Role::child | Role::sensor, NodeKind::other, R"(
  exposedField SFVec3f    center           0 0 0            # (-inf,inf)
  exposedField SFBool     enabled          TRUE
  exposedField SFVec3f    size             0 0 0            # [0,inf)
  eventOut     SFTime     enterTime
  eventOut     SFTime     exitTime
  eventOut     SFBool     isActive
)",
     nullptr, &kVisibilitySensorBehaviour},
};

}  // namespace

std::span<const NodeRow> sensors_rows() { return kSensorsRows; }

}  // namespace gs::vrml
