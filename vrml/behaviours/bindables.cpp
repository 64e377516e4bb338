#include "vrml/events/execution.h"
#include "vrml/scene/coordinates/geospatial.h"
#include "vrml/scene/values/transformation.h"

#include <algorithm>
#include <vector>

namespace gs::vrml {
namespace {

struct BindableEvents {
  enum : int { set_bind = kSetBind, is_bound, bind_time };
  enum : int { navigation_info = kFieldOfView + 1 };  // interface of Viewpoints
};

// Binds or unbinds the NavigationInfo in a field of a Viewpoint (X3D 23.3.1).
void bind_navigation(Execution& execution, EventNode viewpoint, bool bind) {
  EventNodes& nodes = execution.nodes();
  if (!nodes.has_event(viewpoint, BindableEvents::navigation_info)) return;
  const NodePlace at = nodes.place_of(viewpoint);
  const NodeId info = at.scene->resolve(execution.get<SFNode>(viewpoint, BindableEvents::navigation_info));
  const EventNode member = info ? execution.scenes().event_node(*at.scene, info) : 0;
  if (member == 0 || nodes.type_of(member).read_as != NodeKind::navigation_info) return;
  (void)nodes.behaviour_of(member).on_event(execution, member, kSetBind, FieldValue(bind));
}

void tell_bound(Execution& execution, EventNode node, bool bound) {
  // Each eventOut sends one event per timestamp (4.10.4). If the node is bound and unbound with the same timestamp, the
  // second event waits for the next timestamp.
  if (execution.has_sent(node, BindableEvents::is_bound)) {
    execution.timers().call_at(node, execution.now());
    return;
  }
  execution.send(node, BindableEvents::is_bound, SFBool{bound});
  // A Viewpoint sends bindTime when it is bound and when it is unbound (6.53).
  execution.send(node, BindableEvents::bind_time, SFTime{execution.now()});
}

// Handles set_bind (4.6.10): TRUE moves the node to the top of its stack, FALSE removes it from the stack. A node that
// becomes the top, or is no longer the top, sends isBound with the same timestamp. Sends nothing if the stack does not
// change.
bool set_bind(Execution& execution, EventNode node, int event, const FieldValue& value) {
  if (event != BindableEvents::set_bind) return true;
  BindableStacks& stacks = execution.stacks();
  const std::vector<BindableStacks::Change> changes = stacks.bind(node, std::get<SFBool>(value));
  if (changes.empty()) return false;
  const auto is_among = [&](EventNode one, std::size_t end, EventNode BindableStacks::Change::*side) {
    return std::any_of(changes.begin(), changes.begin() + static_cast<std::ptrdiff_t>(end),
                       [&](const auto& change) { return change.*side == one; });
  };
  // A node in several layers is bound while it is the top of one of its stacks.
  std::vector<EventNode> ended, begun;
  for (std::size_t i = 0; i < changes.size(); ++i) {
    const EventNode before = changes[i].before, after = changes[i].after;
    if (before != 0 && !stacks.is_bound(before) && !is_among(before, i, &BindableStacks::Change::before))
      ended.push_back(before);
    const bool elsewhere = std::any_of(stacks.all().begin(), stacks.all().end(), [&](const auto& stack) {
      return stack.top == after && std::none_of(changes.begin(), changes.end(), [&](const auto& change) {
               return change.layer == stack.layer && change.after == after;
             });
    });
    if (after != 0 && !elsewhere && !is_among(after, changes.size(), &BindableStacks::Change::before) &&
        !is_among(after, i, &BindableStacks::Change::after))
      begun.push_back(after);
  }
  for (const EventNode one : ended) tell_bound(execution, one, false);
  for (const EventNode one : begun) tell_bound(execution, one, true);
  for (const EventNode one : ended) bind_navigation(execution, one, false);
  for (const EventNode one : begun) bind_navigation(execution, one, true);
  const int active = stacks.active_layer();
  if (execution.nodes().behaviour_of(node).parent_from_local &&
      std::any_of(changes.begin(), changes.end(), [&](const auto& change) { return change.layer == active; }))
    execution.viewer().jump();
  return false;
}

void tell_late(Execution& execution, EventNode node) {
  const bool bound = execution.stacks().is_bound(node);
  if (execution.get<SFBool>(node, BindableEvents::is_bound) != bound) tell_bound(execution, node, bound);
}

// `Type` is one of the types of viewpoints, which have different slots.
template <class Type>
glm::dmat4 viewer_of(const SceneGraph&, const Node& node) {
  static const int position = node.type->find_field("position")->slot;
  static const int orientation = node.type->find_field("orientation")->slot;
  return viewer_matrix(std::get<SFVec3f>(node.values[position]), std::get<SFRotation>(node.values[orientation]));
}

}  // namespace

const Behaviour kViewpointBehaviour = {{"set_bind", "isBound", "bindTime", "fieldOfView", "navigationInfo"},
                                       nullptr,
                                       set_bind,
                                       tell_late,
                                       viewer_of<struct Perspective>};
const Behaviour kOrthoViewpointBehaviour = {{"set_bind", "isBound", "bindTime", "fieldOfView", "navigationInfo"},
                                            nullptr,
                                            set_bind,
                                            tell_late,
                                            viewer_of<struct Parallel>};
const Behaviour kGeoViewpointBehaviour = {
    {"set_bind", "isBound", "bindTime", "fieldOfView", "navigationInfo"}, nullptr, set_bind, tell_late,
    geo_viewpoint_matrix};
const Behaviour kNavigationInfoBehaviour = {
    {"set_bind", "isBound", "bindTime", "transitionComplete"}, nullptr, set_bind, tell_late};
const Behaviour kBindableBehaviour = {{"set_bind", "isBound", "bindTime"}, nullptr, set_bind, tell_late};

}  // namespace gs::vrml
