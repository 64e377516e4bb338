#include "vrml/event_model/behaviour.h"
#include "vrml/nodes/families.h"

namespace gs::vrml {
namespace {

// Rows of AudioClip, Script, Sound and WorldInfo (VRML97 4.6.4).
constexpr NodeRow kCommonRows[] = {
    {"AudioClip", "6.4", Role::sound_source | Role::time_dependent, NodeKind::other, R"(
  exposedField SFString   description      ""
  exposedField SFBool     loop             FALSE
  exposedField SFFloat    pitch            1.0              # (0,inf)
  exposedField SFTime     startTime        0                # (-inf,inf)
  exposedField SFTime     stopTime         0                # (-inf,inf)
  exposedField MFString   url              []
  eventOut     SFTime     duration_changed
  eventOut     SFBool     isActive
)",
     nullptr, &kAudioClipBehaviour, UrlContent::sound},
    {"Script", "6.40", Role::child | Role::script, NodeKind::script, R"(
  exposedField MFString   url              []
  field        SFBool     directOutput     FALSE
  field        SFBool     mustEvaluate     FALSE
)",
     nullptr, &kScriptBehaviour},
    {"Sound", "6.42", Role::child, NodeKind::sound, R"(
  exposedField SFVec3f    direction        0 0 1            # (-inf,inf)
  exposedField SFFloat    intensity        1                # [0,1]
  exposedField SFVec3f    location         0 0 0            # (-inf,inf)
  exposedField SFFloat    maxBack          10               # [0,inf)
  exposedField SFFloat    maxFront         10               # [0,inf)
  exposedField SFFloat    minBack          1                # [0,inf)
  exposedField SFFloat    minFront         1                # [0,inf)
  exposedField SFFloat    priority         0                # [0,1]
  exposedField SFNode     source           NULL
  field        SFBool     spatialize       TRUE
)"},
    {"WorldInfo", "6.55", Role::child, NodeKind::world_info, R"(
  field        MFString   info             []
  field        SFString   title            ""
)"},
};

}  // namespace

std::span<const NodeRow> common_rows() { return kCommonRows; }

}  // namespace gs::vrml
