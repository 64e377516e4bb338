#include "vrml/events/execution.h"
#include "vrml/scene/coordinates/geospatial.h"
#include "vrml/scene/values/transformation.h"

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
  const NodeType& type = execution.nodes().type_of(node);
  const int layer = execution.stacks().layer_of(node);
  const EventNode before = execution.stacks().top_of(type, layer);
  const bool to_top = std::get<SFBool>(value);
  if (to_top && before == node) return false;
  execution.stacks().bind(node, to_top);
  const EventNode after = execution.stacks().top_of(type, layer);
  if (before == after) return false;
  if (before != 0) tell_bound(execution, before, false);
  if (after != 0) tell_bound(execution, after, true);
  if (before != 0) bind_navigation(execution, before, false);
  if (after != 0) bind_navigation(execution, after, true);
  if (type.behaviour->parent_from_local && layer == execution.stacks().active_layer()) execution.viewer().jump();
  return false;
}

void tell_late(Execution& execution, EventNode node) {
  const BindableStacks& stacks = execution.stacks();
  const bool bound = stacks.top_of(execution.nodes().type_of(node), stacks.layer_of(node)) == node;
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
    {"set_bind", "isBound", "bindTime", "fieldOfView"}, nullptr, set_bind, tell_late, geo_viewpoint_matrix};
const Behaviour kNavigationInfoBehaviour = {
    {"set_bind", "isBound", "bindTime", "transitionComplete"}, nullptr, set_bind, tell_late};
const Behaviour kBindableBehaviour = {{"set_bind", "isBound", "bindTime"}, nullptr, set_bind, tell_late};

}  // namespace gs::vrml
