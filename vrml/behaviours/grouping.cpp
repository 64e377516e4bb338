#include "vrml/behaviours/grouping.h"

#include "vrml/events/execution.h"
#include "vrml/events/pointing.h"
#include "vrml/scene/coordinates/geospatial.h"
#include "vrml/scene/values/transformation.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <unordered_set>
#include <utility>

namespace gs::vrml {
namespace {

struct GroupingEvents {
  enum : int { add_children, remove_children, children };
  enum : int { description = children + 1 };                       // interfaces of Anchor
  enum : int { collide = children + 1, collide_time, is_active };  // interfaces of Collision
  enum : int { level_changed = children + 1, center, range };      // interfaces of LOD
};

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
  if (execution.nodes().state_of(node) == kTold || !execution.routes().is_listened_to(node, kChildrenChanged)) return;
  FieldValue value;
  (void)content_of(execution, node, value);
  if (std::get<MFNode>(value).empty()) return;
  if (execution.has_sent(node, kChildrenChanged)) return execution.timers().call_at(node, execution.now());
  execution.nodes().state_of(node) = kTold;
  execution.send(node, kChildrenChanged, std::get<MFNode>(std::move(value)));
}

// State of a Collision of X3D: isActive is TRUE from the first collision to the first step without one.
enum : std::uint32_t { kApart = 0, kTouching, kMet };

bool collision_of(Execution& execution, EventNode node, Meeting met) {
  if (!execution.get<SFBool>(node, GroupingEvents::collide)) return false;
  if (met == Meeting::none) return true;
  if (met == Meeting::begins) execution.send(node, GroupingEvents::collide_time, SFTime{execution.now()});
  if (!execution.nodes().has_event(node, GroupingEvents::is_active)) return true;
  if (std::exchange(execution.nodes().state_of(node), kMet) != kApart) return true;
  execution.send(node, GroupingEvents::is_active, SFBool{true});
  execution.timers().run(node, true);
  return true;
}

void collision_time(Execution& execution, EventNode node) {
  std::uint32_t& state = execution.nodes().state_of(node);
  if (state == kMet) {
    state = kTouching;
  } else if (state == kTouching && !execution.has_sent(node, GroupingEvents::is_active)) {
    state = kApart;
    execution.send(node, GroupingEvents::is_active, SFBool{false});
    execution.timers().run(node, false);
  }
}

// Returns the displayed level of a LOD (6.26) at its first instance; -1 if it has no levels.
int level_of(Execution& execution, EventNode node) {
  const std::size_t levels = execution.get<MFNode>(node, GroupingEvents::children).size();
  const MFFloat& ranges = execution.get<MFFloat>(node, GroupingEvents::range);
  if (levels == 0) return -1;
  const glm::dvec3 viewer(execution.viewer().pose()[3]);
  const auto places = execution.viewer().places_of(node);
  if (places.empty()) return 0;
  const double distance = glm::length(viewer_in_local(viewer, places.front()) -
                                      glm::dvec3(execution.get<SFVec3f>(node, GroupingEvents::center)));
  std::size_t level = 0;
  while (level < ranges.size() && level + 1 < levels && distance >= ranges[level]) ++level;
  return static_cast<int>(level);
}

// Sends level_changed of a LOD of X3D while another node listens.
void lod_time(Execution& execution, EventNode node) {
  const bool listened = execution.routes().is_listened_to(node, GroupingEvents::level_changed);
  execution.timers().run(node, listened);
  if (!listened || !execution.budget().spend(EventBudget::kDelivery)) return;
  const int level = level_of(execution, node);
  std::uint32_t& told = execution.nodes().state_of(node);  // 1 + the level that was sent last; 0 means none
  if (level < 0 || told == static_cast<std::uint32_t>(level) + 1) return;
  if (execution.has_sent(node, GroupingEvents::level_changed)) return;
  told = static_cast<std::uint32_t>(level) + 1;
  execution.send(node, GroupingEvents::level_changed, SFInt32{level});
}

// Handles a change of activeLayer: the user now navigates in another layer, from the Viewpoint of that layer.
bool change_active_layer(Execution& execution, EventNode, int, const FieldValue&) {
  execution.viewer().jump();
  return true;
}

}  // namespace

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

glm::dmat4 transform_of(const SceneGraph&, const Node& node) {
  thread_local TransformSlots slots(*node.type);
  if (slots.of != node.type) slots = TransformSlots(*node.type);
  return transform_matrix(
      std::get<SFVec3f>(node.values[slots.translation]), std::get<SFVec3f>(node.values[slots.center]),
      std::get<SFRotation>(node.values[slots.rotation]), std::get<SFVec3f>(node.values[slots.scale]),
      std::get<SFRotation>(node.values[slots.scale_orientation]));
}

const Behaviour kTransformBehaviour = {
    {"addChildren", "removeChildren", "children"}, nullptr, change_children, nullptr, transform_of};
const Behaviour kGeoLocationBehaviour = {
    {"addChildren", "removeChildren", "children"}, nullptr, change_children, nullptr, geo_location_matrix};
const Behaviour kGeoTransformBehaviour = {
    {"addChildren", "removeChildren", "children"}, nullptr, change_children, nullptr, geo_transform_matrix};
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
    .events = {"addChildren", "removeChildren", "children", "collide", "collideTime", "isActive"},
    .on_event = change_children,
    .on_time = collision_time,
    .on_collision = collision_of,
};
const Behaviour kInlineBehaviour = {
    .events = {"children_changed"},
    .on_time = tell_content,
    .unsent_value = content_of,
    .watches_routes = true,
};
const Behaviour kSwitchBehaviour = {.events = {"addChildren", "removeChildren", "choice"}, .on_event = change_children};
const Behaviour kLodBehaviour = {
    .events = {"addChildren", "removeChildren", "level", "level_changed", "center", "range"},
    .on_event = change_children,
    .on_time = lod_time,
    .watches_routes = true,
};
const Behaviour kLayerSetBehaviour = {{"activeLayer"}, nullptr, change_active_layer, nullptr};
const Behaviour kGroupBehaviour = {{"addChildren", "removeChildren", "children"}, nullptr, change_children, nullptr};

}  // namespace gs::vrml
