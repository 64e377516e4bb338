#include "app/inspect/node_editor.h"

#include "app/inspect/field_edits.h"
#include "app/inspect/field_values.h"
#include "app/script/run_time_nodes.h"
#include "app/session/opening/links.h"

#include <utility>
#include <variant>

namespace gs::app {
namespace {

constexpr std::size_t kMaxEdits = 10'000;  // max number of edits that are not sent yet

}  // namespace

void NodeEditor::set_world(vrml::Execution* world) {
  world_ = world;
  node_ = {};
  names_.reset();
  edits_.clear();
}

vrml::NodeNames& NodeEditor::names() {
  if (!names_) names_ = std::make_unique<vrml::NodeNames>(world_->scenes().root());
  return *names_;
}

const vrml::FieldValue* NodeEditor::value_of(const vrml::InterfaceDeclaration& interface) const {
  return world_ && node_ ? world_->cascade().last_value(*node_.scene, node_.id, interface) : nullptr;
}

std::optional<std::string> NodeEditor::send_text(const vrml::InterfaceDeclaration& event_in, const std::string& text) {
  if (!world_ || !node_) return "the node no longer exists";
  // DEF names are resolved only in the world's own file, not in Inlines.
  if (vrml::holds_nodes(event_in.type) && node_.scene != &world_->scenes().root())
    return "nodes of Inlines cannot be set to nodes here";
  auto read = read_edit(*node_.scene->node(node_.id).type, event_in, text, names());
  if (auto* why = std::get_if<std::string>(&read)) return std::move(*why);
  return send(event_in, std::move(std::get<vrml::FieldValue>(read)));
}

std::optional<std::string> NodeEditor::send(const vrml::InterfaceDeclaration& event_in, vrml::FieldValue value) {
  if (!world_ || !node_) return "the node no longer exists";
  if (auto why = why_not_valid(*node_.scene->node(node_.id).type, event_in, value)) return why;
  if (edits_.size() >= kMaxEdits) return "too many changes are pending; try again";
  edits_.push_back({node_, &event_in, std::move(value)});
  return std::nullopt;
}

std::optional<std::string> NodeEditor::target_of_url(const vrml::InterfaceDeclaration& url, std::size_t index) const {
  const vrml::FieldValue* const value = value_of(url);
  const auto* const urls = value ? std::get_if<vrml::MFString>(value) : nullptr;
  if (!urls || index >= urls->size() || url.slot < 0) return std::nullopt;
  const Link link = link_of({(*urls)[index].str()}, {}, node_.scene->nodes().text_of(node_.id, url.slot).origin());
  if (link.places.empty() || !link.places.front().problem.empty() || link.places.front().target.empty())
    return std::nullopt;
  return link.places.front().target;
}

std::optional<std::string> NodeEditor::send_element(const vrml::InterfaceDeclaration& event_in,
                                                    const vrml::FieldValue& list, std::size_t index,
                                                    const vrml::FieldValue& element) {
  vrml::FieldValue changed = list;
  if (!set_element(changed, index, element)) return "the element no longer exists";
  return send(event_in, std::move(changed));
}

std::optional<std::string> NodeEditor::send_element_text(const vrml::InterfaceDeclaration& event_in,
                                                         const vrml::FieldValue& list, std::size_t index,
                                                         const std::string& text) {
  if (!world_ || !node_ || index >= element_count(list)) return "the element no longer exists";
  const vrml::FieldType type = vrml::type_of(element_of(list, index));
  if (vrml::holds_nodes(type) && node_.scene != &world_->scenes().root())
    return "nodes of Inlines cannot be set to nodes here";
  const auto value = read_value(text, type, names());
  if (!value) return "'" + text.substr(0, 80) + "' is no " + std::string(vrml::name_of(type));
  return send_element(event_in, list, index, *value);
}

NodeAt NodeEditor::script() const {
  if (!world_ || !node_ || !is_in(*world_, node_)) return {};
  const vrml::NodeId id = node_.scene->resolve(node_.id);
  return id && vrml::has(node_.scene->node(id).type->role, vrml::Role::script) ? NodeAt{node_.scene, id} : NodeAt{};
}

bool NodeEditor::deliver(WorldEdits& edits) {
  if (edits_.empty()) return false;
  world_->cascade().begin_update();
  for (Edit& one : std::exchange(edits_, {})) {
    if (!is_in(*world_, one.node)) continue;
    const vrml::InterfaceDeclaration* const field =
        field_set_by(*one.node.scene->node(one.node.id).type, *one.event_in);
    const vrml::FieldValue* const before =
        field ? world_->cascade().last_value(*one.node.scene, one.node.id, *field) : nullptr;
    WorldEdit edit{one.node.scene, one.node.id,   one.event_in, field, before ? *before : vrml::FieldValue(),
                   one.value,      world_->now(), gesture_};
    const bool changes = before && edit.before != edit.after;
    if (world_->cascade().post(*one.node.scene, one.node.id, *one.event_in, std::move(one.value)) && changes)
      edits.note(std::move(edit));
  }
  world_->cascade().drain();
  return true;
}

bool NodeEditor::step(WorldEdits& edits, int direction) {
  const auto edit = edits.go(direction);
  if (!edit) return false;
  if (!world_ || !is_in(*world_, {edit->scene, edit->node})) return true;
  end_gesture();
  world_->cascade().begin_update();
  (void)world_->cascade().post(*edit->scene, edit->node, *edit->event_in, direction < 0 ? edit->before : edit->after);
  world_->cascade().drain();
  return true;
}

}  // namespace gs::app
