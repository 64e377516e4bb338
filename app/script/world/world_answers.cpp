#include "app/script/world/world_answers.h"

#include <algorithm>
#include <utility>

namespace gs::app::script {
namespace {

constexpr std::size_t kMaxReported = 2000;  // max characters of a message of a program

using AnswerFunction = Answer (*)(WorldAnswers&, const Question&);

const std::array<AnswerFunction, kAskCount>& answer_functions() {
  static const auto all = [] {
    std::array<AnswerFunction, kAskCount> made{};
    for (const auto rows : {answers_about_nodes(), answers_of_browser(), answers_about_viewer(), answers_for_x3d()})
      for (const AnswerRow& row : rows) made[static_cast<std::size_t>(row.ask)] = row.answer;
    return made;
  }();
  return all;
}

std::string cut(std::string text, std::size_t most) {
  if (text.size() > most) text.resize(most);
  return text;
}

}  // namespace

vrml::FieldValue with_present_nodes(const vrml::SceneGraph& scene, const vrml::FieldValue& value) {
  if (const auto* const node = std::get_if<vrml::SFNode>(&value))
    return scene.contains(*node) ? value : vrml::FieldValue(vrml::SFNode{});
  const auto* const nodes = std::get_if<vrml::MFNode>(&value);
  const auto is_present = [&](vrml::NodeId id) { return !id || scene.contains(id); };
  if (!nodes || std::all_of(nodes->begin(), nodes->end(), is_present)) return value;
  vrml::MFNode present;
  for (const vrml::NodeId id : *nodes) present.push_back(is_present(id) ? id : vrml::NodeId{});
  return present;
}

std::shared_ptr<const vrml::NodeType> pointer_to(const vrml::NodeType& type) {
  return {std::shared_ptr<const vrml::NodeType>(), &type};
}

bool sets_program(const vrml::NodeType& type, const vrml::InterfaceDeclaration& event_in) {
  return vrml::has(type.role, vrml::Role::script) && event_in.name == "url";
}

WorldAnswers::WorldAnswers(vrml::Execution& execution, ScriptMessages& messages, RequestQueue& requests,
                           ReadGuard& reads)
    : execution_(execution), messages_(messages), requests_(requests), reads_(reads) {}

NodeRef WorldAnswers::ref(vrml::SceneGraph& scene, vrml::NodeId node) {
  scenes_[scene.serial()] = &scene;
  return {scene.serial(), node};
}

vrml::SceneGraph* WorldAnswers::scene_of(std::uint64_t serial) const {
  const auto found = scenes_.find(serial);
  if (found == scenes_.end() || !execution_.scenes().has(found->second)) return nullptr;
  return found->second->serial() == serial ? found->second : nullptr;
}

NodeAt WorldAnswers::find(const NodeRef& node) const {
  vrml::SceneGraph* const scene = scene_of(node.scene);
  return scene && scene->contains(node.id) ? NodeAt{scene, node.id} : NodeAt{};
}

std::vector<std::uint64_t> WorldAnswers::take_gone() {
  std::vector<std::uint64_t> gone;
  if (std::exchange(removals_, execution_.scenes().removals()) == execution_.scenes().removals()) return gone;
  for (const auto& [serial, scene] : scenes_)
    if (!scene_of(serial)) gone.push_back(serial);
  for (const std::uint64_t serial : gone) scenes_.erase(serial);
  std::erase_if(held_, [&](const auto& one) { return !scenes_.contains(one.first.scene); });
  return gone;
}

void WorldAnswers::release_all() {
  for (const auto& [node, count] : std::exchange(held_, {}))
    if (const NodeAt at = find(node); at.scene)
      for (std::uint32_t i = 0; i < count; ++i) execution_.lifetime().release(*at.scene, at.node);
}

bool WorldAnswers::acts_at_once(Ask ask) {
  return ask == Ask::create_nodes || ask == Ask::change_route || ask == Ask::x3d_set_roots ||
         ask == Ask::x3d_create_instance || ask == Ask::make_navigation;
}

Answer WorldAnswers::ask(const Question& question) {
  if (running_ && acts_at_once(question.ask)) running_->acts_at_once = true;
  const auto index = static_cast<std::size_t>(question.ask);
  const AnswerFunction answer = running_ && index < kAskCount ? answer_functions()[index] : nullptr;
  return answer ? answer(*this, question) : Answer{};
}

// ---- Notices

void WorldAnswers::tell(const Notice& notice) {
  if (!running_) return notice.kind == Notice::Kind::release ? release(notice) : void();
  switch (notice.kind) {
    case Notice::Kind::hold:
      return hold(notice);
    case Notice::Kind::release:
      return release(notice);
    case Notice::Kind::print:
      return messages_.print(notice.text);
    case Notice::Kind::report: {
      std::optional<Diagnostic> at = notice.at;
      if (at) at->file = cut(std::move(at->file), kMaxReported);
      return messages_.report(notice.severity, *running_, cut(notice.text, kMaxReported), std::move(at));
    }
    case Notice::Kind::direct_output:
      return messages_.report_direct_output(*running_);
    case Notice::Kind::own_value:
      return set_own_value(notice);
    case Notice::Kind::send_own:
      return send_own(notice);
    case Notice::Kind::post:
      return post(notice);
  }
}

void WorldAnswers::hold(const Notice& notice) {
  const NodeAt at = find(notice.node);
  if (!at.scene) return;
  execution_.lifetime().hold(*at.scene, at.node);
  ++held_[notice.node];
}

void WorldAnswers::release(const Notice& notice) {
  const auto held = held_.find(notice.node);
  if (held == held_.end()) return;
  if (--held->second == 0) held_.erase(held);
  if (const NodeAt at = find(notice.node); at.scene) execution_.lifetime().release(*at.scene, at.node);
}

void WorldAnswers::set_own_value(const Notice& notice) {
  const vrml::NodeType& type = *running_->scene->node(running_->id).type;
  if (notice.place >= type.interfaces.size() || notice.place >= running_->known.size()) return;
  const vrml::InterfaceDeclaration& declaration = type.interfaces[notice.place];
  if (declaration.access == vrml::AccessType::eventIn || is_own_field_of_script(running_->language, declaration) ||
      vrml::type_of(notice.value) != declaration.type)
    return;
  vrml::FieldValue& value = execution_.nodes().own_value(running_->node, notice.place);
  value = with_present_nodes(*running_->scene, notice.value);
  running_->known[notice.place] = value;
  execution_.cascade().own_value_changed(running_->node, notice.place);
}

void WorldAnswers::send_own(const Notice& notice) {
  const vrml::NodeType& type = *running_->scene->node(running_->id).type;
  if (ends_ || notice.place >= type.interfaces.size()) return;
  const vrml::InterfaceDeclaration& declaration = type.interfaces[notice.place];
  const bool sends =
      declaration.access == vrml::AccessType::eventOut || declaration.access == vrml::AccessType::exposedField;
  if (sends && !is_own_field_of_script(running_->language, declaration))
    execution_.cascade().send_own(running_->node, notice.place);
}

void WorldAnswers::post(const Notice& notice) {
  const NodeAt at = find(notice.node);
  if (ends_ || !at.scene) return;
  const vrml::Node& node = at.get();
  if (notice.place >= node.type->interfaces.size()) return;
  const vrml::InterfaceDeclaration& event_in = node.type->interfaces[notice.place];
  if (sets_program(*node.type, event_in) && !may_read(node)) return;
  (void)execution_.cascade().post(*at.scene, at.node, event_in, with_present_nodes(*at.scene, notice.value));
}

}  // namespace gs::app::script
