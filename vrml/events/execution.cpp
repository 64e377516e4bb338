#include "vrml/events/execution.h"

#include "vrml/events/states.h"
#include "vrml/scene/transformation.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

namespace gs::vrml {
namespace {

// Limit of work elements per timestamp: about 4 million deliveries, some tenths of a second.
constexpr std::size_t kMostWork = std::size_t{1} << 26;
constexpr std::size_t kFewAlarms = 1024;
constexpr int kLastChangeBit = 63;

}  // namespace

Execution::~Execution() = default;

// ---- Values, and services for behaviours

FieldValue& Execution::stored(const Member& at, const EventSchema::Interface& interface) {
  return interface.out >= 0 ? out_values_[at.first_out + static_cast<std::uint32_t>(interface.out)]
                            : at.node->values[interface.slot];
}

const FieldValue& Execution::value_of(EventNode node, int event) const {
  const Member& at = nodes_[node];
  const EventSchema::Interface& interface = at.schema->interfaces[at.schema->events[static_cast<std::size_t>(event)]];
  return interface.out >= 0 ? out_values_[at.first_out + static_cast<std::uint32_t>(interface.out)]
                            : at.node->values[interface.slot];
}

bool Execution::has_event(EventNode node, int event) const {
  return nodes_[node].schema->events[static_cast<std::size_t>(event)] != EventSchema::kNone;
}

bool Execution::has_sent(EventNode node, int event) const {
  const Member& at = nodes_[node];
  return slots_[at.first_slot + at.schema->events[static_cast<std::size_t>(event)]].sent == stamp_;
}

FieldValue* Execution::place_to_send(EventNode node, int event) {
  const Member& at = nodes_[node];
  const std::uint32_t place = at.schema->events[static_cast<std::size_t>(event)];
  if (place == EventSchema::kNone) return nullptr;
  const EventSchema::Interface& interface = at.schema->interfaces[place];
  // The value of an exposedField changes even if the event cannot be sent.
  if (interface.out >= 0 && slots_[at.first_slot + place].sent == stamp_) return nullptr;
  if (interface.out < 0) mark_changed(node, interface.slot);
  if (interface.out >= 0 && holds_nodes(interface.declaration->type)) note_referring(node);
  queue(node, place);
  return &stored(at, interface);
}

NodeChange& Execution::change_of(EventNode node) {
  Member& at = nodes_[node];
  if (at.change == 0) {
    changes_.push_back({at.scene, at.id, 0});
    changed_.push_back(node);
    at.change = static_cast<std::uint32_t>(changes_.size());
  }
  return changes_[at.change - 1];
}

void Execution::mark_changed(EventNode node, std::int32_t slot) {
  Member& at = nodes_[node];
  if (std::holds_alternative<MFNode>(at.node->values[slot])) placement_.forget();
  if (holds_nodes(vrml::type_of(at.node->values[slot]))) note_referring(node);
  change_of(node).slots |= std::uint64_t{1} << std::min(slot, kLastChangeBit);
}

std::span<const NodeChange> Execution::take_changes() {
  for (const EventNode node : changed_) nodes_[node].change = 0;
  changed_.clear();
  std::swap(changes_, taken_changes_);
  changes_.clear();
  return taken_changes_;
}

bool Execution::has_room_for(std::size_t elements) const {
  return elements < kMostWork && work_ + elements <= kMostWork;
}

bool Execution::spend(std::size_t elements) {
  if (has_room_for(elements)) {
    work_ += elements;
    return true;
  }
  if (problem_.empty()) problem_ = "the events of one timestamp exceed the limit of work; the rest is left out";
  return false;
}

bool Execution::afford(std::size_t bytes) {
  constexpr std::size_t kStep = std::size_t{64} << 10;  // bytes drawn at a time
  if (afforded_ + bytes > share_.amount() && !share_.grow(std::max(bytes, kStep)) && !share_.grow(bytes)) {
    if (problem_.empty()) problem_ = "events take " + root_.budget()->refusal(Resource::nodes);
    return false;
  }
  afforded_ += bytes;
  return true;
}

bool Execution::afford_most(EventNode node, std::size_t bytes) {
  Member& at = nodes_[node];
  if (bytes <= at.most) return true;
  if (!afford(bytes - at.most)) return false;
  at.most = bytes;
  return true;
}

void Execution::run(EventNode node, bool running) {
  Member& at = nodes_[node];
  at.running = running;
  if (running && !std::exchange(at.listed, true)) running_.push_back(node);
}

void Execution::look_again(EventNode node) {
  if (!std::exchange(nodes_[node].looking, true)) looking_.push_back(node);
}

void Execution::call_at(EventNode node, double time) {
  if (std::isnan(time)) return;
  if (alarms_.size() > kFewAlarms && alarms_.size() > 2 * live_alarms_) {
    std::erase_if(alarms_, [&](const Alarm& alarm) { return nodes_[alarm.node].alarm != alarm.number; });
    std::make_heap(alarms_.begin(), alarms_.end(), std::greater<>());
  }
  live_alarms_ += nodes_[node].alarm == 0 ? 1 : 0;
  if (++alarm_number_ == 0) ++alarm_number_;
  nodes_[node].alarm = alarm_number_;
  alarms_.push_back({time, node, alarm_number_});
  std::push_heap(alarms_.begin(), alarms_.end(), std::greater<>());
}

std::optional<double> Execution::next_time() const {
  for (const EventNode node : running_)
    if (nodes_[node].running) return now_;
  if (pointing_->waits() || next_world_ || (started_ && !new_scripts_.empty())) return now_;
  return alarms_.empty() ? std::nullopt : std::optional<double>(alarms_.front().time);
}

// ---- Bindable nodes (4.6.10): one stack per type, as a linked list of nodes, so that any node can leave in O(1).

Execution::Stack& Execution::stack_of(const NodeType& type) {
  for (Stack& stack : stacks_)
    if (stack.type == &type) return stack;
  return stacks_.emplace_back(Stack{&type});
}

EventNode Execution::top_of(const NodeType& type) const {
  for (const Stack& stack : stacks_)
    if (stack.type == &type) return stack.top;
  return 0;
}

NodeChange Execution::bound(const NodeType& type) const {
  const EventNode top = top_of(type);
  return top == 0 ? NodeChange{} : NodeChange{nodes_[top].scene, nodes_[top].id, 0};
}

bool Execution::is_on_stack(const SceneGraph* scene, NodeId node) const {
  const auto place = scene_places_.find(scene);
  if (place == scene_places_.end() || !scene->contains(node)) return false;
  const std::vector<EventNode>& members = scenes_[place->second].members;
  const EventNode member = node.index < members.size() ? members[node.index] : 0;
  return member != 0 && nodes_[member].on_stack;
}

void Execution::bind(EventNode node, bool to_top) {
  Stack& stack = stack_of(type_of(node));
  Member& at = nodes_[node];
  if (at.on_stack) {
    if (at.bound_above != 0) nodes_[at.bound_above].bound_below = at.bound_below;
    if (at.bound_below != 0) nodes_[at.bound_below].bound_above = at.bound_above;
    if (stack.top == node) stack.top = at.bound_below;
  }
  if (!at.on_stack || !to_top) at.placed = false;
  at.on_stack = to_top;
  at.bound_above = 0;
  at.bound_below = to_top ? stack.top : 0;
  if (!to_top) return;
  if (stack.top != 0) nodes_[stack.top].bound_above = node;
  stack.top = node;
}

// Returns all nodes on stacks, lower ones first.
std::vector<EventNode> Execution::bindables_on_stacks() {
  std::vector<EventNode> nodes;
  for (const Stack& stack : stacks_)
    for (EventNode node = stack.top; node != 0 && spend(kDelivery); node = nodes_[node].bound_below)
      nodes.push_back(node);
  std::reverse(nodes.begin(), nodes.end());
  for (const EventNode node : nodes) placement_.look_for(*nodes_[node].scene, nodes_[node].id);
  return nodes;
}

void Execution::nodes_leave() {
  if (nodes_leave_ || !spend(placement_.visits())) return;
  nodes_leave_ = true;
  // A bound node that was never in the hierarchy cannot leave it.
  for (const EventNode node : bindables_on_stacks())
    if (!nodes_[node].placed) nodes_[node].placed = !places_of(node).empty();
}

// Unbinds bound nodes that left the hierarchy, as with set_bind FALSE (4.6.10).
void Execution::unbind_what_left() {
  if (!std::exchange(nodes_leave_, false)) return;
  for (const EventNode node : bindables_on_stacks())
    if (nodes_[node].placed && places_of(node).empty() && placement_.whole())
      (void)type_of(node).behaviour->on_event(*this, node, kSetBind, FieldValue(false));
}

void Execution::viewer_jumped() {
  ++jumps_;
  jump_ahead_ = told_viewer_.has_value();
  for (const EventNode node : running_)
    if (nodes_[node].running) look_again(node);
}

glm::dmat4 Execution::viewer() {
  if (told_viewer_) return *told_viewer_;
  for (const Stack& stack : stacks_) {
    if (stack.top == 0 || !stack.type->behaviour->parent_from_local) continue;
    glm::dmat4 matrix = stack.type->behaviour->parent_from_local(node_of(stack.top));
    // A Billboard above the Viewpoint would face itself; it counts as unrotated.
    const Member& top = nodes_[stack.top];
    if (const auto places = placement_.places_of(*top.scene, top.id); !places.empty()) matrix = places.front() * matrix;
    return matrix;
  }
  return viewer_matrix({0, 0, 10}, {});
}

std::span<const glm::dmat4> Execution::places_of(EventNode node) {
  const Member& at = nodes_[node];
  const std::span<const glm::dmat4> unturned = placement_.places_of(*at.scene, at.id);
  if (!placement_.below_billboard()) return unturned;
  const glm::dmat4 from = viewer();
  return placement_.places_of(*at.scene, at.id, from);
}

Frustum Execution::frustum() const {
  if (told_viewer_ && told_frustum_) return *told_frustum_;
  constexpr double kDefault = 0.785398, kWidest = 3.13;
  double angle = kDefault;
  for (const Stack& stack : stacks_)
    if (stack.top != 0 && stack.type->behaviour->parent_from_local && has_event(stack.top, kFieldOfView))
      angle = get<SFFloat>(stack.top, kFieldOfView);
  const double smaller = std::tan((angle > 0 ? std::min(angle, kWidest) : kDefault) / 2);
  const double aspect = aspect_ > 0 && std::isfinite(aspect_) ? aspect_ : 1;
  return aspect >= 1 ? Frustum{smaller * aspect, smaller} : Frustum{smaller, smaller / aspect};
}

EventNode Execution::event_node(const SceneGraph& scene, NodeId node) {
  const auto place = scene_places_.find(&scene);
  return place == scene_places_.end() || !scene.contains(node) ? 0 : member(scenes_[place->second], node);
}

// ---- Actions of the user

void Execution::point(const Pointer& pointer) {
  pointing_->point(pointer);
  drain();
}

void Execution::request(EventNode anchor) {
  if (requests_.size() >= kMostRequests) requests_.erase(requests_.begin());
  requests_.push_back(place_of(anchor));
}

bool Execution::collide(std::span<const PathStep> path) {
  for (const bool met : {false, true}) {
    for (const PathStep& step : path) {
      const bool known = step.scene && step.scene->contains(step.node);
      const Behaviour* behaviour = known ? step.scene->node(step.node).type->behaviour : nullptr;
      if (!behaviour || !behaviour->on_collision) continue;
      const EventNode node = event_node(*step.scene, step.node);
      if (node != 0 && !behaviour->on_collision(*this, node, met)) return false;
    }
  }
  drain();
  return true;
}

// ---- Actions of the browser

bool Execution::progress(const SceneGraph& scene, NodeId id, double fraction) {
  constexpr float kLeast = 0.00999f;  // 1/100, with a margin for rounding
  if (std::isnan(fraction) || !scene.contains(id)) return true;
  const NodeType& type = *scene.node(id).type;
  const InterfaceDeclaration* progress = type.find("progress_changed");
  const InterfaceDeclaration* load_time = type.find("loadTime");
  const auto is = [](const InterfaceDeclaration* event, FieldType of) {
    return event && event->access == AccessType::eventOut && event->type == of;
  };
  const bool tells = is(progress, FieldType::SFFloat), tells_time = is(load_time, FieldType::SFTime);
  const EventNode node = tells || tells_time ? event_node(scene, id) : 0;
  if (node == 0) return true;
  Member& at = nodes_[node];
  const auto value = static_cast<float>(std::clamp(fraction, 0.0, 1.0));
  const auto unsent = [&](std::uint32_t place) { return slots_[at.first_slot + place].sent != stamp_; };
  bool all = true;
  if (tells) {
    const std::uint32_t place = at.schema->find(*progress);
    auto& last = std::get<SFFloat>(stored(at, at.schema->interfaces[place]));
    if (std::abs(value - last) >= kLeast || (value == 1 && last != 1)) {
      if (unsent(place)) {
        last = value;
        queue(node, place);
      } else {
        all = false;
      }
    }
  }
  if (value == 0) at.state = 0;
  if (tells_time && value == 1 && at.state == 0) {
    const std::uint32_t place = at.schema->find(*load_time);
    if (all && unsent(place)) {
      std::get<SFTime>(stored(at, at.schema->interfaces[place])) = now_;
      at.state = 1;
      queue(node, place);
    } else {
      all = false;
    }
  }
  drain();
  return all;
}

}  // namespace gs::vrml
