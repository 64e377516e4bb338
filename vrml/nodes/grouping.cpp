#include "vrml/event_model/behaviour.h"
#include "vrml/nodes/families.h"

namespace gs::vrml {
namespace {

// Rows of the grouping and special group nodes (VRML97 4.6.5).
constexpr NodeRow kGroupingRows[] = {
    {"Anchor", "6.2", Role::child | Role::grouping, NodeKind::group, R"(
  eventIn      MFNode     addChildren
  eventIn      MFNode     removeChildren
  exposedField MFNode     children         []
  exposedField SFString   description      ""
  exposedField MFString   parameter        []
  exposedField MFString   url              []
  field        SFVec3f    bboxCenter       0 0 0            # (-inf,inf)
  field        SFVec3f    bboxSize         -1 -1 -1         # (0,inf) or -1,-1,-1
)",
     nullptr, &kAnchorBehaviour},
    {"Billboard", "6.6", Role::child | Role::grouping | Role::viewer_dependent, NodeKind::billboard, R"(
  eventIn      MFNode     addChildren
  eventIn      MFNode     removeChildren
  exposedField SFVec3f    axisOfRotation   0 1 0            # (-inf,inf)
  exposedField MFNode     children         []
  field        SFVec3f    bboxCenter       0 0 0            # (-inf,inf)
  field        SFVec3f    bboxSize         -1 -1 -1         # (0,inf) or -1,-1,-1
)",
     nullptr, &kBillboardBehaviour},
    {"Collision", "6.8", Role::child | Role::grouping, NodeKind::collision, R"(
  eventIn      MFNode     addChildren
  eventIn      MFNode     removeChildren
  exposedField MFNode     children         []
  exposedField SFBool     collide          TRUE
  field        SFVec3f    bboxCenter       0 0 0            # (-inf,inf)
  field        SFVec3f    bboxSize         -1 -1 -1         # (0,inf) or -1,-1,-1
  field        SFNode     proxy            NULL
  eventOut     SFTime     collideTime
)",
     nullptr, &kCollisionBehaviour},
    {"Group", "6.21", Role::child | Role::grouping, NodeKind::group, R"(
  eventIn      MFNode     addChildren
  eventIn      MFNode     removeChildren
  exposedField MFNode     children         []
  field        SFVec3f    bboxCenter       0 0 0            # (-inf,inf)
  field        SFVec3f    bboxSize         -1 -1 -1         # (0,inf) or -1,-1,-1
)",
     nullptr, &kGroupBehaviour},
    {"Inline", "6.25", Role::child | Role::grouping, NodeKind::inline_node, R"(
  exposedField MFString   url              []
  field        SFVec3f    bboxCenter       0 0 0            # (-inf,inf)
  field        SFVec3f    bboxSize         -1 -1 -1         # (0,inf) or -1,-1,-1
)",
     nullptr, &kInlineBehaviour, UrlContent::scene, "eventOut MFNode children_changed"},
    {"LOD", "6.26", Role::child | Role::grouping | Role::viewer_dependent, NodeKind::lod, R"(
  exposedField MFNode     level            []
  field        SFVec3f    center           0 0 0            # (-inf,inf)
  field        MFFloat    range            []               # (0,inf)
)"},
    {"NurbsGroup", kAmendmentClause, Role::child | Role::grouping, NodeKind::group, R"(
  eventIn      MFNode     addChildren
  eventIn      MFNode     removeChildren
  exposedField MFNode     children         []
  exposedField SFFloat    tessellationScale 1.0             # (0,inf)
  field        SFVec3f    bboxCenter       0 0 0            # (-inf,inf)
  field        SFVec3f    bboxSize         -1 -1 -1         # (0,inf) or -1,-1,-1
)",
     nullptr, &kGroupBehaviour},
    {"Switch", "6.46", Role::child | Role::grouping, NodeKind::switch_node, R"(
  exposedField MFNode     choice           []
  exposedField SFInt32    whichChoice      -1               # [-1,inf)
)"},
    {"Transform", "6.52", Role::child | Role::grouping, NodeKind::transform, R"(
  eventIn      MFNode     addChildren
  eventIn      MFNode     removeChildren
  exposedField SFVec3f    center           0 0 0            # (-inf,inf)
  exposedField MFNode     children         []
  exposedField SFRotation rotation         0 0 1 0          # [-1,1],(-inf,inf)
  exposedField SFVec3f    scale            1 1 1            # (0,inf)
  exposedField SFRotation scaleOrientation 0 0 1 0          # [-1,1],(-inf,inf)
  exposedField SFVec3f    translation      0 0 0            # (-inf,inf)
  field        SFVec3f    bboxCenter       0 0 0            # (-inf,inf)
  field        SFVec3f    bboxSize         -1 -1 -1         # (0,inf) or -1,-1,-1
)",
     nullptr, &kTransformBehaviour},
};

}  // namespace

std::span<const NodeRow> grouping_rows() { return kGroupingRows; }

}  // namespace gs::vrml
