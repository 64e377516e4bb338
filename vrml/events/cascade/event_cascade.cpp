#include "vrml/events/event_cascade.h"

#include "vrml/events/execution.h"

#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

namespace gs::vrml {

EventCascade::EventCascade(Execution& execution)
    : execution_(execution),
      now_(-std::numeric_limits<double>::infinity()),
      previous_(-std::numeric_limits<double>::infinity()) {}

void EventCascade::begin(double now, bool first) {
  if (now > now_) {  // timestamps never decrease (4.11)
    previous_ = now_;
    now_ = now;
    ++stamp_;
    execution_.budget().begin_timestamp();
  }
  if (first) previous_ = now_;
}

void EventCascade::begin_update() {
  now_ = std::nextafter(now_, std::numeric_limits<double>::infinity());
  ++stamp_;
  execution_.budget().begin_timestamp();
}

void EventCascade::observe(Observer observer, const void* who) {
  std::erase_if(observers_, [&](const auto& one) { return one.first == who; });
  if (observer) observers_.emplace_back(who, std::move(observer));
}

std::pair<EventNode, std::uint32_t> EventCascade::receiver(const SceneGraph& scene, NodeId id,
                                                           const InterfaceDeclaration& event_in,
                                                           const FieldValue& value) {
  const bool receives = event_in.access == AccessType::eventIn || event_in.access == AccessType::exposedField;
  if (!receives || !scene.contains(id) || type_of(value) != event_in.type) return {};
  const EventNode node = execution_.scenes().event_node(scene, id);
  const std::uint32_t interface = node == 0 ? EventSchema::kNone : execution_.nodes()[node].schema->find(event_in);
  if (interface == EventSchema::kNone) return {};
  return {node, interface};
}

bool EventCascade::send(const SceneGraph& scene, NodeId id, const InterfaceDeclaration& event_in,
                        const FieldValue& value) {
  const auto [node, interface] = receiver(scene, id, event_in, value);
  if (node == 0 || execution_.budget().is_halted()) return false;
  const FieldValue kept = value;
  receive(node, interface, kept);
  drain();
  return true;
}

bool EventCascade::post(const SceneGraph& scene, NodeId id, const InterfaceDeclaration& event_in, FieldValue value) {
  const auto [node, interface] = receiver(scene, id, event_in, value);
  if (node == 0 || !execution_.budget().spend(1)) return false;
  posted_.push_back(std::move(value));
  queue_.push_back({node, interface, static_cast<std::uint32_t>(posted_.size())});
  return true;
}

bool EventCascade::has_sent_own(EventNode node, std::uint32_t interface) const {
  return execution_.nodes().slot(node, interface).sent == stamp_;
}

FieldValue* EventCascade::place_to_send(EventNode node, int event) {
  EventNodes& nodes = execution_.nodes();
  const EventSchema& schema = nodes.schema_of(node);
  const std::uint32_t place = schema.events[static_cast<std::size_t>(event)];
  if (place == EventSchema::kNone) return nullptr;
  const EventSchema::Interface& interface = schema.interfaces[place];
  // After an event with this timestamp, an eventOut keeps its value. An exposedField takes the new value in any case.
  if (interface.out >= 0 && has_sent_own(node, place)) return nullptr;
  if (interface.out < 0) execution_.changes().mark(node, interface.slot);
  if (interface.out >= 0 && holds_nodes(interface.declaration->type)) execution_.lifetime().note_referring(node);
  queue(node, place);
  return &nodes.own_value(node, place);
}

void EventCascade::own_value_changed(EventNode node, std::uint32_t interface) {
  const EventSchema::Interface& own = execution_.nodes().schema_of(node).interfaces[interface];
  if (holds_nodes(own.declaration->type)) execution_.lifetime().note_referring(node);
}

void EventCascade::send_own(EventNode node, std::uint32_t interface) {
  const EventSchema::Interface& own = execution_.nodes().schema_of(node).interfaces[interface];
  if (own.slot >= 0) execution_.changes().mark(node, own.slot);
  own_value_changed(node, interface);
  queue(node, interface);
}

const FieldValue* EventCascade::last_value(const SceneGraph& scene, NodeId id, const InterfaceDeclaration& interface) {
  if (!scene.contains(id)) return nullptr;
  if (interface.slot >= 0) return &scene.node(id).values[interface.slot];
  if (interface.access != AccessType::eventOut) return nullptr;
  const EventNode node = execution_.scenes().event_node(scene, id);
  EventNodes& nodes = execution_.nodes();
  const std::uint32_t place = node == 0 ? EventSchema::kNone : nodes[node].schema->find(interface);
  if (place == EventSchema::kNone) return nullptr;
  FieldValue& value = nodes.own_value(node, place);
  const Behaviour* const behaviour = nodes.schema_of(node).behaviour;
  if (behaviour && behaviour->unsent_value && nodes.slot(node, place).sent == 0)
    (void)behaviour->unsent_value(execution_, node, value);
  return &value;
}

void EventCascade::queue(EventNode node, std::uint32_t interface) {
  EventSlot& slot = execution_.nodes().slot(node, interface);
  if (slot.sent == stamp_) return;
  slot.sent = stamp_;
  if (slot.first != 0 || !observers_.empty()) queue_.push_back({node, interface, 0});
}

void EventCascade::drain() {
  ScriptQueue& scripts = execution_.scripts();
  do {
    scripts.begin_new();
    do {
      while (queue_next_ < queue_.size()) {
        deliver(queue_[queue_next_++]);
        scripts.begin_new();
        if (execution_.budget().is_halted()) queue_next_ = queue_.size();
      }
      scripts.flush();
      scripts.begin_new();
    } while (queue_next_ < queue_.size());
    queue_.clear();
    posted_.clear();
    queue_next_ = 0;
    // Calls nodes that wait until all events are delivered. Their events join this cascade, and each eventOut causes at
    // most one such call.
    execution_.timers().call_waiting();
    scripts.flush();
    scripts.begin_new();
    if (queue_.empty()) execution_.stacks().unbind_left();
  } while (!queue_.empty());
  execution_.routes().reuse_removed();
  execution_.lifetime().end_cascade();
}

void EventCascade::deliver(Sent sent) {
  EventNodes& nodes = execution_.nodes();
  if (sent.posted != 0) {
    if (execution_.budget().spend(EventBudget::kDelivery)) receive(sent.node, sent.interface, posted_[sent.posted - 1]);
    return;
  }
  // A program may change the value of an eventOut after its event was sent.
  if (nodes[sent.node].waits) execution_.scripts().flush();
  const EventMember& at = nodes[sent.node];
  const FieldValue& value = nodes.own_value(sent.node, sent.interface);
  for (const auto& [who, observer] : observers_)
    observer({now_, at.scene, at.id, at.schema->interfaces[sent.interface].declaration, &value});
  source_ = sent.node;
  walk(nodes.slot(sent.node, sent.interface).first, value);
  source_ = 0;
}

// Delivers one event along a list of connections. Connections into PROTO instances contain nested lists. Uses an
// explicit stack of list positions instead of recursion, because files determine how deep instances are nested.
void EventCascade::walk(std::uint32_t first, const FieldValue& value) {
  assert(path_.empty());
  EventNodes& nodes = execution_.nodes();
  const RouteTable& routes = execution_.routes();
  if (first != 0) path_.push_back(first);
  while (!path_.empty()) {
    const RouteTable::Connection connection = routes.connection(path_.back());
    if (connection.next != 0) {
      path_.back() = connection.next;
    } else {
      path_.pop_back();
    }
    if (connection.way == RouteTable::Way::removed) continue;
    if (!execution_.budget().spend(EventBudget::kDelivery)) {
      path_.clear();
      return;
    }
    if (connection.way == RouteTable::Way::up) {
      pass_up(connection.to, connection.event_in, value);
      continue;
    }
    const EventMember& to = nodes[connection.to];
    if (to.schema->instance) {
      const std::uint32_t inside = nodes.slot_inside(connection.to, connection.event_in).first;
      if (inside != 0) {
        path_.push_back(inside);
        continue;
      }
    }
    receive(connection.to, connection.event_in, value);
  }
}

void EventCascade::receive(EventNode node, std::uint32_t place, const FieldValue& value) {
  EventNodes& nodes = execution_.nodes();
  // Programs that wait must not see the effects of later events. An eventIn of a Script has none before its call.
  if (!nodes.schema_of(node).calls_only(place)) execution_.scripts().flush();
  const EventSchema& schema = nodes.schema_of(node);
  const EventSchema::Interface& interface = schema.interfaces[place];
  Node& target = *nodes[node].node;
  if (schema.instance) {
    const std::uint32_t inside = nodes.slot_inside(node, place).first;
    if (inside != 0) {  // only for events from outside; walk() passes its own on
      walk(inside, value);
      return;
    }
    // An EXTERNPROTO without a body has no receiver for the event yet (4.9.1).
    if (schema.type->kind == NodeType::Kind::external_prototype && !schema.type->prototype) return;
  }
  if (interface.event >= 0 && schema.behaviour->on_event &&
      !schema.behaviour->on_event(execution_, node, interface.event, value))
    return;
  if (interface.slot >= 0) {
    FieldValue& field = target.values[interface.slot];
    if (std::holds_alternative<MFNode>(field)) execution_.stacks().nodes_leave();
    if (std::holds_alternative<MFString>(field)) target.strings_set = true;
    if (&field != &value) field = value;
    execution_.changes().mark(node, interface.slot);
    if (interface.declaration->access == AccessType::exposedField) queue(node, place);
  }
  // Must be the last call, because it may create nodes.
  if (interface.event < 0 && schema.behaviour && schema.behaviour->on_own_event)
    schema.behaviour->on_own_event(execution_, node, place, value);
}

// Passes an eventOut of a body node through IS to its instance. There the event continues as an event of the instance
// (4.8.2).
void EventCascade::pass_up(EventNode node, std::uint32_t place, const FieldValue& value) {
  execution_.scripts().flush();
  const EventSchema::Interface& interface = execution_.nodes().schema_of(node).interfaces[place];
  if (has_sent_own(node, place) || (interface.out < 0 && interface.slot < 0)) return;
  FieldValue& kept = execution_.nodes().own_value(node, place);
  if (&kept != &value) kept = value;
  if (interface.slot >= 0) execution_.changes().mark(node, interface.slot);
  if (interface.out >= 0 && holds_nodes(interface.declaration->type)) execution_.lifetime().note_referring(node);
  queue(node, place);
}

}  // namespace gs::vrml
