#include "vrml/event_model/behaviour.h"
#include "vrml/nodes/x3d/components.h"

// Rows of the X3D components Navigation, Layering, Layout (ISO/IEC 19775-1).
namespace gs::vrml {
namespace {

constexpr X3DRow kNavigationX3DRows[] = {
    {"Billboard", "Navigation", 2, "children", "X3DGroupingNode", Role::child | Role::grouping, NodeKind::other, R"(
  eventIn      MFNode     addChildren  # X3DChildNode
  eventIn      MFNode     removeChildren  # X3DChildNode
  exposedField SFVec3f    axisOfRotation 0 1 0
  exposedField SFBool     bboxDisplay FALSE
  exposedField MFNode     children []  # X3DChildNode
  exposedField SFBool     visible TRUE
  field        SFVec3f    bboxCenter 0 0 0
  field        SFVec3f    bboxSize -1 -1 -1
)"},
    {"Collision", "Navigation", 2, "children", "X3DGroupingNode X3DSensorNode",
     Role::child | Role::grouping | Role::sensor, NodeKind::other, R"(
  eventIn      MFNode     addChildren  # X3DChildNode
  eventIn      MFNode     removeChildren  # X3DChildNode
  exposedField SFBool     bboxDisplay FALSE
  exposedField MFNode     children []  # X3DChildNode
  exposedField SFString   description ""
  exposedField SFBool     enabled TRUE
  exposedField SFBool     visible TRUE
  field        SFVec3f    bboxCenter 0 0 0
  field        SFVec3f    bboxSize -1 -1 -1
  field        SFNode     proxy NULL  # X3DChildNode
  eventOut     SFTime     collideTime
  eventOut     SFBool     isActive
)"},
    {"LOD", "Navigation", 2, "children", "X3DGroupingNode", Role::child | Role::grouping, NodeKind::other, R"(
  eventIn      MFNode     addChildren  # X3DChildNode
  eventIn      MFNode     removeChildren  # X3DChildNode
  exposedField SFBool     bboxDisplay FALSE
  exposedField MFNode     children []  # X3DChildNode
  exposedField SFBool     visible TRUE
  field        SFVec3f    bboxCenter 0 0 0
  field        SFVec3f    bboxSize -1 -1 -1
  field        SFVec3f    center 0 0 0
  field        SFBool     forceTransitions FALSE
  field        MFFloat    range []
  eventOut     SFInt32    level_changed  # [0,inf)
)",
     nullptr, &kLodBehaviour},
    {"Layer", "Layering", 1, "layers", "X3DLayerNode", Role::grouping, NodeKind::layer,
     R"(
  eventIn      MFNode     addChildren  # X3DChildNode
  eventIn      MFNode     removeChildren  # X3DChildNode
  exposedField MFNode     children []  # X3DChildNode
  exposedField MFString   objectType ["ALL"]
  exposedField SFBool     isPickable TRUE
  exposedField SFNode     viewport NULL  # X3DViewportNode
  exposedField SFBool     visible TRUE
)",
     nullptr, &kGroupBehaviour},
    {"LayerSet", "Layering", 1, "children", "X3DNode", Role::grouping, NodeKind::layer_set,
     R"(
  exposedField SFInt32    activeLayer 0  # [0,inf)
  exposedField MFNode     layers []  # X3DLayerNode
  exposedField MFInt32    order [0]  # [0,inf)
)",
     nullptr, &kLayerSetBehaviour},
    {"Layout",
     "Layout",
     1,
     "layout",
     "X3DLayoutNode",
     Role::child,
     NodeKind::layout,
     R"(
  exposedField MFString   align ["CENTER" "CENTER"]
  exposedField MFFloat    offset [0 0]
  exposedField MFString   offsetUnits ["WORLD" "WORLD"]
  exposedField MFString   scaleMode ["NONE" "NONE"]
  exposedField MFFloat    size [1 1]
  exposedField MFString   sizeUnits ["WORLD" "WORLD"]
)"},
    {"LayoutGroup", "Layout", 1, "children", "X3DNode X3DGroupingNode",
     Role::child | Role::grouping | Role::viewer_dependent, NodeKind::layout_group,
     R"(
  eventIn      MFNode     addChildren  # X3DChildNode
  eventIn      MFNode     removeChildren  # X3DChildNode
  exposedField SFBool     bboxDisplay FALSE
  exposedField MFNode     children []  # X3DChildNode
  exposedField SFNode     layout NULL  # X3DLayoutNode
  exposedField SFNode     viewport NULL  # X3DViewportNode
  exposedField SFBool     visible TRUE
  field        SFVec3f    bboxCenter 0 0 0
  field        SFVec3f    bboxSize -1 -1 -1
)",
     nullptr, &kGroupBehaviour},
    {"LayoutLayer", "Layout", 1, "layers", "X3DLayerNode", Role::grouping | Role::viewer_dependent, NodeKind::layout_layer,
     R"(
  eventIn      MFNode     addChildren  # X3DChildNode
  eventIn      MFNode     removeChildren  # X3DChildNode
  exposedField MFNode     children []  # X3DChildNode
  exposedField SFNode     layout NULL  # X3DLayoutNode
  exposedField MFString   objectType ["ALL"]
  exposedField SFBool     isPickable TRUE
  exposedField SFNode     viewport NULL  # X3DViewportNode
  exposedField SFBool     visible TRUE
)",
     nullptr, &kGroupBehaviour},
    {"NavigationInfo", "Navigation", 1, "children", "X3DBindableNode", Role::child | Role::bindable, NodeKind::other,
     R"(
  eventIn      SFBool     set_bind
  exposedField MFFloat    avatarSize [0.25 1.6 0.75]  # [0,inf)
  exposedField SFBool     headlight TRUE
  exposedField SFFloat    speed 1  # [0,inf)
  exposedField SFTime     transitionTime 1.0  # [0,inf)
  exposedField MFString   transitionType ["LINEAR"]
  exposedField MFString   type ["EXAMINE" "ANY"]
  exposedField SFFloat    visibilityLimit 0  # [0,inf)
  eventOut     SFTime     bindTime
  eventOut     SFBool     isBound
  eventOut     SFBool     transitionComplete
)",
     nullptr, &kNavigationInfoBehaviour},
    {"OrthoViewpoint", "Navigation", 3, "children", "X3DViewpointNode", Role::child | Role::bindable,
     NodeKind::viewpoint,
     R"(
  eventIn      SFBool     set_bind
  exposedField SFVec3f    centerOfRotation 0 0 0
  exposedField SFString   description ""
  exposedField SFFloat    farDistance -1
  exposedField MFFloat    fieldOfView [-1 -1 1 1]
  exposedField SFBool     jump TRUE
  exposedField SFNode     navigationInfo NULL  # NavigationInfo
  exposedField SFFloat    nearDistance -1
  exposedField SFRotation orientation 0 0 1 0
  exposedField SFVec3f    position 0 0 10
  exposedField SFBool     retainUserOffsets FALSE
  exposedField SFBool     viewAll FALSE
  eventOut     SFTime     bindTime
  eventOut     SFBool     isBound
)",
     nullptr, &kOrthoViewpointBehaviour},
    {"ScreenFontStyle",
     "Layout",
     2,
     "fontStyle",
     "X3DFontStyleNode",
     Role::font_style,
     NodeKind::font_style,
     R"(
  exposedField MFString   family ["SERIF"]
  exposedField SFBool     horizontal TRUE
  exposedField MFString   justify ["BEGIN"]
  exposedField SFString   language ""
  exposedField SFBool     leftToRight TRUE
  exposedField SFFloat    pointSize 12.0  # (0,inf)
  exposedField SFFloat    spacing 1.0  # [0,inf)
  exposedField SFString   style "PLAIN"
  exposedField SFBool     topToBottom TRUE
)"},
    {"ScreenGroup", "Layout", 2, "children", "X3DGroupingNode", Role::child | Role::grouping | Role::viewer_dependent,
     NodeKind::screen_group,
     R"(
  eventIn      MFNode     addChildren  # X3DChildNode
  eventIn      MFNode     removeChildren  # X3DChildNode
  exposedField SFBool     bboxDisplay FALSE
  exposedField MFNode     children []  # X3DChildNode
  exposedField SFBool     visible TRUE
  field        SFVec3f    bboxCenter 0 0 0
  field        SFVec3f    bboxSize -1 -1 -1
)",
     nullptr, &kGroupBehaviour},
    {"Viewpoint", "Navigation", 1, "children", "X3DViewpointNode", Role::child | Role::bindable, NodeKind::other, R"(
  eventIn      SFBool     set_bind
  exposedField SFVec3f    centerOfRotation 0 0 0
  exposedField SFString   description ""
  exposedField SFFloat    farDistance -1
  exposedField SFFloat    fieldOfView 0.7854  # (0,3.1416)
  exposedField SFBool     jump TRUE
  exposedField SFNode     navigationInfo NULL  # NavigationInfo
  exposedField SFFloat    nearDistance -1
  exposedField SFRotation orientation 0 0 1 0
  exposedField SFVec3f    position 0 0 10
  exposedField SFBool     retainUserOffsets FALSE
  exposedField SFBool     viewAll FALSE
  eventOut     SFTime     bindTime
  eventOut     SFBool     isBound
)"},
    {"ViewpointGroup", "Navigation", 3, "children", "X3DChildNode", Role::child | Role::grouping,
     NodeKind::viewpoint_group, R"(
  exposedField SFVec3f    center 0 0 0
  exposedField MFNode     children []  # X3DViewpointNode,ViewpointGroup
  exposedField SFString   description ""
  exposedField SFBool     displayed TRUE
  exposedField SFBool     retainUserOffsets FALSE
  exposedField SFVec3f    size 0 0 0
)"},
    {"Viewport", "Layering", 1, "viewport", "X3DViewportNode", Role::child | Role::grouping, NodeKind::viewport,
     R"(
  eventIn      MFNode     addChildren  # X3DChildNode
  eventIn      MFNode     removeChildren  # X3DChildNode
  exposedField SFBool     bboxDisplay FALSE
  exposedField MFNode     children []  # X3DChildNode
  exposedField MFFloat    clipBoundary [0 1 0 1]  # [0,1]
  exposedField SFBool     visible TRUE
  field        SFVec3f    bboxCenter 0 0 0
  field        SFVec3f    bboxSize -1 -1 -1
)",
     nullptr, &kGroupBehaviour},
};

}  // namespace

std::span<const X3DRow> x3d_navigation_rows() { return kNavigationX3DRows; }

}  // namespace gs::vrml
