#include "vrml/events/execution.h"
#include "vrml/scene/values/transformation.h"

namespace gs::vrml {
namespace {

// Handles events for the browser as a node. They have the same effect as assignments of a program. Nobody can set the
// size of the window.
bool browser_event(Execution& execution, EventNode, int event, const FieldValue& value) {
  switch (event) {
    case BrowserEvents::event_mask:
      execution.browser().set_event_mask(std::get<SFInt32>(value));
      return true;
    case BrowserEvents::position:
      execution.browser().move_viewer(glm::dvec3(std::get<SFVec3f>(value)), std::nullopt);
      return true;
    case BrowserEvents::orientation:
      execution.browser().move_viewer(std::nullopt, glm::quat_cast(rotation_matrix(std::get<SFRotation>(value))));
      return true;
    default:
      return false;
  }
}

}  // namespace

const Behaviour kBrowserBehaviour = {
    .events = {"eventMask", "event_changed", "viewpointPosition", "viewpointOrientation", "windowSize", "windowAspect"},
    .initialize = [](Execution& execution, EventNode node) { execution.browser().add(node); },
    .on_event = browser_event,
    .on_remove = [](Execution& execution, EventNode node) { execution.browser().remove(node); },
};

}  // namespace gs::vrml
