#include "app/script/world/world_answers.h"
#include "vrml/scene/prototype.h"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

// Questions about the nodes, PROTOs and ROUTEs of a text (ISO/IEC 19775-2 6.4). A program inside a PROTO instance sees
// only the nodes of that instance.
namespace gs::app::script {
namespace {

/// Text in which nodes are looked up, and the PROTO instance inside it; 0 means outside of instances.
struct TextContext {
  vrml::SceneGraph* scene = nullptr;
  const vrml::SourceText* text = nullptr;
  std::uint32_t owner = 0;     // index of the text; 0 is the file
  std::uint32_t instance = 0;  // index of the instance's node
  [[nodiscard]] bool has(const vrml::Node& node) const {
    return node.text == text && node.instance == instance && !node.in_prototype_body;
  }
};

TextContext context_of(WorldAnswers& world, const NodeRef& of) {
  NodeAt at = world.find(of);
  if (!at.scene) at = {world.running().scene, world.running().id};
  const vrml::Node& node = at.get();
  return {at.scene, node.text, node.owner, node.instance};
}

// Returns the node of a question; null if it is none, or if the program may not read it.
const vrml::Node* asked_node(WorldAnswers& world, const Question& question) {
  const NodeAt at = world.find(question.node);
  return at.scene && world.may_read(at.get()) ? &at.get() : nullptr;
}

void add_fields(Answer& answer, const vrml::NodeType& type) {
  for (const vrml::InterfaceDeclaration& one : type.interfaces) {
    if (one.of_other_browsers) continue;
    answer.items.emplace_back(vrml::name_in(vrml::Language::x3d, one));
    answer.items.emplace_back(static_cast<double>(one.access));
    answer.items.emplace_back(static_cast<double>(one.type));
  }
}

Answer x3d_fields(WorldAnswers& world, const Question& question) {
  Answer answer;
  const vrml::Node* const node = asked_node(world, question);
  answer.good = node != nullptr;
  if (node) add_fields(answer, *node->type);
  return answer;
}

Answer x3d_types(WorldAnswers& world, const Question& question) {
  Answer answer;
  const vrml::Node* const node = asked_node(world, question);
  answer.good = node != nullptr;
  if (node) answer.text = node->type->bases + " " + node->type->name;
  return answer;
}

Answer x3d_named(WorldAnswers& world, const Question& question) {
  Answer answer;
  const TextContext in = context_of(world, question.node);
  if (question.text.empty()) return answer;
  for (std::uint32_t i = 1; i <= in.scene->nodes().count(); ++i) {
    const vrml::Node& node = in.scene->nodes().at(i);
    const vrml::NodeId id = in.scene->nodes().id_at(i);
    if (!in.scene->contains(id) || node.name != question.text || !in.has(node) || !world.may_read(node)) continue;
    answer.good = true;
    answer.node = world.ref(*in.scene, id);
    break;
  }
  return answer;
}

Answer x3d_roots(WorldAnswers& world, const Question& question) {
  Answer answer;
  const TextContext in = context_of(world, question.node);
  const vrml::MFNode nodes =
      in.instance != 0 ? in.scene->nodes().at(in.instance).expansion : vrml::MFNode(in.text->roots());
  vrml::MFNode readable;
  for (const vrml::NodeId id : nodes)
    if (in.scene->contains(id) && world.may_read(in.scene->node(id))) readable.push_back(id);
  answer.good = true;
  answer.node = world.ref(*in.scene, {});
  answer.value = std::move(readable);
  return answer;
}

// Replaces the top-level nodes of the file. Without nodes, `flag` of the answer states whether the program may do it:
// it must be part of a file.
Answer x3d_set_roots(WorldAnswers& world, const Question& question) {
  Answer answer;
  const TextContext in = context_of(world, {});
  answer.flag = in.owner == 0 && in.instance == 0 && world.may_act();
  const auto* const nodes = std::get_if<vrml::MFNode>(&question.value);
  answer.good = answer.flag && nodes && world.execution().lifetime().set_roots(*in.scene, *nodes);
  return answer;
}

Answer x3d_routes(WorldAnswers& world, const Question& question) {
  constexpr std::size_t kMaxRoutes = 100'000;
  Answer answer;
  const TextContext in = context_of(world, question.node);
  std::size_t count = 0;
  answer.good = true;
  for (const vrml::PlacedRoute& one : world.execution().routes().all()) {
    const vrml::Route& route = one.route;
    if (one.scene != in.scene || !in.scene->contains(route.from) || !in.scene->contains(route.to)) continue;
    const vrml::Node &from = in.scene->node(route.from), &to = in.scene->node(route.to);
    if (!in.has(from) || !in.has(to) || !world.may_read(from) || !world.may_read(to)) continue;
    if (++count > kMaxRoutes) break;
    answer.items.emplace_back(world.ref(*in.scene, route.from));
    answer.items.emplace_back(vrml::name_in(vrml::Language::x3d, *route.event_out));
    answer.items.emplace_back(world.ref(*in.scene, route.to));
    answer.items.emplace_back(vrml::name_in(vrml::Language::x3d, *route.event_in));
  }
  return answer;
}

Answer x3d_prototypes(WorldAnswers& world, const Question& question) {
  Answer answer;
  const TextContext in = context_of(world, question.node);
  const auto kind = question.flag ? vrml::NodeType::Kind::external_prototype : vrml::NodeType::Kind::prototype;
  answer.good = true;
  for (const auto& type : in.text->types())
    if (type->kind == kind) answer.items.emplace_back(type->name);
  return answer;
}

const vrml::NodeType* prototype_named(const TextContext& in, std::string_view name) {
  for (const auto& type : in.text->types())
    if (type->name == name &&
        (type->kind == vrml::NodeType::Kind::prototype || type->kind == vrml::NodeType::Kind::external_prototype))
      return type.get();
  return nullptr;
}

Answer x3d_prototype_fields(WorldAnswers& world, const Question& question) {
  Answer answer;
  const vrml::NodeType* const type = prototype_named(context_of(world, question.node), question.text);
  answer.good = type != nullptr;
  if (type) add_fields(answer, *type);
  return answer;
}

Answer x3d_prototype_urls(WorldAnswers& world, const Question& question) {
  Answer answer;
  const vrml::NodeType* const type = prototype_named(context_of(world, question.node), question.text);
  answer.good = type != nullptr;
  answer.value = type ? type->url : vrml::MFString{};
  return answer;
}

// Makes an instance of a PROTO of the text. Returns no node if there is no such PROTO.
Answer x3d_create_instance(WorldAnswers& world, const Question& question) {
  Answer answer;
  ScriptRecord& script = world.running();
  const TextContext in = context_of(world, question.node);
  const vrml::NodeType* const type = prototype_named(in, question.text);
  if (!type) return answer;
  if (!world.may_act()) {
    answer.text = "shutdown() cannot create nodes";
    return answer;
  }
  vrml::NodeId made;
  {
    // The instance keeps the text that owns its type. A node of the file itself would never be removed.
    std::optional<vrml::RunTimeText> written;
    std::optional<vrml::WritingFor> writing;
    if (in.owner == 0)
      written.emplace(*in.scene, label_of(script), *in.text);
    else
      writing.emplace(*in.scene, in.owner);
    made = in.scene->create(*type, script.scene->node(script.id).location);
    if (!made) {
      answer.text = "not enough memory for a node";
      return answer;
    }
    (void)vrml::instantiate(*in.scene, made);
  }
  world.execution().scenes().attach(*in.scene);
  answer.good = true;
  answer.node = world.ref(*in.scene, made);
  answer.place =
      static_cast<std::uint32_t>(std::max<std::size_t>(64, type->prototype ? type->prototype->nodes.size() : 0));
  return answer;
}

// Returns a key of the text, its URL, ten times its version, and whether it is a PROTO instance.
Answer x3d_context(WorldAnswers& world, const Question& question) {
  Answer answer;
  const TextContext in = context_of(world, question.node);
  const auto& source = in.text->source();
  answer.good = true;
  answer.items.emplace_back(std::to_string(in.scene->serial()) + ' ' + std::to_string(in.owner) + ' ' +
                            std::to_string(in.instance));
  answer.items.emplace_back(source ? source->url : world.browser().world_url);
  answer.items.emplace_back(static_cast<double>(in.text->version()));
  answer.items.emplace_back(in.instance != 0 ? 1.0 : 0.0);
  answer.items.emplace_back(std::string(in.text->x3d().profile));
  return answer;
}

Answer x3d_stated_components(WorldAnswers& world, const Question& question) {
  Answer answer;
  answer.good = true;
  for (const vrml::X3DStatements::Component& one : context_of(world, question.node).text->x3d().components) {
    answer.items.emplace_back(std::string(one.name));
    answer.items.emplace_back(static_cast<double>(one.level));
  }
  return answer;
}

Answer x3d_metas(WorldAnswers& world, const Question& question) {
  Answer answer;
  answer.good = true;
  for (const vrml::X3DStatements::Meta& one : context_of(world, question.node).text->x3d().metas) {
    answer.items.emplace_back(std::string(one.name));
    answer.items.emplace_back(std::string(one.content));
  }
  return answer;
}

Answer x3d_exported(WorldAnswers& world, const Question& question) {
  Answer answer;
  const TextContext in = context_of(world, question.node);
  for (const vrml::X3DStatements::Export& one : in.text->x3d().exports) {
    if (one.exported != question.text || !in.scene->contains(one.node) || !world.may_read(in.scene->node(one.node)))
      continue;
    answer.good = true;
    answer.node = world.ref(*in.scene, one.node);
    break;
  }
  return answer;
}

constexpr AnswerRow kX3dRows[] = {
    {Ask::x3d_fields, x3d_fields},
    {Ask::x3d_types, x3d_types},
    {Ask::x3d_named, x3d_named},
    {Ask::x3d_roots, x3d_roots},
    {Ask::x3d_set_roots, x3d_set_roots},
    {Ask::x3d_routes, x3d_routes},
    {Ask::x3d_prototypes, x3d_prototypes},
    {Ask::x3d_prototype_fields, x3d_prototype_fields},
    {Ask::x3d_prototype_urls, x3d_prototype_urls},
    {Ask::x3d_create_instance, x3d_create_instance},
    {Ask::x3d_stated_components, x3d_stated_components},
    {Ask::x3d_metas, x3d_metas},
    {Ask::x3d_exported, x3d_exported},
    {Ask::x3d_context, x3d_context},
};

}  // namespace

std::span<const AnswerRow> answers_for_x3d() { return kX3dRows; }

}  // namespace gs::app::script
