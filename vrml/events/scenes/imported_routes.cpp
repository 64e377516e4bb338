#include "vrml/events/imported_routes.h"

#include "vrml/events/execution.h"

#include <utility>
#include <vector>

namespace gs::vrml {
namespace {

// Maximum number of scenes through which a node may be exported again.
constexpr int kMaxChain = 32;

}  // namespace

void ImportedRoutes::note_scene(const SceneGraph& scene, bool is_new) {
  const X3DStatements& statements = scene.x3d();
  dirty_ = dirty_ || is_new || !statements.exports.empty() || !statements.routes.empty() ||
           !scene.inlines().instance_routes().empty();
}

void ImportedRoutes::connect() {
  if (!std::exchange(dirty_, false)) return;
  std::vector<SceneGraph*> scenes;
  for (const SceneState& state : execution_.scenes().states())
    if (state.scene && !(state.scene->x3d().routes.empty() && state.scene->inlines().instance_routes().empty()))
      scenes.push_back(state.scene);
  for (SceneGraph* const scene : scenes) connect_routes(*scene);
  names_.clear();
}

const ImportedRoutes::Names& ImportedRoutes::names_of(const SceneGraph& scene) {
  const auto [found, fresh] = names_.try_emplace(&scene);
  if (!fresh) return found->second;
  for (const X3DStatements::Import& each : scene.x3d().imports) found->second.imports.try_emplace(each.local, &each);
  for (const X3DStatements::Export& each : scene.x3d().exports) found->second.exports.try_emplace(each.exported, &each);
  return found->second;
}

ImportedNode ImportedRoutes::find(SceneGraph& scene, std::string_view imported) {
  const ImportedNode node = find(scene, imported, 0);
  names_.clear();
  return node;
}

ImportedNode ImportedRoutes::find_exported(SceneGraph& scene, std::string_view exported) {
  const ImportedNode node = find_exported(scene, exported, 0);
  names_.clear();
  return node;
}

ImportedNode ImportedRoutes::find(SceneGraph& scene, std::string_view imported, int depth) {
  const Names& names = names_of(scene);
  const auto found = names.imports.find(imported);
  if (found == names.imports.end() || depth > kMaxChain) return {};
  const X3DStatements::Import& import = *found->second;
  return find_in(scene, import.inline_node, import.exported, import.location, depth);
}

// Finds a node that the content of an Inline exports. `location` is that of the statement that names it.
ImportedNode ImportedRoutes::find_in(SceneGraph& scene, NodeId inline_node, std::string_view exported,
                                     SourceLocation location, int depth) {
  SceneGraph* const content = scene.inlines().of(scene.resolve(inline_node));
  if (!content || !execution_.scenes().has(content)) return {};
  const ImportedNode node = find_exported(*content, exported, depth + 1);
  if (!node.scene && !names_of(*content).exports.contains(exported))
    note_problem(scene, Severity::warning, location,
                 "IMPORT names '" + std::string(exported) + "', but " + content->file_name() + " does not EXPORT it");
  return node;
}

ImportedNode ImportedRoutes::find_exported(SceneGraph& scene, std::string_view exported, int depth) {
  const Names& names = names_of(scene);
  const auto found = names.exports.find(exported);
  if (found == names.exports.end()) return {};
  const X3DStatements::Export& each = *found->second;
  if (!each.node) return find(scene, each.local, depth);
  return scene.contains(each.node) ? ImportedNode{&scene, each.node} : ImportedNode{};
}

void ImportedRoutes::connect_routes(SceneGraph& scene) {
  const std::vector<X3DStatements::ImportedRoute>& routes = scene.x3d().routes;
  for (const X3DStatements::ImportedRoute& route : routes) connect_route(scene, route);
  std::vector<X3DStatements::ImportedRoute>& of_instances = scene.inlines().instance_routes();
  std::erase_if(of_instances, [&](const X3DStatements::ImportedRoute& route) {
    const auto exists = [&](const X3DStatements::RouteEnd& end) {
      return scene.contains(end.node ? end.node : end.inline_node);
    };
    return !exists(route.from) || !exists(route.to);  // a program has removed the instance
  });
  for (const X3DStatements::ImportedRoute& route : of_instances) connect_route(scene, route);
}

void ImportedRoutes::connect_route(SceneGraph& scene, const X3DStatements::ImportedRoute& route) {
  const auto end_of = [&](const X3DStatements::RouteEnd& end) {
    if (end.node) return ImportedNode{&scene, end.node};
    if (end.inline_node) return find_in(scene, end.inline_node, end.name, route.location, 0);
    return find(scene, end.name, 0);
  };
  const ImportedNode from = end_of(route.from), to = end_of(route.to);
  if (!from.scene || !to.scene || !from.scene->contains(from.node) || !to.scene->contains(to.node)) return;
  const NodeType &from_type = *from.scene->node(from.node).type, &to_type = *to.scene->node(to.node).type;
  const Route found{from.node, to.node, from_type.find_event_out(route.from.event),
                    to_type.find_event_in(route.to.event)};
  const auto refuse = [&](std::string message) {
    note_problem(scene, Severity::error, route.location, std::move(message));
  };
  if (!found.event_out) return refuse(from_type.name + " has no eventOut '" + route.from.event + "'");
  if (!found.event_in) return refuse(to_type.name + " has no eventIn '" + route.to.event + "'");
  const std::string ends = "ROUTE from " + std::string(name_of(found.event_out->type)) + " '" + route.from.event +
                           "' to " + std::string(name_of(found.event_in->type)) + " '" + route.to.event + "'";
  if (found.event_out->type != found.event_in->type) return refuse(ends + "; expected equal types");
  if (from.scene != to.scene && holds_nodes(found.event_in->type))
    return refuse(ends + "; nodes cannot be sent to another file");
  (void)execution_.routes().add(*from.scene, *to.scene, found);
}

// Notes a problem once, although its ROUTE is tried again with each new content.
void ImportedRoutes::note_problem(const SceneGraph& scene, Severity severity, SourceLocation location,
                                  std::string message) {
  constexpr std::size_t kMaxSaid = 1000;
  Diagnostic problem{severity, scene.file_name(), location, std::move(message)};
  if (said_.size() < kMaxSaid && said_.insert(problem.text()).second) problems_.add(std::move(problem));
}

void ImportedRoutes::report(Diagnostics& diagnostics) {
  diagnostics.append(problems_);
  problems_ = {};
}

}  // namespace gs::vrml
