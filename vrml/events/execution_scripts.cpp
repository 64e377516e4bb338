#include "vrml/events/execution.h"
#include "vrml/events/script_host.h"

#include <utility>

// Effects of Script programs on their world (VRML97 4.12).
namespace gs::vrml {

void Execution::note_script(EventNode node) {
  has_scripts_ = true;
  new_scripts_.push_back(node);
}

// Starts new Scripts before they receive any event (4.12.3). A program may create Scripts, and their programs more: in
// a running world, at most 64 start per timestamp.
void Execution::begin_scripts() {
  constexpr std::size_t kBegin = std::size_t{1} << 20;  // elements of work
  if (!started_) return;
  if (!script_host_) return new_scripts_.clear();
  std::size_t begun = 0;
  for (; begun < new_scripts_.size() && (starting_ || has_room_for(kBegin)); ++begun) {
    if (!starting_) (void)spend(kBegin);
    const EventNode node = new_scripts_[begun];
    (void)script_host_->begin(node);
    if (!starting_) look_again(node);  // for events that were kept meanwhile
  }
  new_scripts_.erase(new_scripts_.begin(), new_scripts_.begin() + static_cast<std::ptrdiff_t>(begun));
}

void Execution::end_scripts(std::vector<EventNode> nodes) {
  for (const EventNode node : nodes)
    if (node != 0 && nodes_[node].schema->behaviour && nodes_[node].schema->behaviour->before_removal)
      nodes_[node].schema->behaviour->before_removal(*this, node);
}

void Execution::program_came(const SceneGraph& scene, NodeId script) {
  const EventNode node = event_node(scene, script);
  if (node == 0 || !script_host_) return;
  look_again(node);
  drain();
}

void Execution::own_value_changed(EventNode node, std::uint32_t interface) {
  const EventSchema::Interface& own = nodes_[node].schema->interfaces[interface];
  if (holds_nodes(own.declaration->type)) note_referring(node);
}

void Execution::send_own(EventNode node, std::uint32_t interface) {
  const EventSchema::Interface& own = nodes_[node].schema->interfaces[interface];
  if (own.slot >= 0) mark_changed(node, own.slot);
  own_value_changed(node, interface);
  queue(node, interface);
}

bool Execution::post(const SceneGraph& scene, NodeId id, const InterfaceDeclaration& event_in, FieldValue value) {
  if (!scene.contains(id) || vrml::type_of(value) != event_in.type) return false;
  if (event_in.access != AccessType::eventIn && event_in.access != AccessType::exposedField) return false;
  const EventNode node = event_node(scene, id);
  const std::uint32_t interface = node == 0 ? EventSchema::kNone : nodes_[node].schema->find(event_in);
  if (interface == EventSchema::kNone || !spend(1)) return false;
  posted_.push_back(std::move(value));
  queue_.push_back({node, interface, static_cast<std::uint32_t>(posted_.size())});
  return true;
}

const FieldValue* Execution::last_value(const SceneGraph& scene, NodeId id, const InterfaceDeclaration& interface) {
  if (!scene.contains(id)) return nullptr;
  if (interface.slot >= 0) return &scene.node(id).values[interface.slot];
  if (interface.access != AccessType::eventOut) return nullptr;
  const EventNode node = event_node(scene, id);
  const std::uint32_t place = node == 0 ? EventSchema::kNone : nodes_[node].schema->find(interface);
  if (place == EventSchema::kNone) return nullptr;
  FieldValue& value = own_value(node, place);
  const Member& at = nodes_[node];
  if (at.schema->behaviour && at.schema->behaviour->unsent_value && slots_[at.first_slot + place].sent == 0)
    (void)at.schema->behaviour->unsent_value(*this, node, value);
  return &value;
}

SceneGraph* Execution::own_scene(const SceneGraph& scene) {
  const auto place = scene_places_.find(&scene);
  return place == scene_places_.end() ? nullptr : scenes_[place->second].scene;
}

}  // namespace gs::vrml
