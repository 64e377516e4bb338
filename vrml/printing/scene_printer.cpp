#include "vrml/printing/scene_printer.h"

#include "vrml/scene/imported_use.h"

#include <algorithm>
#include <optional>
#include <utility>

namespace gs::vrml {
namespace {

// Maximum depth, higher than in parsed files. Only scenes with unusual USEs reach it.
constexpr int kMaxDepth = 8000;
bool has_imported_use(const SceneGraph& scene) {
  if (scene.x3d().imports.empty()) return false;
  for (std::uint32_t i = 1; i <= scene.nodes().count(); ++i)
    if (scene.nodes().at(i).type == &imported_use_type()) return true;
  return false;
}

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
  WrittenScope scope(scene, translator_, prototype);
  WrittenScope* const around = std::exchange(scope_, &scope);
  const bool empty_around = std::exchange(is_empty_, true);
  std::vector<Route> routes_around = std::exchange(waiting_routes_, {});
  const X3DStatements* const shared = prototype ? prototype->prototype->shared.get() : &scene_.x3d();
  if (shared) scope.count(*shared);
  // A USE of an imported node follows its IMPORT.
  const bool early = !prototype && has_imported_use(scene);
  if (early) put_imports(*shared, true);
  for (const Statement& statement : statements) scope.count(statement);
  for (const Statement& statement : statements) put_statement(statement);
  for (const Route& route : std::exchange(waiting_routes_, {})) put_statement(route, true);
  if (shared && !early) put_imports(*shared, false);
  if (shared) put_shared_names(*shared);
  scope_ = around;
  is_empty_ = empty_around;
  waiting_routes_ = std::move(routes_around);
}

// Writes a ROUTE if both of its nodes were written; otherwise the ROUTE waits until the `last` try. The text never
// contains nodes outside of the scene, or inside of omitted nodes.
void ScenePrinter::put_statement(const Route& route, bool last) {
  if (!scope_->is_printed(route.from) || !scope_->is_printed(route.to)) {
    if (last)
      translator_.add_loss(kLostRoutes);
    else
      waiting_routes_.push_back(route);
    return;
  }
  const std::optional<NamedRoute> names = scope_->named(route);
  if (!names) return translator_.add_loss(kLostRoutes);
  begin_statement(std::exchange(is_empty_, false), true);
  put_route(*names);
  end_statement();
  output_.drain();
}

void ScenePrinter::put_statement(const Statement& statement) {
  if (statement.kind == Statement::Kind::route) return put_statement(statement.route, false);
  if (const NodeId id = statement.node; statement.kind == Statement::Kind::node && scope_->scene().contains(id) &&
                                        !translator_.is_written(scope_->scene(), id))
    return translator_.add_left_out(*scope_->scene().node(id).type);
  begin_statement(std::exchange(is_empty_, false), false);
  if (statement.kind == Statement::Kind::node) {
    put_child(statement.node, {});
  } else {
    if (const NodeType* const native = stood_for(*statement.type)) translator_.add_fallback(*native);
    put_prototype(*statement.type);
  }
  end_statement();
  output_.drain();
}

// Writes IMPORT statements: after all nodes, or `early`, before them.
void ScenePrinter::put_imports(const X3DStatements& statements, bool early) {
  if (translator_.language() == Language::vrml97) return;
  for (const X3DStatements::Import& each : statements.imports) {
    const bool known = scope_->scene().contains(each.inline_node);
    if (early ? !known : !scope_->is_printed(each.inline_node)) continue;
    begin_statement(early && std::exchange(is_empty_, false), true);
    put_import(
        {known ? std::string_view(scope_->name_of(each.inline_node)) : each.inline_name, each.exported, each.local});
    end_statement();
  }
}

// Writes EXPORT statements, and the ROUTEs of imported nodes, after all nodes.
void ScenePrinter::put_shared_names(const X3DStatements& statements) {
  if (translator_.language() == Language::vrml97) {
    if (!statements.imports.empty()) translator_.add_loss("IMPORTs and ROUTEs of imported nodes are left out");
    if (!statements.exports.empty()) translator_.add_loss("EXPORTs are left out");
    return;
  }
  const auto name_or = [&](NodeId node, std::string_view otherwise) -> std::string_view {
    return scope_->scene().contains(node) ? std::string_view(scope_->name_of(node)) : otherwise;
  };
  // A name without a node is that of an import, or of a node that the reader skipped.
  const auto is_imported = [&](std::string_view name) {
    return std::any_of(statements.imports.begin(), statements.imports.end(),
                       [&](const X3DStatements::Import& each) { return each.local == name; });
  };
  const auto is_known = [&](NodeId node, std::string_view name) {
    return node ? scope_->is_printed(node) : is_imported(name);
  };
  const auto put = [&](auto&& statement) {
    begin_statement(false, true);
    statement();
    end_statement();
  };
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

void ScenePrinter::put_child(NodeId id, std::string_view field) {
  if (!scope_->scene().contains(id) || depth_ > kMaxDepth) return put_null();
  if (scope_->scene().node(id).type == &imported_use_type()) {
    if (translator_.language() == Language::vrml97) return put_null();
    const SFString name = scope_->scene().get<SFString>(id, "name");
    return put_use(imported_use_element(), name.view(), field);
  }
  if (!scope_->begin_node(id))
    return put_use(*translator_.written_type(*scope_->scene().node(id).type), scope_->name_of(id), field);
  const WrittenNode written = scope_->written(id);
  ++depth_;
  put_node(written, field);
  --depth_;
}

WrittenField ScenePrinter::default_value(const NodeType& type, const InterfaceDeclaration& declaration,
                                         FieldValue& moved) {
  WrittenField field{&declaration, declaration.name, declaration.slot >= 0 ? &declaration.initial : nullptr};
  if (auto urls = translator_.moved_default(type, declaration)) {
    moved = std::move(*urls);
    field.value = &moved;
  }
  scope_->count(declaration.initial);
  return field;
}

}  // namespace gs::vrml
