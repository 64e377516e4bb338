#include "vrml/event_model/behaviour.h"
#include "vrml/nodes/x3d/components.h"

// Rows of the X3D components Core, Grouping, Networking, Scripting, Text, Time (ISO/IEC 19775-1).
namespace gs::vrml {
namespace {

constexpr X3DRow kCoreX3DRows[] = {
    {"Anchor", "Networking", 2, "children", "X3DGroupingNode X3DUrlObject", Role::child | Role::grouping,
     NodeKind::other, R"(
  eventIn      MFNode     addChildren  # X3DChildNode
  eventIn      MFNode     removeChildren  # X3DChildNode
  exposedField SFTime     autoRefresh 0  # [0,inf)
  exposedField SFTime     autoRefreshTimeLimit 3600  # [0,inf)
  exposedField SFBool     bboxDisplay FALSE
  exposedField MFNode     children []  # X3DChildNode
  exposedField SFString   description ""
  exposedField SFBool     load TRUE
  exposedField MFString   parameter []
  exposedField MFString   url []
  exposedField SFBool     visible TRUE
  field        SFVec3f    bboxCenter 0 0 0
  field        SFVec3f    bboxSize -1 -1 -1
)"},
    {"FontStyle", "Text", 1, "fontStyle", "X3DFontStyleNode", Role::font_style, NodeKind::other, R"(
  exposedField MFString   family ["SERIF"]
  exposedField SFBool     horizontal TRUE
  exposedField MFString   justify ["BEGIN"]
  exposedField SFString   language ""
  exposedField SFBool     leftToRight TRUE
  exposedField SFFloat    size 1.0  # (0,inf)
  exposedField SFFloat    spacing 1.0  # [0,inf)
  exposedField SFBool     topToBottom TRUE
)"},
    {"Group", "Grouping", 1, "children", "X3DGroupingNode", Role::child | Role::grouping, NodeKind::other, R"(
  eventIn      MFNode     addChildren  # X3DChildNode
  eventIn      MFNode     removeChildren  # X3DChildNode
  exposedField SFBool     bboxDisplay FALSE
  exposedField MFNode     children []  # X3DChildNode
  exposedField SFBool     visible TRUE
  field        SFVec3f    bboxCenter 0 0 0
  field        SFVec3f    bboxSize -1 -1 -1
)"},
    {"Inline", "Networking", 2, "children", "X3DChildNode X3DBoundedObject X3DUrlObject", Role::child, NodeKind::other,
     R"(
  exposedField SFTime     autoRefresh 0  # [0,inf)
  exposedField SFTime     autoRefreshTimeLimit 3600  # [0,inf)
  exposedField SFBool     bboxDisplay FALSE
  exposedField SFString   description ""
  exposedField SFBool     global FALSE
  exposedField SFBool     load TRUE
  exposedField MFString   url []
  exposedField SFBool     visible TRUE
  field        SFVec3f    bboxCenter 0 0 0
  field        SFVec3f    bboxSize -1 -1 -1
)"},
    {"LoadSensor",
     "Networking",
     3,
     "children",
     "X3DNetworkSensorNode",
     Role::child | Role::sensor,
     NodeKind::other,
     R"(
  exposedField MFNode     watchList []  # X3DUrlObject
  exposedField SFString   description ""
  exposedField SFBool     enabled TRUE
  exposedField SFTime     timeOut 0  # [0,inf)
  eventOut     SFBool     isActive
  eventOut     SFBool     isLoaded
  eventOut     SFTime     loadTime
  eventOut     SFFloat    progress
)",
     {},
     &kLoadSensorBehaviour},
    {"MetadataBoolean", "Core", 1, "value", "X3DNode X3DMetadataObject", Role::none, NodeKind::other, R"(
  exposedField SFString   name ""
  exposedField SFString   reference ""
  exposedField MFBool     value []
)"},
    {"MetadataDouble", "Core", 1, "value", "X3DNode X3DMetadataObject", Role::none, NodeKind::other, R"(
  exposedField SFString   name ""
  exposedField SFString   reference ""
  exposedField MFDouble   value []
)"},
    {"MetadataFloat", "Core", 1, "value", "X3DNode X3DMetadataObject", Role::none, NodeKind::other, R"(
  exposedField SFString   name ""
  exposedField SFString   reference ""
  exposedField MFFloat    value []
)"},
    {"MetadataInteger", "Core", 1, "value", "X3DNode X3DMetadataObject", Role::none, NodeKind::other, R"(
  exposedField SFString   name ""
  exposedField SFString   reference ""
  exposedField MFInt32    value []
)"},
    {"MetadataSet", "Core", 1, "value", "X3DNode X3DMetadataObject", Role::none, NodeKind::other, R"(
  exposedField SFString   name ""
  exposedField SFString   reference ""
  exposedField MFNode     value []  # X3DMetadataObject
)"},
    {"MetadataString", "Core", 1, "value", "X3DNode X3DMetadataObject", Role::none, NodeKind::other, R"(
  exposedField SFString   name ""
  exposedField SFString   reference ""
  exposedField MFString   value []
)"},
    {"Script", "Scripting", 1, "children", "X3DScriptNode", Role::child | Role::script, NodeKind::other, R"(
  exposedField SFTime     autoRefresh 0  # [0,inf)
  exposedField SFTime     autoRefreshTimeLimit 3600  # [0,inf)
  exposedField SFString   description ""
  exposedField SFBool     load TRUE
  exposedField MFString   url []
  field        SFBool     directOutput FALSE
  field        SFBool     mustEvaluate FALSE
)"},
    {"StaticGroup", "Grouping", 3, "children", "X3DChildNode X3DBoundedObject", Role::child | Role::grouping,
     NodeKind::group, R"(
  exposedField SFBool     bboxDisplay FALSE
  exposedField SFBool     visible TRUE
  field        SFVec3f    bboxCenter 0 0 0
  field        SFVec3f    bboxSize -1 -1 -1
  field        MFNode     children []  # X3DChildNode
)"},
    {"Switch", "Grouping", 2, "children", "X3DGroupingNode", Role::child | Role::grouping, NodeKind::other, R"(
  eventIn      MFNode     addChildren  # X3DChildNode
  eventIn      MFNode     removeChildren  # X3DChildNode
  exposedField SFBool     bboxDisplay FALSE
  exposedField MFNode     children []  # X3DChildNode
  exposedField SFBool     visible TRUE
  exposedField SFInt32    whichChoice -1  # [-1,inf)
  field        SFVec3f    bboxCenter 0 0 0
  field        SFVec3f    bboxSize -1 -1 -1
)",
     nullptr, &kSwitchBehaviour},
    {"Text", "Text", 1, "geometry", "X3DGeometryNode", Role::geometry, NodeKind::other, R"(
  exposedField SFNode     fontStyle NULL  # X3DFontStyleNode
  exposedField MFFloat    length []  # [0,inf)
  exposedField SFFloat    maxExtent 0.0  # [0,inf)
  exposedField MFString   string []
  field        SFBool     solid FALSE
  eventOut     MFVec2f    lineBounds
  eventOut     SFVec3f    origin
  eventOut     SFVec2f    textBounds
)"},
    {"TimeSensor", "Time", 1, "children", "X3DTimeDependentNode X3DSensorNode",
     Role::child | Role::sensor | Role::time_dependent, NodeKind::other, R"(
  exposedField SFTime     cycleInterval 1.0  # [0,inf)
  exposedField SFString   description ""
  exposedField SFBool     enabled TRUE
  exposedField SFBool     loop FALSE
  exposedField SFTime     pauseTime 0
  exposedField SFTime     resumeTime 0
  exposedField SFTime     startTime 0
  exposedField SFTime     stopTime 0
  eventOut     SFTime     cycleTime  # [0,inf)
  eventOut     SFTime     elapsedTime  # [0,inf)
  eventOut     SFFloat    fraction_changed
  eventOut     SFBool     isActive
  eventOut     SFBool     isPaused
  eventOut     SFTime     time  # [0,inf)
)"},
    {"Transform", "Grouping", 1, "children", "X3DGroupingNode", Role::child | Role::grouping, NodeKind::other, R"(
  eventIn      MFNode     addChildren  # X3DChildNode
  eventIn      MFNode     removeChildren  # X3DChildNode
  exposedField SFBool     bboxDisplay FALSE
  exposedField SFVec3f    center 0 0 0
  exposedField MFNode     children []  # X3DChildNode
  exposedField SFRotation rotation 0 0 1 0
  exposedField SFVec3f    scale 1 1 1
  exposedField SFRotation scaleOrientation 0 0 1 0
  exposedField SFVec3f    translation 0 0 0
  exposedField SFBool     visible TRUE
  field        SFVec3f    bboxCenter 0 0 0
  field        SFVec3f    bboxSize -1 -1 -1
)"},
    {"WorldInfo", "Core", 1, "children", "X3DInfoNode", Role::child, NodeKind::other, R"(
  exposedField MFString   info []
  exposedField SFString   title ""
)"},
};

}  // namespace

std::span<const X3DRow> x3d_core_rows() { return kCoreX3DRows; }

}  // namespace gs::vrml
