#pragma once

#include "vrml/event_model/event_schema.h"
#include "vrml/event_model/placement.h"
#include "vrml/scene/scene_graph.h"

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <unordered_map>
#include <vector>

namespace gs::vrml {

/// Record of a node that takes part in events. Several classes of the execution model keep their data of the node here.
struct EventMember {
  SceneGraph* scene = nullptr;  // null if the node was removed
  Node* node = nullptr;
  NodeId id;
  EventSchema* schema = nullptr;
  std::uint32_t state = 0;  // see EventNodes::state_of
  std::size_t most = 0;     // largest size so far, in bytes; see EventNodes::afford_most
  // Data of EventNodes: slots and eventOut values.
  std::uint32_t first_slot = 0;  // one slot per interface; then, for PROTO instances, the slots of `down` connections
  std::uint32_t first_out = 0;
  // Data of RouteTable.
  std::uint32_t first_in = 0;  // first connection to this node; 0 means none
  // Data of BindableStacks.
  bool on_stack = false;
  bool placed = false;  // on a stack, and found in the transformation hierarchy since then
  // Data of TimerQueue.
  bool running = false, listed = false, looking = false;
  std::uint64_t rank = 0;   // order of the calls in a step
  std::uint32_t alarm = 0;  // serial number of the valid call_at request; 0 means none
  // Data of IdleSensors.
  std::uint32_t idle = 0;                    // 1 + index of the resting node; 0 means that the node does not rest
  std::uint8_t nap_wait = 0, nap_delay = 0;  // steps until the node may rest; steps after its next movement
  // Data of ChangeList.
  std::uint32_t change = 0;  // 1 + index of its change; 0 means none
  // Data of NodeLifetime.
  bool refers = false;  // listed because its node fields or eventOuts have changed
  // Data of ScriptQueue.
  bool waits = false;  // a call of its program waits
};

/// Sender of events: an interface of a node.
struct EventSlot {
  std::uint32_t first = 0, last = 0;  // first and last connection; 0 means none
  std::uint64_t sent = 0;             // serial number of the timestamp of its last event
};

/// Nodes of a world that take part in events: nodes with a behaviour, a ROUTE or an IS. Owns their records, slots and
/// eventOut values. Entries of removed nodes are used again. Part of Execution.
class EventNodes {
 public:
  explicit EventNodes(Execution& execution);

  [[nodiscard]] EventMember& operator[](EventNode node) { return members_[node]; }
  [[nodiscard]] const EventMember& operator[](EventNode node) const { return members_[node]; }
  [[nodiscard]] EventSlot& slot(std::uint32_t place) { return slots_[place]; }
  /// Returns the slot of an interface. `interface` is an index in the interfaces of the node's EventSchema.
  [[nodiscard]] EventSlot& slot(EventNode node, std::uint32_t interface) {
    return slots_[members_[node].first_slot + interface];
  }
  /// Returns the slot of the connections from an eventIn of a PROTO instance into its body.
  [[nodiscard]] EventSlot& slot_inside(EventNode node, std::uint32_t interface) {
    return slot(node, static_cast<std::uint32_t>(members_[node].schema->interfaces.size()) + interface);
  }
  /// Returns the number of slots of nodes with this schema.
  [[nodiscard]] static std::size_t slots_of(const EventSchema& schema) {
    return schema.interfaces.size() * (schema.instance ? 2 : 1);
  }

  [[nodiscard]] const NodeType& type_of(EventNode node) const { return *members_[node].schema->type; }
  [[nodiscard]] const EventSchema& schema_of(EventNode node) const { return *members_[node].schema; }
  [[nodiscard]] const Behaviour& behaviour_of(EventNode node) const { return *members_[node].schema->behaviour; }
  [[nodiscard]] NodePlace place_of(EventNode node) const { return {members_[node].scene, members_[node].id}; }
  /// Returns a number that the node's behaviour may use, usually as index of its state; initially 0.
  [[nodiscard]] std::uint32_t& state_of(EventNode node) { return members_[node].state; }

  /// Returns the value of an interface; `event` is an index in Behaviour::events.
  [[nodiscard]] const FieldValue& value_of(EventNode node, int event) const;
  /// Reports whether the node's type has an interface; `event` is an index in Behaviour::events.
  [[nodiscard]] bool has_event(EventNode node, int event) const;
  /// Returns the value of a field, or the last value of an eventOut.
  [[nodiscard]] FieldValue& own_value(EventNode node, std::uint32_t interface);
  /// Returns the value of the eventOut with index `out` in the schema.
  [[nodiscard]] const FieldValue& out_value(EventNode node, std::size_t out) const {
    return out_values_[members_[node].first_out + out];
  }
  /// Draws memory for a list of the node that now has `bytes` bytes. Draws only the excess over its largest size so
  /// far.
  [[nodiscard]] bool afford_most(EventNode node, std::size_t bytes);

  /// Makes the record of a node and calls Behaviour::initialize. Before that call, writes the new index to `entry`,
  /// where the caller stores it. Returns 0 if the budget is exhausted.
  EventNode make(SceneGraph& scene, NodeId id, EventNode& entry);
  /// Frees the record of a node, which must have no connections. Its index is used again after reuse_removed().
  void remove(EventNode node);
  [[nodiscard]] bool is_removed(EventNode node) const { return members_[node].scene == nullptr; }
  void reuse_removed();

 private:
  [[nodiscard]] EventSchema& schema_for(const NodeType& type);

  Execution& execution_;
  std::vector<EventMember> members_{1};  // index 0 is unused
  std::vector<EventSlot> slots_;
  std::deque<FieldValue> out_values_;
  // Entries of removed nodes for new nodes. Slots and values are grouped by the length of their run.
  std::vector<EventNode> free_members_, removed_members_;
  std::unordered_map<std::size_t, std::vector<std::uint32_t>> free_slots_, free_outs_;
  std::unordered_map<const NodeType*, std::unique_ptr<EventSchema>> schemas_;
};

}  // namespace gs::vrml
