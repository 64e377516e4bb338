#include "vrml/event_model/behaviour.h"
#include "vrml/nodes/families.h"

namespace gs::vrml {
namespace {

constexpr std::string_view kContactClause = "Contact";

// Rows of the browser as a node, and of its events. Worlds for Contact use the browser in ROUTEs and addRoute. The last
// row is imported_use_type().
constexpr NodeRow kBrowserRows[] = {
    {"Browser", kContactClause, Role::none, NodeKind::other, R"(
  exposedField SFInt32    eventMask           0
  eventOut     SFNode     event_changed
  exposedField SFVec3f    viewpointPosition   0 0 10
  exposedField SFRotation viewpointOrientation 0 0 1 0
  exposedField SFVec2f    windowSize          0 0
  exposedField SFFloat    windowAspect        0
)",
     nullptr, &kBrowserBehaviour},
    {"Event", kContactClause, Role::none, NodeKind::other, R"(
  exposedField SFString   type         ""
  exposedField SFInt32    keyCode      0
  exposedField SFInt32    button       0
  exposedField SFBool     altKey       FALSE
  exposedField SFBool     ctrlKey      FALSE
  exposedField SFBool     shiftKey     FALSE
  exposedField SFVec2f    client       0 0
  exposedField SFVec2f    screen       0 0
  exposedField SFVec2f    position     0 0
  exposedField SFBool     cancelBubble FALSE
  exposedField SFBool     returnValue  TRUE
)"},
    {"ImportedNode", kContactClause, Role::child, NodeKind::other, R"(
  field        SFString   name         ""
)"},
};

}  // namespace

std::span<const NodeRow> browser_rows() { return kBrowserRows; }

}  // namespace gs::vrml
