#include "vrml/events/world_browser.h"

#include "base/finite.h"
#include "vrml/events/execution.h"

#include <algorithm>
#include <cmath>

namespace gs::vrml {
namespace {

constexpr std::string_view kKindNames[] = {"mousedown", "mousemove", "mouseout", "mouseover", "mouseup",
                                           "keydown",   "keyup",     "keypress", "click",     "dblclick"};

SFRotation rotation_of(const glm::dmat4& world_from_viewer) {
  const glm::dquat q = glm::normalize(glm::quat_cast(glm::dmat3(world_from_viewer)));
  const glm::dvec3 axis(q.x, q.y, q.z);
  const double size = glm::length(axis);
  if (!(size > 0)) return {0, 0, 1, 0};
  return {static_cast<float>(axis.x / size), static_cast<float>(axis.y / size), static_cast<float>(axis.z / size),
          static_cast<float>(2 * std::atan2(size, q.w))};
}

// Sets fields of the event node without events, because its receiver reads them only after event_changed.
class EventFields {
 public:
  EventFields(SceneGraph& scene, NodeId event) : node_(scene.node(event)) {}
  template <class T>
  void set(std::string_view name, T value) {
    node_.values[node_.type->find_field(name)->slot] = std::move(value);
  }

 private:
  Node& node_;
};

}  // namespace

// ---- Requests

void WorldBrowser::move_viewer(const std::optional<glm::dvec3>& position,
                               const std::optional<glm::dquat>& orientation) {
  if (position && finite(*position)) wanted_position_ = *position;
  if (!orientation) return;
  const double length = glm::length(*orientation);
  if (length > 0 && std::isfinite(length)) wanted_orientation_ = *orientation / length;
}

glm::dmat4 WorldBrowser::pose() {
  glm::dmat4 pose = execution_.viewer().pose();
  if (wanted_orientation_) {
    const glm::dvec4 position = pose[3];
    pose = glm::mat4_cast(*wanted_orientation_);
    pose[3] = position;
  }
  if (wanted_position_) pose[3] = glm::dvec4(*wanted_position_, 1);
  return pose;
}

std::optional<glm::dmat4> WorldBrowser::take_move() {
  if (!wanted_position_ && !wanted_orientation_) return std::nullopt;
  const glm::dmat4 moved = pose();
  wanted_position_.reset();
  wanted_orientation_.reset();
  return moved;
}

void WorldBrowser::choose_mode(std::string_view mode) {
  constexpr std::size_t kMaxName = 32;
  wanted_mode_ = std::string(mode.substr(0, kMaxName));
}

std::optional<RayHit> WorldBrowser::cast_ray(const glm::dvec3& from, const glm::dvec3& to,
                                             const NodePlace& below) const {
  if (!caster_ || !finite(from) || !finite(to) || from == to) return std::nullopt;
  return caster_(from, to, below);
}

// ---- The browser as a node

// Returns the node of this type that was made for a scene. Makes it if it does not exist. Removed nodes are made again.
NodeId WorldBrowser::kept_node(std::unordered_map<std::uint64_t, NodeId>& nodes, SceneGraph& scene,
                               const NodeType& type) {
  NodeId& kept = nodes[scene.serial()];
  if (!kept || !scene.contains(kept)) {
    kept = scene.create(type);
    if (kept) scene.node(kept).name = *scene.texts().keep_name(type.name);
  }
  if (!kept) nodes.erase(scene.serial());
  return kept;
}

NodeId WorldBrowser::node_in(SceneGraph& scene) { return kept_node(scene_nodes_, scene, browser_node_type()); }

NodeId WorldBrowser::event_node_in(SceneGraph& scene) { return kept_node(event_nodes_, scene, browser_event_type()); }

void WorldBrowser::add(EventNode node) {
  nodes_.push_back(node);
  execution_.nodes().state_of(node) = static_cast<std::uint32_t>(nodes_.size());  // 1 + index in nodes_
}

void WorldBrowser::remove(EventNode node) {
  const std::uint32_t place = std::exchange(execution_.nodes().state_of(node), 0);
  if (place == 0) return;
  nodes_[place - 1] = nodes_.back();
  execution_.nodes().state_of(nodes_[place - 1]) = place;
  nodes_.pop_back();
  execution_.nodes().state_of(node) = 0;
}

void WorldBrowser::send_changes() {
  input_sent_ = false;
  if (nodes_.empty()) return;
  const glm::dmat4 viewer = execution_.viewer().pose();
  const SFVec3f position(viewer[3]);
  const SFRotation orientation = rotation_of(viewer);
  const auto aspect = static_cast<float>(view_.size.y > 0 ? view_.size.x / view_.size.y : 0);
  const auto send = [&](EventNode node, int event, const auto& value) {
    using T = std::decay_t<decltype(value)>;
    if (execution_.routes().is_listened_to(node, event) && !(execution_.get<T>(node, event) == value))
      execution_.send(node, event, T(value));
  };
  for (const EventNode node : nodes_) {
    if (!execution_.budget().spend(EventBudget::kDelivery)) return;
    send(node, BrowserEvents::position, position);
    send(node, BrowserEvents::orientation, orientation);
    if (aspect <= 0) continue;
    send(node, BrowserEvents::window_size, SFVec2f(view_.size));
    send(node, BrowserEvents::window_aspect, SFFloat{aspect});
  }
}

// Without a mask, nodes receive keys and clicks.
bool WorldBrowser::wants(BrowserInputKind kind) const {
  if (nodes_.empty()) return false;
  const auto bit = static_cast<unsigned>(kind);
  if (event_mask_) return (static_cast<std::uint32_t>(*event_mask_) >> bit & 1) != 0;
  return kind != BrowserInputKind::mousemove && kind != BrowserInputKind::mouseover &&
         kind != BrowserInputKind::mouseout;
}

bool WorldBrowser::send_input(const BrowserInput& input) {
  if (input.key > 0 && input.key < kKeys) pressed_[input.key] = input.kind != BrowserInputKind::keyup;
  if (!wants(input.kind)) return false;
  std::vector<std::pair<SceneGraph*, NodeId>> events;
  for (const EventNode node : nodes_) {
    if (!execution_.routes().is_listened_to(node, BrowserEvents::event_changed)) continue;
    SceneGraph& scene = *execution_.nodes()[node].scene;
    if (events.empty()) execution_.cascade().begin_update();
    if (!execution_.budget().spend(EventBudget::kDelivery)) break;
    const NodeId event = event_node_in(scene);
    if (!event) continue;
    EventFields fields(scene, event);
    fields.set("type", SFString(std::string(kKindNames[static_cast<std::size_t>(input.kind)])));
    fields.set("keyCode", SFInt32{input.key});
    fields.set("button", SFInt32{input.button});
    fields.set("altKey", SFBool{input.alt});
    fields.set("ctrlKey", SFBool{input.control});
    fields.set("shiftKey", SFBool{input.shift});
    fields.set("client", SFVec2f(input.client));
    fields.set("screen", SFVec2f(input.client));
    const glm::dvec2 size = glm::max(view_.size, glm::dvec2(1));
    fields.set("position", SFVec2f(glm::dvec2(input.client) / size));
    fields.set("cancelBubble", SFBool{false});
    fields.set("returnValue", SFBool{true});
    execution_.send(node, BrowserEvents::event_changed, SFNode(event));
    events.emplace_back(&scene, event);
  }
  if (events.empty()) return false;
  input_sent_ = true;
  execution_.cascade().drain();
  return std::any_of(events.begin(), events.end(), [&](const auto& one) {
    const auto& [scene, event] = one;
    return execution_.scenes().has(scene) && scene->contains(event) &&
           !scene->template get<SFBool>(event, "returnValue");
  });
}

}  // namespace gs::vrml
