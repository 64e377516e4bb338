#include "vrml/printing/written_scope.h"

#include <algorithm>

namespace gs::vrml {

WrittenScope::WrittenScope(const SceneGraph& scene, NodeTranslator& translator, const NodeType* prototype)
    : scene_(scene), translator_(translator) {
  if (!prototype) return;
  for (const IsMapping& mapping : prototype->prototype->mappings) mappings_[mapping.node.index].push_back(&mapping);
}

// Uses a list instead of recursion, so that any scene is safe.
void WrittenScope::count(NodeId root) {
  std::vector<NodeId> waiting{root};
  while (!waiting.empty()) {
    const NodeId id = waiting.back();
    waiting.pop_back();
    if (!scene_.contains(id)) continue;
    if (!seen_.insert(id.index).second) {
      needs_name_.insert(id.index);
      continue;
    }
    const Node& node = scene_.node(id);
    for (std::size_t i = 0; i < node.type->defaults.size(); ++i) {
      if (const auto* one = std::get_if<SFNode>(&node.values[i])) waiting.push_back(*one);
      if (const auto* many = std::get_if<MFNode>(&node.values[i]))
        for (const NodeId child : *many) waiting.push_back(child);
    }
  }
}

void WrittenScope::count(const FieldValue& value) {
  if (const auto* node = std::get_if<SFNode>(&value)) count(*node);
  if (const auto* nodes = std::get_if<MFNode>(&value))
    for (const NodeId child : *nodes) count(child);
}

void WrittenScope::count(const Statement& statement) {
  if (statement.kind == Statement::Kind::node) count(statement.node);
  if (statement.kind != Statement::Kind::route) return;
  needs_name_.insert(statement.route.from.index);
  needs_name_.insert(statement.route.to.index);
}

void WrittenScope::count(const X3DStatements& statements) {
  for (const X3DStatements::Import& each : statements.imports) {
    used_.insert(each.local);
    needs_name_.insert(each.inline_node.index);
  }
  for (const X3DStatements::Export& each : statements.exports) needs_name_.insert(each.node.index);
  for (const X3DStatements::ImportedRoute& each : statements.routes)
    for (const NodeId node : {each.from.node, each.to.node}) needs_name_.insert(node.index);
}

bool WrittenScope::is_printed(NodeId id) const {
  return printed_.contains(id.index) || (scene_.contains(id) && scene_.node(id).type == &browser_node_type());
}

WrittenNode WrittenScope::written(NodeId id) {
  const auto mapped = mappings_.find(id.index);
  WrittenNode written = translator_.written(scene_, id, mapped == mappings_.end() ? nullptr : &mapped->second);
  if (!scene_.node(id).name.empty() || needs_name_.contains(id.index)) written.name = name_of(id);
  return written;
}

const std::string& WrittenScope::name_of(NodeId id) {
  std::string& name = names_[id.index];
  if (!name.empty()) return name;
  const Node& node = scene_.node(id);
  const std::string stem = node.name.empty() ? "_" + node.type->name : std::string(node.name);
  name = stem;
  for (std::size_t& number = suffixes_[stem]; !used_.insert(name).second;) name = stem + "_" + std::to_string(++number);
  return name;
}

std::optional<NamedRoute> WrittenScope::named(const Route& route) {
  if (!translator_.is_written(scene_, route.from) || !translator_.is_written(scene_, route.to)) return std::nullopt;
  const std::string_view event_out = translator_.written_name(*scene_.node(route.from).type, *route.event_out),
                         event_in = translator_.written_name(*scene_.node(route.to).type, *route.event_in);
  if (event_out.empty() || event_in.empty()) return std::nullopt;
  return NamedRoute{name_of(route.from), event_out, name_of(route.to), event_in};
}

bool WrittenScope::has_children(const WrittenField& field) const {
  if (field.made) return true;
  const auto is_put = [&](NodeId id) { return translator_.is_written(scene_, id); };
  if (const auto* one = std::get_if<SFNode>(field.value)) return is_put(*one);
  const auto& many = std::get<MFNode>(*field.value);
  return std::any_of(many.begin(), many.end(), is_put);
}

bool WrittenScope::has_one_child(const WrittenField& field) const {
  const auto* const many = field.made ? nullptr : std::get_if<MFNode>(field.value);
  return many && std::count_if(many->begin(), many->end(), [&](NodeId id) {
                   return scene_.contains(id) && translator_.is_written(scene_, id);
                 }) == 1;
}

bool WrittenScope::has_one_use(const WrittenField& field) const {
  if (field.made || !field.value) return false;
  const auto* const one = std::get_if<SFNode>(field.value);
  const auto* const many = std::get_if<MFNode>(field.value);
  const NodeId id = one ? *one : many && many->size() == 1 ? (*many)[0] : NodeId{};
  return id && printed_.contains(id.index);
}

}  // namespace gs::vrml
