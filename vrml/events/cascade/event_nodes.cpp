#include "vrml/events/event_nodes.h"

#include "vrml/events/execution.h"

#include <utility>

namespace gs::vrml {

EventNodes::EventNodes(Execution& execution) : execution_(execution) {}

FieldValue& EventNodes::own_value(EventNode node, std::uint32_t interface) {
  const EventMember& at = members_[node];
  const EventSchema::Interface& own = at.schema->interfaces[interface];
  return own.out >= 0 ? out_values_[at.first_out + static_cast<std::uint32_t>(own.out)] : at.node->values[own.slot];
}

const FieldValue& EventNodes::value_of(EventNode node, int event) const {
  const EventMember& at = members_[node];
  const EventSchema::Interface& interface = at.schema->interfaces[at.schema->events[static_cast<std::size_t>(event)]];
  return interface.out >= 0 ? out_values_[at.first_out + static_cast<std::uint32_t>(interface.out)]
                            : at.node->values[interface.slot];
}

bool EventNodes::has_event(EventNode node, int event) const {
  return members_[node].schema->events[static_cast<std::size_t>(event)] != EventSchema::kNone;
}

bool EventNodes::afford_most(EventNode node, std::size_t bytes) {
  EventMember& at = members_[node];
  if (bytes <= at.most) return true;
  if (!execution_.budget().afford(bytes - at.most)) return false;
  at.most = bytes;
  return true;
}

EventSchema& EventNodes::schema_for(const NodeType& type) {
  std::unique_ptr<EventSchema>& schema = schemas_[&type];
  if (!schema) schema = std::make_unique<EventSchema>(type);
  return *schema;
}

EventNode EventNodes::make(SceneGraph& scene, NodeId id, EventNode& entry) {
  Node& node = scene.node(id);
  EventSchema& schema = schema_for(*node.type);
  const std::size_t slots = slots_of(schema);
  // Entries of removed nodes are used again without new memory, because their memory is already charged to the budget.
  const auto place_of = [](auto& free, std::size_t count) -> std::optional<std::uint32_t> {
    const auto places = free.find(count);
    if (places == free.end() || places->second.empty()) return {};
    const std::uint32_t place = places->second.back();
    places->second.pop_back();
    return place;
  };
  const auto free_slots = place_of(free_slots_, slots), free_outs = place_of(free_outs_, schema.outs.size());
  constexpr std::size_t kBuffers = 2;  // factor for the spare capacity of growing vectors
  const std::size_t fresh = (free_members_.empty() ? sizeof(EventMember) : 0) +
                            (free_slots ? 0 : slots * sizeof(EventSlot)) +
                            (free_outs ? 0 : schema.outs.size() * sizeof(FieldValue));
  if (!execution_.budget().afford(kBuffers * fresh)) {
    if (free_slots) free_slots_[slots].push_back(*free_slots);
    if (free_outs) free_outs_[schema.outs.size()].push_back(*free_outs);
    return 0;
  }
  if (free_members_.empty()) {
    free_members_.push_back(static_cast<EventNode>(members_.size()));
    members_.emplace_back();
  }
  const EventNode made = free_members_.back();
  free_members_.pop_back();
  EventMember& at = members_[made] = {};
  at.scene = &scene;
  at.node = &node;
  at.id = id;
  at.schema = &schema;
  at.first_slot = free_slots.value_or(static_cast<std::uint32_t>(slots_.size()));
  at.first_out = free_outs.value_or(static_cast<std::uint32_t>(out_values_.size()));
  if (!free_slots) slots_.resize(slots_.size() + slots);
  for (std::size_t i = 0; i < schema.outs.size(); ++i) {
    if (!free_outs) out_values_.emplace_back();
    out_values_[at.first_out + i] = initial_value(schema.outs[i]);
  }
  ++schema.users;
  entry = made;
  if (schema.behaviour && schema.behaviour->initialize) schema.behaviour->initialize(execution_, made);
  return made;
}

void EventNodes::remove(EventNode node) {
  EventMember& at = members_[node];
  EventSchema& schema = *at.schema;
  const std::size_t slots = slots_of(schema);
  for (std::size_t i = 0; i < slots; ++i) slots_[at.first_slot + i] = {};
  for (std::size_t i = 0; i < schema.outs.size(); ++i) out_values_[at.first_out + i] = {};
  if (slots != 0) free_slots_[slots].push_back(at.first_slot);
  if (!schema.outs.empty()) free_outs_[schema.outs.size()].push_back(at.first_out);
  execution_.budget().give_back(at.most);
  if (--schema.users == 0 && schema.type->kind != NodeType::Kind::built_in) schemas_.erase(schema.type);
  at = {};
  removed_members_.push_back(node);
}

void EventNodes::reuse_removed() {
  free_members_.insert(free_members_.end(), removed_members_.begin(), removed_members_.end());
  removed_members_.clear();
}

}  // namespace gs::vrml
