#include "vrml/printing/scene_printer.h"

#include <algorithm>
#include <optional>
#include <utility>

namespace gs::vrml {
namespace {

// Maximum depth, higher than in parsed files. Only scenes with unusual USEs reach it.
constexpr int kMaxDepth = 8000;
constexpr const char* kLostRoutes = "ROUTEs from or to nodes and events that are left out";

}  // namespace

void ScenePrinter::print(const TextHead& head) {
  begin_text(head);
  put_scope(scene_, scene_.statements(), nullptr);
  end_text();
  output_.flush();
}

void ScenePrinter::put_scope(const SceneGraph& scene, const std::vector<Statement>& statements,
                             const NodeType* prototype) {
  Scope scope{scene};
  Scope* const around = std::exchange(scope_, &scope);
  if (!around) begin_shared_names();
  for (const Statement& statement : statements) {
    if (statement.kind == Statement::Kind::node) count(statement.node);
    if (statement.kind == Statement::Kind::route) {
      scope.needs_name.insert(statement.route.from.index);
      scope.needs_name.insert(statement.route.to.index);
    }
  }
  if (prototype)
    for (const IsMapping& mapping : prototype->prototype->mappings)
      scope.mappings[mapping.node.index].push_back(&mapping);
  for (const Statement& statement : statements) put_statement(statement);
  for (const Route& route : std::exchange(scope.waiting_routes, {})) put_statement(route, true);
  if (!around) put_shared_names();
  scope_ = around;
}

bool ScenePrinter::is_printed(NodeId id) const {
  return scope_->printed.contains(id.index) ||
         (scope_->scene.contains(id) && scope_->scene.node(id).type == &browser_node_type());
}

// Writes a ROUTE if both of its nodes were written; otherwise the ROUTE waits until the `last` try. The text never
// contains nodes outside of the scene, or inside of omitted nodes.
void ScenePrinter::put_statement(const Route& route, bool last) {
  if (!is_printed(route.from) || !is_printed(route.to)) {
    if (last)
      translator_.add_loss(kLostRoutes);
    else
      scope_->waiting_routes.push_back(route);
    return;
  }
  const std::optional<NamedRoute> names = named(route);
  if (!names) return translator_.add_loss(kLostRoutes);
  begin_statement(std::exchange(scope_->is_empty, false), true);
  put_route(*names);
  end_statement();
  output_.drain();
}

void ScenePrinter::put_statement(const Statement& statement) {
  if (statement.kind == Statement::Kind::route) return put_statement(statement.route, false);
  if (const NodeId id = statement.node; statement.kind == Statement::Kind::node && scope_->scene.contains(id) &&
                                        !translator_.is_written(scope_->scene, id))
    return translator_.add_left_out(*scope_->scene.node(id).type);
  begin_statement(std::exchange(scope_->is_empty, false), false);
  if (statement.kind == Statement::Kind::node) {
    put_child(statement.node, {});
  } else {
    if (const NodeType* const native = stood_for(*statement.type)) translator_.add_fallback(*native);
    put_prototype(*statement.type);
  }
  end_statement();
  output_.drain();
}

// Gives names to the nodes of IMPORT and EXPORT statements. Imported names are not available for other nodes.
void ScenePrinter::begin_shared_names() {
  const X3DStatements& statements = scene_.x3d();
  for (const X3DStatements::Import& each : statements.imports) {
    scope_->used.insert(each.local);
    scope_->needs_name.insert(each.inline_node.index);
  }
  for (const X3DStatements::Export& each : statements.exports) scope_->needs_name.insert(each.node.index);
  for (const X3DStatements::ImportedRoute& each : statements.routes)
    for (const NodeId node : {each.from.node, each.to.node}) scope_->needs_name.insert(node.index);
}

// Writes IMPORT and EXPORT statements, and the ROUTEs of imported nodes, after all nodes.
void ScenePrinter::put_shared_names() {
  const X3DStatements& statements = scene_.x3d();
  if (translator_.language() == Language::vrml97) {
    if (!statements.imports.empty()) translator_.add_loss("IMPORTs and ROUTEs of imported nodes are left out");
    if (!statements.exports.empty()) translator_.add_loss("EXPORTs are left out");
    return;
  }
  const auto name_or = [&](NodeId node, std::string_view otherwise) -> std::string_view {
    return scene_.contains(node) ? std::string_view(name_of_node(node)) : otherwise;
  };
  // A name without a node is that of an import, or of a node that the reader skipped.
  const auto is_imported = [&](std::string_view name) {
    return std::any_of(statements.imports.begin(), statements.imports.end(),
                       [&](const X3DStatements::Import& each) { return each.local == name; });
  };
  const auto is_known = [&](NodeId node, std::string_view name) { return node ? is_printed(node) : is_imported(name); };
  const auto put = [&](auto&& statement) {
    begin_statement(false, true);
    statement();
    end_statement();
  };
  for (const X3DStatements::Import& each : statements.imports)
    if (is_printed(each.inline_node))
      put([&] { put_import({name_or(each.inline_node, each.inline_name), each.exported, each.local}); });
  for (const X3DStatements::Export& each : statements.exports)
    if (is_known(each.node, each.local)) put([&] { put_export({{}, each.exported, name_or(each.node, each.local)}); });
  for (const X3DStatements::ImportedRoute& each : statements.routes)
    if (is_known(each.from.node, each.from.name) && is_known(each.to.node, each.to.name))
      put([&] {
        put_route({name_or(each.from.node, each.from.name), each.from.event, name_or(each.to.node, each.to.name),
                   each.to.event});
      });
}

void ScenePrinter::put_body(const NodeType& type) {
  put_scope(*type.prototype->scene, type.prototype->statements, &type);
}

// Counts how often each node is used. Uses a list instead of recursion, so that any scene is safe.
void ScenePrinter::count(NodeId root) {
  std::vector<NodeId> waiting{root};
  while (!waiting.empty()) {
    const NodeId id = waiting.back();
    waiting.pop_back();
    if (!scope_->scene.contains(id)) continue;
    if (!scope_->seen.insert(id.index).second) {
      scope_->needs_name.insert(id.index);
      continue;
    }
    const Node& node = scope_->scene.node(id);
    for (std::size_t i = 0; i < node.type->defaults.size(); ++i) {
      if (const auto* one = std::get_if<SFNode>(&node.values[i])) waiting.push_back(*one);
      if (const auto* many = std::get_if<MFNode>(&node.values[i]))
        for (const NodeId child : *many) waiting.push_back(child);
    }
  }
}

const std::string& ScenePrinter::name_of_node(NodeId id) {
  std::string& name = scope_->names[id.index];
  if (!name.empty()) return name;
  const Node& node = scope_->scene.node(id);
  const std::string stem = node.name.empty() ? "_" + node.type->name : std::string(node.name);
  name = stem;
  for (std::size_t& number = scope_->suffixes[stem]; !scope_->used.insert(name).second;)
    name = stem + "_" + std::to_string(++number);
  return name;
}

void ScenePrinter::put_child(NodeId id, std::string_view field) {
  if (!scope_->scene.contains(id) || depth_ > kMaxDepth) return put_null();
  const Node& node = scope_->scene.node(id);
  if (!scope_->printed.insert(id.index).second)
    return put_use(*translator_.written_type(*node.type), name_of_node(id), field);
  const auto mapped = scope_->mappings.find(id.index);
  WrittenNode written =
      translator_.written(scope_->scene, id, mapped == scope_->mappings.end() ? nullptr : &mapped->second);
  if (!node.name.empty() || scope_->needs_name.contains(id.index)) written.name = name_of_node(id);
  ++depth_;
  put_node(written, field);
  --depth_;
}

bool ScenePrinter::has_children(const WrittenField& field) {
  if (field.made) return true;
  const auto is_put = [&](NodeId id) { return translator_.is_written(scope_->scene, id); };
  if (const auto* one = std::get_if<SFNode>(field.value)) return is_put(*one);
  const auto& many = std::get<MFNode>(*field.value);
  return std::any_of(many.begin(), many.end(), is_put);
}

bool ScenePrinter::has_one_child(const WrittenField& field) {
  const auto* const many = field.made ? nullptr : std::get_if<MFNode>(field.value);
  return many && std::count_if(many->begin(), many->end(), [&](NodeId id) {
                   return scope_->scene.contains(id) && translator_.is_written(scope_->scene, id);
                 }) == 1;
}

bool ScenePrinter::has_one_use(const WrittenField& field) {
  if (field.made || !field.value) return false;
  const auto* const one = std::get_if<SFNode>(field.value);
  const auto* const many = std::get_if<MFNode>(field.value);
  const NodeId id = one ? *one : many && many->size() == 1 ? (*many)[0] : NodeId{};
  return id && scope_->printed.contains(id.index);
}

WrittenField ScenePrinter::default_value(const NodeType& type, const InterfaceDeclaration& declaration,
                                         FieldValue& moved) {
  WrittenField field{&declaration, declaration.name, declaration.slot >= 0 ? &declaration.initial : nullptr};
  if (auto urls = translator_.moved_default(type, declaration)) {
    moved = std::move(*urls);
    field.value = &moved;
  }
  if (const auto* node = std::get_if<SFNode>(&declaration.initial)) count(*node);
  if (const auto* nodes = std::get_if<MFNode>(&declaration.initial))
    for (const NodeId child : *nodes) count(child);
  return field;
}

std::optional<ScenePrinter::NamedRoute> ScenePrinter::named(const Route& route) {
  const SceneGraph& scene = scope_->scene;
  if (!translator_.is_written(scene, route.from) || !translator_.is_written(scene, route.to)) return std::nullopt;
  const std::string_view event_out = translator_.written_name(*scene.node(route.from).type, *route.event_out),
                         event_in = translator_.written_name(*scene.node(route.to).type, *route.event_in);
  if (event_out.empty() || event_in.empty()) return std::nullopt;
  return NamedRoute{name_of_node(route.from), event_out, name_of_node(route.to), event_in};
}

}  // namespace gs::vrml
