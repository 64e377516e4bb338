#include "vrml/event_model/behaviour.h"
#include "vrml/nodes/x3d/components.h"

// Rows of the X3D component HAnim (ISO/IEC 19775-1).
namespace gs::vrml {
namespace {

constexpr X3DRow kHAnimX3DRows[] = {
    {"HAnimDisplacer",
     "HAnim",
     1,
     "displacers",
     "X3DGeometricPropertyNode",
     Role::geometric_property,
     NodeKind::other,
     R"(
  exposedField MFInt32    coordIndex []
  exposedField SFString   description ""
  exposedField MFVec3f    displacements []
  exposedField SFString   name ""
  exposedField SFFloat    weight 0.0
)",
     {},
     &kDisplacerBehaviour},
    {"HAnimHumanoid",
     "HAnim",
     1,
     "children",
     "X3DChildNode X3DBoundedObject",
     Role::child | Role::grouping,
     NodeKind::humanoid,
     R"(
  exposedField SFBool     bboxDisplay FALSE
  exposedField SFVec3f    center 0 0 0
  exposedField SFString   description ""
  exposedField MFString   info []
  exposedField MFVec3f    jointBindingPositions []
  exposedField MFRotation jointBindingRotations []
  exposedField MFVec3f    jointBindingScales []
  exposedField MFNode     joints []  # HAnimJoint
  exposedField SFInt32    loa -1  # [-1,4]
  exposedField MFNode     motions []  # HAnimMotion
  exposedField MFBool     motionsEnabled []
  exposedField SFString   name ""
  exposedField SFRotation rotation 0 0 1 0
  exposedField SFVec3f    scale 1 1 1  # (0,inf)
  exposedField SFRotation scaleOrientation 0 0 1 0
  exposedField MFNode     segments []  # HAnimSegment
  exposedField MFNode     sites []  # HAnimSite
  exposedField SFString   skeletalConfiguration "BASIC"
  exposedField MFNode     skeleton []  # HAnimJoint,HAnimSite
  exposedField MFNode     skin []  # Group,Transform,Shape,IndexedFaceSet
  exposedField SFNode     skinBindingCoords NULL  # Coordinate,CoordinateDouble
  exposedField SFNode     skinBindingNormals NULL  # X3DNormalNode
  exposedField SFNode     skinCoord NULL  # Coordinate,CoordinateDouble
  exposedField SFNode     skinNormal NULL  # X3DNormalNode
  exposedField SFVec3f    translation 0 0 0
  exposedField SFString   version "2.0"
  exposedField MFNode     viewpoints []  # HAnimSite
  exposedField SFBool     visible TRUE
  field        SFVec3f    bboxCenter 0 0 0
  field        SFVec3f    bboxSize -1 -1 -1
)",
     {},
     &kHumanoidBehaviour},
    {"HAnimJoint",
     "HAnim",
     1,
     "children",
     "X3DChildNode X3DBoundedObject",
     Role::child | Role::grouping,
     NodeKind::transform,
     R"(
  eventIn      MFNode     addChildren  # HAnimJoint,HAnimSegment
  eventIn      MFNode     removeChildren  # HAnimJoint,HAnimSegment
  exposedField SFBool     bboxDisplay FALSE
  exposedField SFVec3f    center 0 0 0
  exposedField MFNode     children []  # HAnimJoint,HAnimSegment
  exposedField SFString   description ""
  exposedField MFNode     displacers []  # HAnimDisplacer
  exposedField SFRotation limitOrientation 0 0 1 0
  exposedField MFFloat    llimit [0 0 0]
  exposedField SFString   name ""
  exposedField SFRotation rotation 0 0 1 0
  exposedField SFVec3f    scale 1 1 1  # (0,inf)
  exposedField SFRotation scaleOrientation 0 0 1 0
  exposedField MFInt32    skinCoordIndex []  # [0,inf)
  exposedField MFFloat    skinCoordWeight []
  exposedField MFFloat    stiffness [0 0 0]  # [0,1]
  exposedField SFVec3f    translation 0 0 0
  exposedField MFFloat    ulimit [0 0 0]
  exposedField SFBool     visible TRUE
  field        SFVec3f    bboxCenter 0 0 0
  field        SFVec3f    bboxSize -1 -1 -1
)",
     {},
     &kJointBehaviour},
    {"HAnimMotion",
     "HAnim",
     2,
     "motions",
     "X3DChildNode",
     Role::child,
     NodeKind::other,
     R"(
  eventIn      SFBool     next
  eventIn      SFBool     previous
  exposedField SFString   channels ""
  exposedField MFBool     channelsEnabled []
  exposedField SFString   description ""
  exposedField SFBool     enabled TRUE
  exposedField SFInt32    endFrame 0  # [0,inf)
  exposedField SFTime     frameDuration 0.1  # (0,inf)
  exposedField SFInt32    frameIncrement 1
  exposedField SFInt32    frameIndex 0  # [0,inf)
  exposedField SFString   joints ""
  exposedField SFInt32    loa -1  # [-1,4]
  exposedField SFBool     loop FALSE
  exposedField SFString   name ""
  exposedField SFInt32    startFrame 0  # [0,inf)
  exposedField MFFloat    values []
  eventOut     SFTime     cycleTime  # [0,inf)
  eventOut     SFTime     elapsedTime  # [0,inf)
  eventOut     SFInt32    frameCount  # [0,inf)
)",
     {},
     &kMotionBehaviour},
    {"HAnimSegment",
     "HAnim",
     1,
     "children",
     "X3DGroupingNode",
     Role::child | Role::grouping,
     NodeKind::group,
     R"(
  eventIn      MFNode     addChildren  # X3DChildNode
  eventIn      MFNode     removeChildren  # X3DChildNode
  exposedField SFBool     bboxDisplay FALSE
  exposedField SFVec3f    centerOfMass 0 0 0
  exposedField MFNode     children []  # X3DChildNode
  exposedField SFNode     coord NULL  # Coordinate,CoordinateDouble
  exposedField SFString   description ""
  exposedField MFNode     displacers []  # HAnimDisplacer
  exposedField SFFloat    mass 0  # [0,inf)
  exposedField MFFloat    momentsOfInertia [0 0 0 0 0 0 0 0 0]  # [0,inf)
  exposedField SFString   name ""
  exposedField SFBool     visible TRUE
  field        SFVec3f    bboxCenter 0 0 0
  field        SFVec3f    bboxSize -1 -1 -1
)",
     {},
     &kSegmentBehaviour},
    {"HAnimSite",
     "HAnim",
     1,
     "children",
     "X3DGroupingNode",
     Role::child | Role::grouping,
     NodeKind::transform,
     R"(
  eventIn      MFNode     addChildren  # X3DChildNode
  eventIn      MFNode     removeChildren  # X3DChildNode
  exposedField SFBool     bboxDisplay FALSE
  exposedField SFVec3f    center 0 0 0
  exposedField MFNode     children []  # X3DChildNode
  exposedField SFString   description ""
  exposedField SFString   name ""
  exposedField SFRotation rotation 0 0 1 0
  exposedField SFVec3f    scale 1 1 1  # (0,inf)
  exposedField SFRotation scaleOrientation 0 0 1 0
  exposedField SFVec3f    translation 0 0 0
  exposedField SFBool     visible TRUE
  field        SFVec3f    bboxCenter 0 0 0
  field        SFVec3f    bboxSize -1 -1 -1
)",
     {},
     &kTransformBehaviour},
};

}  // namespace

std::span<const X3DRow> x3d_h_anim_rows() { return kHAnimX3DRows; }

}  // namespace gs::vrml
