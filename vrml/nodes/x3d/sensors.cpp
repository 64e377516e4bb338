#include "vrml/event_model/behaviour.h"
#include "vrml/nodes/x3d/components.h"

// Rows of the X3D components EnvironmentalSensor, KeyDeviceSensor, PointingDeviceSensor, Picking (ISO/IEC 19775-1).
namespace gs::vrml {
namespace {

constexpr X3DRow kSensorsX3DRows[] = {
    {"CylinderSensor", "PointingDeviceSensor", 1, "children", "X3DDragSensorNode", Role::child | Role::sensor,
     NodeKind::other, R"(
  exposedField SFBool     autoOffset TRUE
  exposedField SFRotation axisRotation 0 0 1 0
  exposedField SFString   description ""
  exposedField SFFloat    diskAngle 0.26179167  # [0,1.5708]
  exposedField SFBool     enabled TRUE
  exposedField SFFloat    maxAngle -1  # (-6.2832,6.2832)
  exposedField SFFloat    minAngle 0  # (-6.2832,6.2832)
  exposedField SFFloat    offset 0
  eventOut     SFBool     isActive
  eventOut     SFBool     isOver
  eventOut     SFRotation rotation_changed
  eventOut     SFVec3f    trackPoint_changed
)"},
    {"KeySensor", "KeyDeviceSensor", 1, "children", "X3DKeyDeviceSensorNode", Role::child | Role::sensor,
     NodeKind::other, R"(
  exposedField SFString   description ""
  exposedField SFBool     enabled TRUE
  eventOut     SFInt32    actionKeyPress
  eventOut     SFInt32    actionKeyRelease
  eventOut     SFBool     altKey
  eventOut     SFBool     controlKey
  eventOut     SFBool     isActive
  eventOut     SFString   keyPress
  eventOut     SFString   keyRelease
  eventOut     SFBool     shiftKey
)",
     nullptr, &kKeySensorBehaviour},
    {"LinePickSensor", "Picking", 1, "children", "X3DPickSensorNode", Role::child | Role::sensor, NodeKind::other, R"(
  exposedField SFString   description ""
  exposedField SFBool     enabled TRUE
  exposedField SFString   matchCriterion "MATCH_ANY"
  exposedField MFString   objectType ["ALL"]
  exposedField SFNode     pickingGeometry NULL  # X3DGeometryNode
  exposedField MFNode     pickTarget []  # X3DGroupingNode,X3DShapeNode,Inline
  field        SFString   intersectionType "BOUNDS"
  field        SFString   sortOrder "CLOSEST"
  eventOut     SFBool     isActive
  eventOut     MFNode     pickedGeometry  # X3DChildNode
  eventOut     MFVec3f    pickedNormal
  eventOut     MFVec3f    pickedPoint
  eventOut     MFVec3f    pickedTextureCoordinate
)",
     nullptr, &kLinePickSensorBehaviour},
    {"PickableGroup", "Picking", 1, "children", "X3DGroupingNode X3DPickableObject", Role::child | Role::grouping,
     NodeKind::group, R"(
  eventIn      MFNode     addChildren  # X3DChildNode
  eventIn      MFNode     removeChildren  # X3DChildNode
  exposedField SFBool     bboxDisplay FALSE
  exposedField MFNode     children []  # X3DChildNode
  exposedField SFString   description ""
  exposedField MFString   objectType ["ALL"]
  exposedField SFBool     pickable TRUE
  exposedField SFBool     visible TRUE
  field        SFVec3f    bboxCenter 0 0 0
  field        SFVec3f    bboxSize -1 -1 -1
)",
     nullptr, &kGroupBehaviour},
    {"PlaneSensor", "PointingDeviceSensor", 1, "children", "X3DDragSensorNode", Role::child | Role::sensor,
     NodeKind::other, R"(
  exposedField SFBool     autoOffset TRUE
  exposedField SFRotation axisRotation 0 0 1 0
  exposedField SFString   description ""
  exposedField SFBool     enabled TRUE
  exposedField SFVec2f    maxPosition -1 -1
  exposedField SFVec2f    minPosition 0 0
  exposedField SFVec3f    offset 0 0 0
  eventOut     SFBool     isActive
  eventOut     SFBool     isOver
  eventOut     SFVec3f    trackPoint_changed
  eventOut     SFVec3f    translation_changed
)"},
    {"PointPickSensor", "Picking", 1, "children", "X3DPickSensorNode", Role::child | Role::sensor, NodeKind::other, R"(
  exposedField SFString   description ""
  exposedField SFBool     enabled TRUE
  exposedField SFString   matchCriterion "MATCH_ANY"
  exposedField MFString   objectType ["ALL"]
  exposedField SFNode     pickingGeometry NULL  # X3DGeometryNode
  exposedField MFNode     pickTarget []  # X3DGroupingNode,X3DShapeNode,Inline
  field        SFString   intersectionType "BOUNDS"
  field        SFString   sortOrder "CLOSEST"
  eventOut     SFBool     isActive
  eventOut     MFNode     pickedGeometry  # X3DChildNode
  eventOut     MFVec3f    pickedPoint
)",
     nullptr, &kPointPickSensorBehaviour},
    {"PrimitivePickSensor", "Picking", 2, "children", "X3DPickSensorNode", Role::child | Role::sensor, NodeKind::other,
     R"(
  exposedField SFString   description ""
  exposedField SFBool     enabled TRUE
  exposedField SFString   matchCriterion "MATCH_ANY"
  exposedField MFString   objectType ["ALL"]
  exposedField SFNode     pickingGeometry NULL  # X3DGeometryNode
  exposedField MFNode     pickTarget []  # X3DGroupingNode,X3DShapeNode,Inline
  field        SFString   intersectionType "BOUNDS"
  field        SFString   sortOrder "CLOSEST"
  eventOut     SFBool     isActive
  eventOut     MFNode     pickedGeometry  # X3DChildNode
)",
     nullptr, &kPrimitivePickSensorBehaviour},
    {"ProximitySensor", "EnvironmentalSensor", 1, "children", "X3DEnvironmentalSensorNode", Role::child | Role::sensor,
     NodeKind::other, R"(
  exposedField SFVec3f    center 0 0 0
  exposedField SFString   description ""
  exposedField SFBool     enabled TRUE
  exposedField SFVec3f    size 0 0 0  # [0,inf)
  eventOut     SFVec3f    centerOfRotation_changed
  eventOut     SFTime     enterTime
  eventOut     SFTime     exitTime
  eventOut     SFBool     isActive
  eventOut     SFRotation orientation_changed
  eventOut     SFVec3f    position_changed
)"},
    {"SphereSensor", "PointingDeviceSensor", 1, "children", "X3DDragSensorNode", Role::child | Role::sensor,
     NodeKind::other, R"(
  exposedField SFBool     autoOffset TRUE
  exposedField SFString   description ""
  exposedField SFBool     enabled TRUE
  exposedField SFRotation offset 0 1 0 0
  eventOut     SFBool     isActive
  eventOut     SFBool     isOver
  eventOut     SFRotation rotation_changed
  eventOut     SFVec3f    trackPoint_changed
)"},
    {"StringSensor", "KeyDeviceSensor", 2, "children", "X3DKeyDeviceSensorNode", Role::child | Role::sensor,
     NodeKind::other, R"(
  exposedField SFBool     deletionAllowed TRUE
  exposedField SFString   description ""
  exposedField SFBool     enabled TRUE
  eventOut     SFString   enteredText
  eventOut     SFString   finalText
  eventOut     SFBool     isActive
)",
     nullptr, &kStringSensorBehaviour},
    {"TouchSensor", "PointingDeviceSensor", 1, "children", "X3DTouchSensorNode", Role::child | Role::sensor,
     NodeKind::other, R"(
  exposedField SFString   description ""
  exposedField SFBool     enabled TRUE
  eventOut     SFVec3f    hitNormal_changed
  eventOut     SFVec3f    hitPoint_changed
  eventOut     SFVec2f    hitTexCoord_changed
  eventOut     SFBool     isActive
  eventOut     SFBool     isOver
  eventOut     SFTime     touchTime
)"},
    {"TransformSensor", "EnvironmentalSensor", 3, "children", "X3DEnvironmentalSensorNode", Role::child | Role::sensor,
     NodeKind::other, R"(
  exposedField SFVec3f    center 0 0 0
  exposedField SFString   description ""
  exposedField SFBool     enabled TRUE
  exposedField SFVec3f    size 0 0 0  # [0,inf)
  exposedField SFNode     targetObject NULL  # X3DGroupingNode,X3DShapeNode
  eventOut     SFTime     enterTime
  eventOut     SFTime     exitTime
  eventOut     SFBool     isActive
  eventOut     SFRotation orientation_changed
  eventOut     SFVec3f    position_changed
)",
     nullptr, &kTransformSensorBehaviour},
    {"VisibilitySensor", "EnvironmentalSensor", 2, "children", "X3DEnvironmentalSensorNode", Role::child | Role::sensor,
     NodeKind::other, R"(
  exposedField SFVec3f    center 0 0 0
  exposedField SFString   description ""
  exposedField SFBool     enabled TRUE
  exposedField SFVec3f    size 0 0 0  # [0,inf)
  eventOut     SFTime     enterTime
  eventOut     SFTime     exitTime
  eventOut     SFBool     isActive
)"},
    {"VolumePickSensor", "Picking", 3, "children", "X3DPickSensorNode", Role::child | Role::sensor, NodeKind::other, R"(
  exposedField SFString   description ""
  exposedField SFBool     enabled TRUE
  exposedField SFString   matchCriterion "MATCH_ANY"
  exposedField MFString   objectType ["ALL"]
  exposedField SFNode     pickingGeometry NULL  # X3DGeometryNode
  exposedField MFNode     pickTarget []  # X3DGroupingNode,X3DShapeNode,Inline
  field        SFString   intersectionType "BOUNDS"
  field        SFString   sortOrder "CLOSEST"
  eventOut     SFBool     isActive
  eventOut     MFNode     pickedGeometry  # X3DChildNode
)",
     nullptr, &kVolumePickSensorBehaviour},
};

}  // namespace

std::span<const X3DRow> x3d_sensors_rows() { return kSensorsX3DRows; }

}  // namespace gs::vrml
