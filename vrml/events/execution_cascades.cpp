#include "vrml/events/execution.h"
#include "vrml/events/states.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

// Event cascades (VRML97 4.10.3, 4.10.4): advances time and delivers events.
namespace gs::vrml {

void Execution::begin(double now) {
  if (!(now > now_)) return;  // timestamps never decrease (4.11)
  previous_ = now_;
  now_ = now;
  ++stamp_;
  work_ = 0;
}

void Execution::begin_update() {
  now_ = std::nextafter(now_, std::numeric_limits<double>::infinity());
  ++stamp_;
  work_ = 0;
}

void Execution::step(double now) {
  begin(now);
  while (!alarms_.empty() && alarms_.front().time <= now_) {
    const Alarm alarm = alarms_.front();
    std::pop_heap(alarms_.begin(), alarms_.end(), std::greater<>());
    alarms_.pop_back();
    if (nodes_[alarm.node].alarm != alarm.number) continue;
    nodes_[alarm.node].alarm = 0;
    --live_alarms_;
    look_again(alarm.node);
  }
  // Nodes that start running meanwhile come after the others and have already been called.
  const std::size_t count = running_.size();
  std::size_t kept = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const EventNode node = running_[i];
    if (nodes_[node].running) nodes_[node].schema->behaviour->on_time(*this, node);
    nodes_[node].listed = nodes_[node].running;
    if (nodes_[node].running) running_[kept++] = node;
  }
  running_.erase(running_.begin() + static_cast<std::ptrdiff_t>(kept),
                 running_.begin() + static_cast<std::ptrdiff_t>(count));
  pointing_->go_on();
  drain();
}

bool Execution::send(const SceneGraph& scene, NodeId id, const InterfaceDeclaration& event_in,
                     const FieldValue& value) {
  if (!scene.contains(id) || vrml::type_of(value) != event_in.type) return false;
  const EventNode node = event_node(scene, id);
  if (node == 0) return false;
  const std::uint32_t interface = nodes_[node].schema->find(event_in);
  if (interface == EventSchema::kNone ||
      (event_in.access != AccessType::eventIn && event_in.access != AccessType::exposedField))
    return false;
  const FieldValue kept = value;
  receive(node, interface, kept);
  drain();
  return true;
}

void Execution::queue(EventNode node, std::uint32_t interface) {
  Slot& slot = slots_[nodes_[node].first_slot + interface];
  if (slot.sent == stamp_) return;
  slot.sent = stamp_;
  if (slot.first != 0 || !observers_.empty()) queue_.push_back({node, interface, 0});
}

void Execution::drain() {
  do {
    begin_scripts();
    while (queue_next_ < queue_.size()) {
      deliver(queue_[queue_next_++]);
      begin_scripts();
    }
    queue_.clear();
    posted_.clear();
    queue_next_ = 0;
    // Events that these nodes send join this cascade. Each eventOut causes at most one evaluation.
    for (std::size_t i = 0; i < looking_.size(); ++i) {
      const EventNode node = looking_[i];
      nodes_[node].looking = false;
      nodes_[node].schema->behaviour->on_time(*this, node);
    }
    looking_.clear();
    begin_scripts();
    if (queue_.empty()) unbind_what_left();
  } while (!queue_.empty());
  free_connections_.insert(free_connections_.end(), removed_connections_.begin(), removed_connections_.end());
  removed_connections_.clear();
  // A world that replaces itself at once does so only once per timestamp.
  if (next_world_ && replaced_at_ != stamp_) do_replace_world();
  remove_if_many();
}

void Execution::deliver(Sent sent) {
  if (sent.posted != 0) {
    if (spend(kDelivery)) receive(sent.node, sent.interface, posted_[sent.posted - 1]);
    return;
  }
  const Member& at = nodes_[sent.node];
  const EventSchema::Interface& interface = at.schema->interfaces[sent.interface];
  const FieldValue& value = stored(at, interface);
  for (const auto& [who, observer] : observers_) observer({now_, at.scene, at.id, interface.declaration, &value});
  walk(slots_[at.first_slot + sent.interface].first, value);
}

// Delivers one event along all connections: a list of them, with nested lists where they enter PROTO instances. Uses an
// explicit stack of list positions, since files determine the nesting depth of instances.
void Execution::walk(std::uint32_t first, const FieldValue& value) {
  assert(path_.empty());
  if (first != 0) path_.push_back(first);
  while (!path_.empty()) {
    const Connection connection = connections_[path_.back()];
    if (connection.next != 0) {
      path_.back() = connection.next;
    } else {
      path_.pop_back();
    }
    if (connection.way == Way::removed) continue;
    if (!spend(kDelivery)) {
      path_.clear();
      return;
    }
    if (connection.way == Way::up) {
      pass_up(connection.to, connection.event_in, value);
      continue;
    }
    const Member& to = nodes_[connection.to];
    if (to.schema->instance) {
      const std::size_t ways_down = to.first_slot + to.schema->interfaces.size() + connection.event_in;
      if (slots_[ways_down].first != 0) {
        path_.push_back(slots_[ways_down].first);
        continue;
      }
    }
    receive(connection.to, connection.event_in, value);
  }
}

void Execution::receive(EventNode node, std::uint32_t place, const FieldValue& value) {
  const Member& at = nodes_[node];
  const EventSchema& schema = *at.schema;
  const EventSchema::Interface& interface = schema.interfaces[place];
  if (schema.instance) {
    const std::size_t ways_down = at.first_slot + schema.interfaces.size() + place;
    if (slots_[ways_down].first != 0) {  // only from outside; walk() handles its own
      walk(slots_[ways_down].first, value);
      return;
    }
    // An EXTERNPROTO without a body has no receiver yet (4.9.1).
    if (schema.type->kind == NodeType::Kind::external_prototype && !schema.type->prototype) return;
  }
  if (interface.event >= 0 && schema.behaviour->on_event &&
      !schema.behaviour->on_event(*this, node, interface.event, value))
    return;
  if (interface.slot >= 0) {
    FieldValue& field = at.node->values[interface.slot];
    if (std::holds_alternative<MFNode>(field)) nodes_leave();
    if (std::holds_alternative<MFString>(field)) at.node->strings_set = true;
    if (&field != &value) field = value;
    mark_changed(node, interface.slot);
    if (interface.declaration->access == AccessType::exposedField) queue(node, place);
  }
  // Called last, since it may create nodes.
  if (interface.event < 0 && schema.behaviour && schema.behaviour->on_own_event)
    schema.behaviour->on_own_event(*this, node, place, value);
}

// Passes an eventOut up through IS: it continues as an event of the instance (4.8.2).
void Execution::pass_up(EventNode node, std::uint32_t place, const FieldValue& value) {
  const Member& at = nodes_[node];
  const EventSchema::Interface& interface = at.schema->interfaces[place];
  if (slots_[at.first_slot + place].sent == stamp_ || (interface.out < 0 && interface.slot < 0)) return;
  FieldValue& kept = stored(at, interface);
  if (&kept != &value) kept = value;
  if (interface.slot >= 0) mark_changed(node, interface.slot);
  if (interface.out >= 0 && holds_nodes(interface.declaration->type)) note_referring(node);
  queue(node, place);
}

}  // namespace gs::vrml
