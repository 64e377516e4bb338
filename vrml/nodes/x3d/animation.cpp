#include "vrml/event_model/behaviour.h"
#include "vrml/nodes/x3d/components.h"

// Rows of the X3D components EventUtilities, Followers, Interpolation (ISO/IEC 19775-1).
namespace gs::vrml {
namespace {

constexpr X3DRow kAnimationX3DRows[] = {
    {"BooleanFilter", "EventUtilities", 1, "children", "X3DChildNode", Role::child, NodeKind::other, R"(
  eventIn      SFBool     set_boolean
  eventOut     SFBool     inputFalse
  eventOut     SFBool     inputNegate
  eventOut     SFBool     inputTrue
)",
     nullptr, &kBooleanFilterBehaviour},
    {"BooleanSequencer", "EventUtilities", 1, "children", "X3DSequencerNode", Role::child, NodeKind::other, R"(
  eventIn      SFBool     next
  eventIn      SFBool     previous
  eventIn      SFFloat    set_fraction
  exposedField MFFloat    key []
  exposedField MFBool     keyValue []
  eventOut     SFBool     value_changed
)",
     nullptr, &kBooleanSequencerBehaviour},
    {"BooleanToggle", "EventUtilities", 1, "children", "X3DChildNode", Role::child, NodeKind::other, R"(
  eventIn      SFBool     set_boolean
  exposedField SFBool     toggle FALSE
)",
     nullptr, &kBooleanToggleBehaviour},
    {"BooleanTrigger", "EventUtilities", 1, "children", "X3DTriggerNode", Role::child, NodeKind::other, R"(
  eventIn      SFTime     set_triggerTime
  eventOut     SFBool     triggerTrue
)",
     nullptr, &kBooleanTriggerBehaviour},
    {"ColorChaser", "Followers", 1, "children", "X3DChaserNode", Role::child, NodeKind::other, R"(
  eventIn      SFColor    set_destination  # [0,1]
  eventIn      SFColor    set_value  # [0,1]
  field        SFTime     duration 1  # [0,inf)
  field        SFColor    initialDestination 0.8 0.8 0.8  # [0,1]
  field        SFColor    initialValue 0.8 0.8 0.8  # [0,1]
  eventOut     SFBool     isActive
  eventOut     SFColor    value_changed  # [0,1]
)",
     nullptr, &kColorChaserBehaviour},
    {"ColorDamper", "Followers", 1, "children", "X3DDamperNode", Role::child, NodeKind::other, R"(
  eventIn      SFColor    set_destination  # [0,1]
  eventIn      SFColor    set_value  # [0,1]
  exposedField SFTime     tau 0.3  # [0,inf)
  exposedField SFFloat    tolerance -1
  field        SFColor    initialDestination 0.8 0.8 0.8  # [0,1]
  field        SFColor    initialValue 0.8 0.8 0.8  # [0,1]
  field        SFInt32    order 3  # [0,5]
  eventOut     SFBool     isActive
  eventOut     SFColor    value_changed  # [0,1]
)",
     nullptr, &kColorDamperBehaviour},
    {"ColorInterpolator", "Interpolation", 2, "children", "X3DInterpolatorNode", Role::child | Role::interpolator,
     NodeKind::other, R"(
  eventIn      SFFloat    set_fraction
  exposedField MFFloat    key []
  exposedField MFColor    keyValue []  # [0,1]
  eventOut     SFColor    value_changed  # [0,1]
)"},
    {"CoordinateChaser", "Followers", 1, "children", "X3DChaserNode", Role::child, NodeKind::other, R"(
  eventIn      MFVec3f    set_destination
  eventIn      MFVec3f    set_value
  field        SFTime     duration 1  # [0,inf)
  field        MFVec3f    initialDestination [0 0 0]
  field        MFVec3f    initialValue [0 0 0]
  eventOut     SFBool     isActive
  eventOut     MFVec3f    value_changed
)",
     nullptr, &kCoordinateChaserBehaviour},
    {"CoordinateDamper", "Followers", 1, "children", "X3DDamperNode", Role::child, NodeKind::other, R"(
  eventIn      MFVec3f    set_destination
  eventIn      MFVec3f    set_value
  exposedField SFTime     tau 0.3  # [0,inf)
  exposedField SFFloat    tolerance -1
  field        MFVec3f    initialDestination [0 0 0]
  field        MFVec3f    initialValue [0 0 0]
  field        SFInt32    order 3  # [0,5]
  eventOut     SFBool     isActive
  eventOut     MFVec3f    value_changed
)",
     nullptr, &kCoordinateDamperBehaviour},
    {"CoordinateInterpolator", "Interpolation", 1, "children", "X3DInterpolatorNode", Role::child | Role::interpolator,
     NodeKind::other, R"(
  eventIn      SFFloat    set_fraction
  exposedField MFFloat    key []
  exposedField MFVec3f    keyValue []
  eventOut     MFVec3f    value_changed
)"},
    {"CoordinateInterpolator2D", "Interpolation", 3, "children", "X3DInterpolatorNode",
     Role::child | Role::interpolator, NodeKind::other, R"(
  eventIn      SFFloat    set_fraction
  exposedField MFFloat    key []
  exposedField MFVec2f    keyValue []
  eventOut     MFVec2f    value_changed
)",
     nullptr, &kCoordinateInterpolator2DBehaviour},
    {"EaseInEaseOut", "Interpolation", 4, "children", "X3DChildNode", Role::child, NodeKind::other, R"(
  eventIn      SFFloat    set_fraction
  exposedField MFVec2f    easeInEaseOut []
  exposedField MFFloat    key []
  eventOut     SFFloat    modifiedFraction_changed
)",
     nullptr, &kEaseInEaseOutBehaviour},
    {"IntegerSequencer", "EventUtilities", 1, "children", "X3DSequencerNode", Role::child, NodeKind::other, R"(
  eventIn      SFBool     next
  eventIn      SFBool     previous
  eventIn      SFFloat    set_fraction
  exposedField MFFloat    key []
  exposedField MFInt32    keyValue []
  eventOut     SFInt32    value_changed
)",
     nullptr, &kIntegerSequencerBehaviour},
    {"IntegerTrigger", "EventUtilities", 1, "children", "X3DTriggerNode", Role::child, NodeKind::other, R"(
  eventIn      SFBool     set_boolean
  exposedField SFInt32    integerKey -1
  eventOut     SFInt32    triggerValue
)",
     nullptr, &kIntegerTriggerBehaviour},
    {"NormalInterpolator", "Interpolation", 2, "children", "X3DInterpolatorNode", Role::child | Role::interpolator,
     NodeKind::other, R"(
  eventIn      SFFloat    set_fraction
  exposedField MFFloat    key []
  exposedField MFVec3f    keyValue []
  eventOut     MFVec3f    value_changed
)"},
    {"OrientationChaser", "Followers", 1, "children", "X3DChaserNode", Role::child, NodeKind::other, R"(
  eventIn      SFRotation set_destination
  eventIn      SFRotation set_value
  field        SFTime     duration 1  # [0,inf)
  field        SFRotation initialDestination 0 1 0 0
  field        SFRotation initialValue 0 1 0 0
  eventOut     SFBool     isActive
  eventOut     SFRotation value_changed
)",
     nullptr, &kOrientationChaserBehaviour},
    {"OrientationDamper", "Followers", 1, "children", "X3DDamperNode", Role::child, NodeKind::other, R"(
  eventIn      SFRotation set_destination
  eventIn      SFRotation set_value
  exposedField SFTime     tau 0.3  # [0,inf)
  exposedField SFFloat    tolerance -1
  field        SFRotation initialDestination 0 1 0 0
  field        SFRotation initialValue 0 1 0 0
  field        SFInt32    order 3  # [0,5]
  eventOut     SFBool     isActive
  eventOut     SFRotation value_changed
)",
     nullptr, &kOrientationDamperBehaviour},
    {"OrientationInterpolator", "Interpolation", 1, "children", "X3DInterpolatorNode", Role::child | Role::interpolator,
     NodeKind::other, R"(
  eventIn      SFFloat    set_fraction
  exposedField MFFloat    key []
  exposedField MFRotation keyValue []
  eventOut     SFRotation value_changed
)"},
    {"PositionChaser", "Followers", 1, "children", "X3DChaserNode", Role::child, NodeKind::other, R"(
  eventIn      SFVec3f    set_destination
  eventIn      SFVec3f    set_value
  field        SFTime     duration 1  # [0,inf)
  field        SFVec3f    initialDestination 0 0 0
  field        SFVec3f    initialValue 0 0 0
  eventOut     SFBool     isActive
  eventOut     SFVec3f    value_changed
)",
     nullptr, &kPositionChaserBehaviour},
    {"PositionChaser2D", "Followers", 1, "children", "X3DChaserNode", Role::child, NodeKind::other, R"(
  eventIn      SFVec2f    set_destination
  eventIn      SFVec2f    set_value
  field        SFTime     duration 1  # [0,inf)
  field        SFVec2f    initialDestination 0 0
  field        SFVec2f    initialValue 0 0
  eventOut     SFBool     isActive
  eventOut     SFVec2f    value_changed
)",
     nullptr, &kPositionChaser2DBehaviour},
    {"PositionDamper", "Followers", 1, "children", "X3DDamperNode", Role::child, NodeKind::other, R"(
  eventIn      SFVec3f    set_destination
  eventIn      SFVec3f    set_value
  exposedField SFTime     tau 0.3  # [0,inf)
  exposedField SFFloat    tolerance -1
  field        SFVec3f    initialDestination 0 0 0
  field        SFVec3f    initialValue 0 0 0
  field        SFInt32    order 3  # [0,5]
  eventOut     SFBool     isActive
  eventOut     SFVec3f    value_changed
)",
     nullptr, &kPositionDamperBehaviour},
    {"PositionDamper2D", "Followers", 1, "children", "X3DDamperNode", Role::child, NodeKind::other, R"(
  eventIn      SFVec2f    set_destination
  eventIn      SFVec2f    set_value
  exposedField SFTime     tau 0.3  # [0,inf)
  exposedField SFFloat    tolerance -1
  field        SFVec2f    initialDestination 0 0
  field        SFVec2f    initialValue 0 0
  field        SFInt32    order 3  # [0,5]
  eventOut     SFBool     isActive
  eventOut     SFVec2f    value_changed
)",
     nullptr, &kPositionDamper2DBehaviour},
    {"PositionInterpolator", "Interpolation", 1, "children", "X3DInterpolatorNode", Role::child | Role::interpolator,
     NodeKind::other, R"(
  eventIn      SFFloat    set_fraction
  exposedField MFFloat    key []
  exposedField MFVec3f    keyValue []
  eventOut     SFVec3f    value_changed
)"},
    {"PositionInterpolator2D", "Interpolation", 3, "children", "X3DInterpolatorNode", Role::child | Role::interpolator,
     NodeKind::other, R"(
  eventIn      SFFloat    set_fraction
  exposedField MFFloat    key []
  exposedField MFVec2f    keyValue []
  eventOut     SFVec2f    value_changed
)",
     nullptr, &kPositionInterpolator2DBehaviour},
    {"ScalarChaser", "Followers", 1, "children", "X3DChaserNode", Role::child, NodeKind::other, R"(
  eventIn      SFFloat    set_destination
  eventIn      SFFloat    set_value
  field        SFTime     duration 1  # [0,inf)
  field        SFFloat    initialDestination 0
  field        SFFloat    initialValue 0
  eventOut     SFBool     isActive
  eventOut     SFFloat    value_changed
)",
     nullptr, &kScalarChaserBehaviour},
    {"ScalarDamper", "Followers", 1, "children", "X3DDamperNode", Role::child, NodeKind::other, R"(
  eventIn      SFFloat    set_destination
  eventIn      SFFloat    set_value
  exposedField SFTime     tau 0.3  # [0,inf)
  exposedField SFFloat    tolerance -1
  field        SFFloat    initialDestination 0
  field        SFFloat    initialValue 0
  field        SFInt32    order 3  # [0,5]
  eventOut     SFBool     isActive
  eventOut     SFFloat    value_changed
)",
     nullptr, &kScalarDamperBehaviour},
    {"ScalarInterpolator", "Interpolation", 1, "children", "X3DInterpolatorNode", Role::child | Role::interpolator,
     NodeKind::other, R"(
  eventIn      SFFloat    set_fraction
  exposedField MFFloat    key []
  exposedField MFFloat    keyValue []
  eventOut     SFFloat    value_changed
)"},
    {"SplinePositionInterpolator", "Interpolation", 4, "children", "X3DInterpolatorNode",
     Role::child | Role::interpolator, NodeKind::other, R"(
  eventIn      SFFloat    set_fraction
  exposedField SFBool     closed FALSE
  exposedField MFFloat    key []
  exposedField MFVec3f    keyValue []
  exposedField MFVec3f    keyVelocity []
  exposedField SFBool     normalizeVelocity FALSE
  eventOut     SFVec3f    value_changed
)",
     nullptr, &kSplinePositionInterpolatorBehaviour},
    {"SplinePositionInterpolator2D", "Interpolation", 4, "children", "X3DInterpolatorNode",
     Role::child | Role::interpolator, NodeKind::other, R"(
  eventIn      SFFloat    set_fraction
  exposedField SFBool     closed FALSE
  exposedField MFFloat    key []
  exposedField MFVec2f    keyValue []
  exposedField MFVec2f    keyVelocity []
  exposedField SFBool     normalizeVelocity FALSE
  eventOut     SFVec2f    value_changed
)",
     nullptr, &kSplinePositionInterpolator2DBehaviour},
    {"SplineScalarInterpolator", "Interpolation", 4, "children", "X3DInterpolatorNode",
     Role::child | Role::interpolator, NodeKind::other, R"(
  eventIn      SFFloat    set_fraction
  exposedField SFBool     closed FALSE
  exposedField MFFloat    key []
  exposedField MFFloat    keyValue []
  exposedField MFFloat    keyVelocity []
  exposedField SFBool     normalizeVelocity FALSE
  eventOut     SFFloat    value_changed
)",
     nullptr, &kSplineScalarInterpolatorBehaviour},
    {"SquadOrientationInterpolator", "Interpolation", 5, "children", "X3DInterpolatorNode",
     Role::child | Role::interpolator, NodeKind::other, R"(
  eventIn      SFFloat    set_fraction
  exposedField MFFloat    key []
  exposedField MFRotation keyValue []
  exposedField SFBool     normalizeVelocity FALSE
  eventOut     SFRotation value_changed
)",
     nullptr, &kSquadOrientationInterpolatorBehaviour},
    {"TexCoordChaser2D", "Followers", 1, "children", "X3DChaserNode", Role::child, NodeKind::other, R"(
  eventIn      MFVec2f    set_destination
  eventIn      MFVec2f    set_value
  field        SFTime     duration 1  # [0,inf)
  field        MFVec2f    initialDestination []
  field        MFVec2f    initialValue []
  eventOut     SFBool     isActive
  eventOut     MFVec2f    value_changed
)",
     nullptr, &kTexCoordChaser2DBehaviour},
    {"TexCoordDamper2D", "Followers", 1, "children", "X3DDamperNode", Role::child, NodeKind::other, R"(
  eventIn      MFVec2f    set_destination
  eventIn      MFVec2f    set_value
  exposedField SFTime     tau 0.3  # [0,inf)
  exposedField SFFloat    tolerance -1
  field        MFVec2f    initialDestination []
  field        MFVec2f    initialValue []
  field        SFInt32    order 3  # [0,5]
  eventOut     SFBool     isActive
  eventOut     MFVec2f    value_changed
)",
     nullptr, &kTexCoordDamper2DBehaviour},
    {"TimeTrigger", "EventUtilities", 1, "children", "X3DTriggerNode", Role::child, NodeKind::other, R"(
  eventIn      SFBool     set_boolean
  eventOut     SFTime     triggerTime
)",
     nullptr, &kTimeTriggerBehaviour},
};

}  // namespace

std::span<const X3DRow> x3d_animation_rows() { return kAnimationX3DRows; }

}  // namespace gs::vrml
