#include "vrml/events/execution.h"
#include "vrml/events/pointing.h"
#include "vrml/scene/transformation.h"

#include <cstdint>
#include <unordered_set>
#include <utility>

namespace gs::vrml {
namespace {

struct GroupingEvents {
  enum : int { add_children, remove_children, children };
  enum : int { description = children + 1 };            // interfaces of Anchor
  enum : int { collide = children + 1, collide_time };  // interfaces of Collision
};

// Handles addChildren and removeChildren (4.6.5). Does not add a child that the node has, and ignores removed children
// that it does not have.
bool change_children(Execution& execution, EventNode node, int event, const FieldValue& value) {
  if (event >= GroupingEvents::children) return true;
  const MFNode given = std::get<MFNode>(value);
  const MFNode old = execution.get<MFNode>(node, GroupingEvents::children);
  if (given.empty() || !execution.budget().spend(old.size() + given.size())) return false;
  const bool add = event == GroupingEvents::add_children;
  std::unordered_set<std::uint32_t> named;
  for (const NodeId child : add ? old : given) named.insert(child.index);
  MFNode made;
  if (add) {
    made = old;
    for (const NodeId child : given)
      if (child && named.insert(child.index).second) made.push_back(child);
  } else {
    for (const NodeId child : old)
      if (!named.contains(child.index)) made.push_back(child);
  }
  if (made.size() == old.size()) return false;
  if (!add) execution.stacks().nodes_leave();
  if (add && !execution.nodes().afford_most(node, made.size() * sizeof(NodeId))) return false;
  execution.send(node, GroupingEvents::children, std::move(made));
  return false;
}

/// Slots of the fields of a node type that is read as a Transform.
struct TransformSlots {
  explicit TransformSlots(const NodeType& type) : of(&type) {
    const auto slot = [&](std::string_view name) { return type.find_field(name)->slot; };
    translation = slot("translation"), center = slot("center"), rotation = slot("rotation");
    scale = slot("scale"), scale_orientation = slot("scaleOrientation");
  }
  const NodeType* of;
  int translation, center, rotation, scale, scale_orientation;
};

glm::dmat4 transform_of(const Node& node) {
  thread_local TransformSlots slots(*node.type);
  if (slots.of != node.type) slots = TransformSlots(*node.type);
  return transform_matrix(
      std::get<SFVec3f>(node.values[slots.translation]), std::get<SFVec3f>(node.values[slots.center]),
      std::get<SFRotation>(node.values[slots.rotation]), std::get<SFVec3f>(node.values[slots.scale]),
      std::get<SFRotation>(node.values[slots.scale_orientation]));
}

glm::dmat4 billboard_of(const Node& node, const glm::dvec3& viewer, const glm::dvec3& up) {
  static const int axis = node.type->find_field("axisOfRotation")->slot;
  return billboard_matrix(std::get<SFVec3f>(node.values[axis]), viewer, up);
}

// A click on a descendant of an Anchor activates the Anchor (6.2).
constexpr PointingSensor kAnchorSensor = {
    .description = GroupingEvents::description,
    .of_children = true,
    .release =
        [](Execution& execution, EventNode node, bool over) {
          if (over) execution.pointing().request(node);
        },
};

// Writes the value of children_changed of an Inline. Nodes of the content belong to another scene, so the value is the
// Inline itself, which stands for them.
bool content_of(Execution& execution, EventNode node, FieldValue& value) {
  const NodePlace at = execution.nodes().place_of(node);
  MFNode content;
  if (at.scene->inlines().of(at.node)) content.push_back(at.node);
  value = std::move(content);
  return true;
}

// Sends children_changed once for each content that was loaded, as soon as another node listens.
void tell_content(Execution& execution, EventNode node) {
  constexpr int kChildrenChanged = 0;
  constexpr std::uint32_t kTold = 1;
  if (execution.nodes().state_of(node) == kTold || !execution.is_listened_to(node, kChildrenChanged)) return;
  FieldValue value;
  (void)content_of(execution, node, value);
  if (std::get<MFNode>(value).empty()) return;
  if (execution.has_sent(node, kChildrenChanged)) return execution.timers().call_at(node, execution.now());
  execution.nodes().state_of(node) = kTold;
  execution.send(node, kChildrenChanged, std::get<MFNode>(std::move(value)));
}

bool collision_of(Execution& execution, EventNode node, bool met) {
  if (!execution.get<SFBool>(node, GroupingEvents::collide)) return false;
  if (met) execution.send(node, GroupingEvents::collide_time, SFTime{execution.now()});
  return true;
}

}  // namespace

const Behaviour kTransformBehaviour = {
    {"addChildren", "removeChildren", "children"}, nullptr, change_children, nullptr, transform_of};
const Behaviour kBillboardBehaviour = {
    .events = {"addChildren", "removeChildren", "children"},
    .on_event = change_children,
    .parent_from_facing = billboard_of,
};
const Behaviour kAnchorBehaviour = {
    .events = {"addChildren", "removeChildren", "children", "description"},
    .on_event = change_children,
    .pointing = &kAnchorSensor,
};
const Behaviour kCollisionBehaviour = {
    .events = {"addChildren", "removeChildren", "children", "collide", "collideTime"},
    .on_event = change_children,
    .on_collision = collision_of,
};
const Behaviour kInlineBehaviour = {
    .events = {"children_changed"},
    .on_time = tell_content,
    .unsent_value = content_of,
    .watches_routes = true,
};
const Behaviour kGroupBehaviour = {{"addChildren", "removeChildren", "children"}, nullptr, change_children, nullptr};

}  // namespace gs::vrml
