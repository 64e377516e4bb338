#include "vrml/event_model/behaviour.h"
#include "vrml/nodes/families.h"

namespace gs::vrml {
namespace {

// Rows of the bindable nodes (VRML97 4.6.10).
constexpr NodeRow kBindablesRows[] = {
    {"Background", "6.5", Role::child | Role::bindable, NodeKind::background, R"(
  eventIn      SFBool     set_bind
  exposedField MFFloat    groundAngle      []               # [0,pi/2]
  exposedField MFColor    groundColor      []               # [0,1]
  exposedField MFString   backUrl          []
  exposedField MFString   bottomUrl        []
  exposedField MFString   frontUrl         []
  exposedField MFString   leftUrl          []
  exposedField MFString   rightUrl         []
  exposedField MFString   topUrl           []
  exposedField MFFloat    skyAngle         []               # [0,pi]
  exposedField MFColor    skyColor         0 0 0            # [0,1]
  eventOut     SFBool     isBound
)",
     nullptr, &kBindableBehaviour, UrlContent::image},
    {"Fog", "6.19", Role::child | Role::bindable, NodeKind::fog, R"(
  exposedField SFColor    color            1 1 1            # [0,1]
  exposedField SFString   fogType          "LINEAR"
  exposedField SFFloat    visibilityRange  0                # [0,inf)
  eventIn      SFBool     set_bind
  eventOut     SFBool     isBound
)",
     nullptr, &kBindableBehaviour},
    {"NavigationInfo", "6.29", Role::child | Role::bindable, NodeKind::navigation_info, R"(
  eventIn      SFBool     set_bind
  exposedField MFFloat    avatarSize       [0.25, 1.6, 0.75]  # [0,inf)
  exposedField SFBool     headlight        TRUE
  exposedField SFFloat    speed            1.0              # [0,inf)
  exposedField MFString   type             ["WALK", "ANY"]
  exposedField SFFloat    visibilityLimit  0.0              # [0,inf)
  eventOut     SFBool     isBound
)",
     nullptr, &kBindableBehaviour},
    {"Viewpoint", "6.53", Role::child | Role::bindable, NodeKind::viewpoint, R"(
  eventIn      SFBool     set_bind
  exposedField SFFloat    fieldOfView      0.785398         # (0,inf)
  exposedField SFBool     jump             TRUE
  exposedField SFRotation orientation      0 0 1 0          # [-1,1],(-inf,inf)
  exposedField SFVec3f    position         0 0 10           # (-inf,inf)
  field        SFString   description      ""
  eventOut     SFTime     bindTime
  eventOut     SFBool     isBound
)",
     nullptr, &kViewpointBehaviour},
};

}  // namespace

std::span<const NodeRow> bindables_rows() { return kBindablesRows; }

}  // namespace gs::vrml
