#include "vrml/nodes/x3d/components.h"

// Rows of the X3D component RigidBodyPhysics (ISO/IEC 19775-1).
namespace gs::vrml {
namespace {

constexpr X3DRow kRigidBodyX3DRows[] = {
    {"BallJoint",
     "RigidBodyPhysics",
     2,
     "joints",
     "X3DRigidJointNode",
     Role::none,
     NodeKind::other,
     R"(
  exposedField SFVec3f    anchorPoint 0 0 0
  exposedField SFNode     body1 NULL  # RigidBody
  exposedField SFNode     body2 NULL  # RigidBody
  exposedField MFString   forceOutput ["NONE"]
  eventOut     SFVec3f    body1AnchorPoint
  eventOut     SFVec3f    body2AnchorPoint
)",
     {},
     nullptr,
     UrlContent::none,
     true},
    {"CollidableOffset",
     "RigidBodyPhysics",
     1,
     "children",
     "X3DNBodyCollidableNode",
     Role::child,
     NodeKind::other,
     R"(
  exposedField SFBool     bboxDisplay FALSE
  exposedField SFBool     enabled TRUE
  exposedField SFRotation rotation 0 0 1 0
  exposedField SFVec3f    translation 0 0 0
  exposedField SFBool     visible TRUE
  field        SFVec3f    bboxCenter 0 0 0
  field        SFVec3f    bboxSize -1 -1 -1
  field        SFNode     collidable NULL  # X3DNBodyCollidableNode
)",
     {},
     nullptr,
     UrlContent::none,
     true},
    {"CollidableShape",
     "RigidBodyPhysics",
     1,
     "children",
     "X3DNBodyCollidableNode",
     Role::child,
     NodeKind::other,
     R"(
  exposedField SFBool     bboxDisplay FALSE
  exposedField SFBool     enabled TRUE
  exposedField SFRotation rotation 0 0 1 0
  exposedField SFVec3f    translation 0 0 0
  exposedField SFBool     visible TRUE
  field        SFVec3f    bboxCenter 0 0 0
  field        SFVec3f    bboxSize -1 -1 -1
  field        SFNode     shape NULL  # Shape
)",
     {},
     nullptr,
     UrlContent::none,
     true},
    {"CollisionCollection",
     "RigidBodyPhysics",
     1,
     "collider",
     "X3DChildNode X3DBoundedObject",
     Role::child,
     NodeKind::other,
     R"(
  exposedField MFString   appliedParameters ["BOUNCE"]
  exposedField SFBool     bboxDisplay FALSE
  exposedField SFFloat    bounce 0  # [0,1]
  exposedField MFNode     collidables []  # X3DNBodyCollisionSpaceNode,X3DNBodyCollidableNode
  exposedField SFString   description ""
  exposedField SFBool     enabled TRUE
  exposedField SFVec2f    frictionCoefficients 0 0  # [0,inf)
  exposedField SFFloat    minBounceSpeed 0.1  # [0,inf)
  exposedField SFVec2f    slipFactors 0 0
  exposedField SFFloat    softnessConstantForceMix 0.0001  # [0,1]
  exposedField SFFloat    softnessErrorCorrection 0.8  # [0,1]
  exposedField SFVec2f    surfaceSpeed 0 0
  exposedField SFBool     visible TRUE
  field        SFVec3f    bboxCenter 0 0 0
  field        SFVec3f    bboxSize -1 -1 -1
)",
     {},
     nullptr,
     UrlContent::none,
     true},
    {"CollisionSensor",
     "RigidBodyPhysics",
     1,
     "children",
     "X3DSensorNode",
     Role::child | Role::sensor,
     NodeKind::other,
     R"(
  exposedField SFNode     collider NULL  # CollisionCollection
  exposedField SFString   description ""
  exposedField SFBool     enabled TRUE
  eventOut     MFNode     contacts  # Contact
  eventOut     MFNode     intersections  # X3DNBodyCollidableNode
  eventOut     SFBool     isActive
)",
     {},
     nullptr,
     UrlContent::none,
     true},
    {"CollisionSpace",
     "RigidBodyPhysics",
     1,
     "children",
     "X3DNBodyCollisionSpaceNode",
     Role::none,
     NodeKind::other,
     R"(
  exposedField SFBool     bboxDisplay FALSE
  exposedField MFNode     collidables []  # X3DNBodyCollisionSpaceNode,X3DNBodyCollidableNode
  exposedField SFBool     enabled TRUE
  exposedField SFBool     useGeometry FALSE
  exposedField SFBool     visible TRUE
  field        SFVec3f    bboxCenter 0 0 0
  field        SFVec3f    bboxSize -1 -1 -1
)",
     {},
     nullptr,
     UrlContent::none,
     true},
    {"Contact",
     "RigidBodyPhysics",
     2,
     "contacts",
     "X3DNode",
     Role::none,
     NodeKind::other,
     R"(
  exposedField MFString   appliedParameters ["BOUNCE"]
  exposedField SFNode     body1 NULL  # RigidBody
  exposedField SFNode     body2 NULL  # RigidBody
  exposedField SFFloat    bounce 0  # [0,1]
  exposedField SFVec3f    contactNormal 0 1 0
  exposedField SFFloat    depth 0
  exposedField SFVec2f    frictionCoefficients 0 0  # [0,inf)
  exposedField SFVec3f    frictionDirection 0 1 0
  exposedField SFNode     geometry1 NULL  # X3DNBodyCollidableNode
  exposedField SFNode     geometry2 NULL  # X3DNBodyCollidableNode
  exposedField SFFloat    minBounceSpeed 0  # [0,inf)
  exposedField SFVec3f    position 0 0 0
  exposedField SFVec2f    slipCoefficients 0 0
  exposedField SFFloat    softnessConstantForceMix 0.0001  # [0,1]
  exposedField SFFloat    softnessErrorCorrection 0.8  # [0,1]
  exposedField SFVec2f    surfaceSpeed 0 0
)",
     {},
     nullptr,
     UrlContent::none,
     true},
    {"DoubleAxisHingeJoint",
     "RigidBodyPhysics",
     2,
     "joints",
     "X3DRigidJointNode",
     Role::none,
     NodeKind::other,
     R"(
  exposedField SFVec3f    anchorPoint 0 0 0
  exposedField SFVec3f    axis1 1 0 0
  exposedField SFVec3f    axis2 0 1 0
  exposedField SFNode     body1 NULL  # RigidBody
  exposedField SFNode     body2 NULL  # RigidBody
  exposedField SFFloat    desiredAngularVelocity1 0
  exposedField SFFloat    desiredAngularVelocity2 0
  exposedField MFString   forceOutput ["NONE"]
  exposedField SFFloat    maxAngle1 3.141592653
  exposedField SFFloat    maxTorque1 0
  exposedField SFFloat    maxTorque2 0
  exposedField SFFloat    minAngle1 -3.141592653
  exposedField SFFloat    stop1Bounce 0
  exposedField SFFloat    stop1ConstantForceMix 0.001
  exposedField SFFloat    stop1ErrorCorrection 0.8
  exposedField SFFloat    suspensionErrorCorrection 0.8
  exposedField SFFloat    suspensionForce 0
  eventOut     SFVec3f    body1AnchorPoint
  eventOut     SFVec3f    body1Axis
  eventOut     SFVec3f    body2AnchorPoint
  eventOut     SFVec3f    body2Axis
  eventOut     SFFloat    hinge1Angle
  eventOut     SFFloat    hinge1AngleRate
  eventOut     SFFloat    hinge2Angle
  eventOut     SFFloat    hinge2AngleRate
)",
     {},
     nullptr,
     UrlContent::none,
     true},
    {"MotorJoint",
     "RigidBodyPhysics",
     2,
     "joints",
     "X3DRigidJointNode",
     Role::none,
     NodeKind::other,
     R"(
  exposedField SFFloat    axis1Angle 0
  exposedField SFFloat    axis1Torque 0
  exposedField SFFloat    axis2Angle 0
  exposedField SFFloat    axis2Torque 0
  exposedField SFFloat    axis3Angle 0
  exposedField SFFloat    axis3Torque 0
  exposedField SFNode     body1 NULL  # RigidBody
  exposedField SFNode     body2 NULL  # RigidBody
  exposedField SFInt32    enabledAxes 1  # [0,3]
  exposedField MFString   forceOutput ["NONE"]
  exposedField SFVec3f    motor1Axis 1 0 0
  exposedField SFVec3f    motor2Axis 0 1 0
  exposedField SFVec3f    motor3Axis 0 0 1
  exposedField SFFloat    stop1Bounce 0
  exposedField SFFloat    stop1ErrorCorrection 0.8
  exposedField SFFloat    stop2Bounce 0
  exposedField SFFloat    stop2ErrorCorrection 0.8
  exposedField SFFloat    stop3Bounce 0
  exposedField SFFloat    stop3ErrorCorrection 0.8
  field        SFBool     autoCalc FALSE
  eventOut     SFFloat    motor1Angle
  eventOut     SFFloat    motor1AngleRate
  eventOut     SFFloat    motor2Angle
  eventOut     SFFloat    motor2AngleRate
  eventOut     SFFloat    motor3Angle
  eventOut     SFFloat    motor3AngleRate
)",
     {},
     nullptr,
     UrlContent::none,
     true},
    {"RigidBody",
     "RigidBodyPhysics",
     2,
     "bodies",
     "X3DChildNode X3DBoundedObject",
     Role::child,
     NodeKind::other,
     R"(
  exposedField SFFloat    angularDampingFactor 0.001
  exposedField SFVec3f    angularVelocity 0 0 0
  exposedField SFBool     autoDamp FALSE
  exposedField SFBool     autoDisable FALSE
  exposedField SFBool     bboxDisplay FALSE
  exposedField SFVec3f    centerOfMass 0 0 0
  exposedField SFFloat    disableAngularSpeed 0
  exposedField SFFloat    disableLinearSpeed 0
  exposedField SFTime     disableTime 0  # [0,inf)
  exposedField SFBool     enabled TRUE
  exposedField SFVec3f    finiteRotationAxis 0 1 0
  exposedField SFBool     fixed FALSE
  exposedField MFVec3f    forces []
  exposedField MFNode     geometry []  # X3DNBodyCollidableNode
  exposedField SFMatrix3f inertia 1 0 0 0 1 0 0 0 1
  exposedField SFFloat    linearDampingFactor 0.001
  exposedField SFVec3f    linearVelocity 0 0 0
  exposedField SFFloat    mass 1
  exposedField SFNode     massDensityModel NULL  # Sphere,Box,Cone
  exposedField SFRotation orientation 0 0 1 0
  exposedField SFVec3f    position 0 0 0
  exposedField MFVec3f    torques []
  exposedField SFBool     useFiniteRotation FALSE
  exposedField SFBool     useGlobalGravity TRUE
  exposedField SFBool     visible TRUE
  field        SFVec3f    bboxCenter 0 0 0
  field        SFVec3f    bboxSize -1 -1 -1
)",
     {},
     nullptr,
     UrlContent::none,
     true},
    {"RigidBodyCollection",
     "RigidBodyPhysics",
     2,
     "children",
     "X3DChildNode X3DBoundedObject",
     Role::child,
     NodeKind::other,
     R"(
  eventIn      MFNode     set_contacts  # Contact
  exposedField SFBool     autoDisable FALSE
  exposedField SFBool     bboxDisplay FALSE
  exposedField MFNode     bodies []  # RigidBody
  exposedField SFFloat    constantForceMix 0.0001
  exposedField SFFloat    contactSurfaceThickness 0
  exposedField SFFloat    disableAngularSpeed 0
  exposedField SFFloat    disableLinearSpeed 0
  exposedField SFTime     disableTime 0  # [0,inf)
  exposedField SFBool     enabled TRUE
  exposedField SFFloat    errorCorrection 0.8
  exposedField SFVec3f    gravity 0 -9.8 0
  exposedField SFInt32    iterations 10
  exposedField MFNode     joints []  # X3DRigidJointNode
  exposedField SFFloat    maxCorrectionSpeed -1
  exposedField SFBool     preferAccuracy FALSE
  exposedField SFBool     visible TRUE
  field        SFVec3f    bboxCenter 0 0 0
  field        SFVec3f    bboxSize -1 -1 -1
  field        SFNode     collider NULL  # CollisionCollection
)",
     {},
     nullptr,
     UrlContent::none,
     true},
    {"SingleAxisHingeJoint",
     "RigidBodyPhysics",
     2,
     "joints",
     "X3DRigidJointNode",
     Role::none,
     NodeKind::other,
     R"(
  exposedField SFVec3f    anchorPoint 0 0 0
  exposedField SFVec3f    axis 0 1 0
  exposedField SFNode     body1 NULL  # RigidBody
  exposedField SFNode     body2 NULL  # RigidBody
  exposedField MFString   forceOutput ["NONE"]
  exposedField SFFloat    maxAngle 3.141592653
  exposedField SFFloat    minAngle -3.141592653
  exposedField SFFloat    stopBounce 0
  exposedField SFFloat    stopErrorCorrection 0.8
  eventOut     SFFloat    angle
  eventOut     SFFloat    angleRate
  eventOut     SFVec3f    body1AnchorPoint
  eventOut     SFVec3f    body2AnchorPoint
)",
     {},
     nullptr,
     UrlContent::none,
     true},
    {"SliderJoint",
     "RigidBodyPhysics",
     2,
     "joints",
     "X3DRigidJointNode",
     Role::none,
     NodeKind::other,
     R"(
  exposedField SFVec3f    axis 0 1 0
  exposedField SFNode     body1 NULL  # RigidBody
  exposedField SFNode     body2 NULL  # RigidBody
  exposedField MFString   forceOutput ["NONE"]
  exposedField SFFloat    maxSeparation 1
  exposedField SFFloat    minSeparation 0
  exposedField SFFloat    sliderForce 0
  exposedField SFFloat    stopBounce 0
  exposedField SFFloat    stopErrorCorrection 1
  eventOut     SFFloat    separation
  eventOut     SFFloat    separationRate
)",
     {},
     nullptr,
     UrlContent::none,
     true},
    {"UniversalJoint",
     "RigidBodyPhysics",
     2,
     "joints",
     "X3DRigidJointNode",
     Role::none,
     NodeKind::other,
     R"(
  exposedField SFVec3f    anchorPoint 0 0 0
  exposedField SFVec3f    axis1 1 0 0
  exposedField SFVec3f    axis2 0 1 0
  exposedField SFNode     body1 NULL  # RigidBody
  exposedField SFNode     body2 NULL  # RigidBody
  exposedField MFString   forceOutput ["NONE"]
  exposedField SFFloat    stop1Bounce 0  # [0,1]
  exposedField SFFloat    stop1ErrorCorrection 0.8  # [0,1]
  exposedField SFFloat    stop2Bounce 0  # [0,1]
  exposedField SFFloat    stop2ErrorCorrection 0.8  # [0,1]
  eventOut     SFVec3f    body1AnchorPoint
  eventOut     SFVec3f    body1Axis
  eventOut     SFVec3f    body2AnchorPoint
  eventOut     SFVec3f    body2Axis
)",
     {},
     nullptr,
     UrlContent::none,
     true},
};

}  // namespace

std::span<const X3DRow> x3d_rigid_body_rows() { return kRigidBodyX3DRows; }

}  // namespace gs::vrml
