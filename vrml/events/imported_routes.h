#pragma once

#include "base/diagnostic.h"
#include "vrml/scene/scene_graph.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <unordered_map>
#include <unordered_set>

namespace gs::vrml {

class Execution;

/// Node, and its scene.
struct ImportedNode {
  SceneGraph* scene = nullptr;  // null if there is no such node
  NodeId node;
};

/// Nodes that X3D scenes share through IMPORT and EXPORT (ISO/IEC 19775-1 4.4.6), and the ROUTEs between them. A ROUTE
/// is connected once its Inlines are loaded, and again if their content is replaced. Part of Execution.
class ImportedRoutes {
 public:
  explicit ImportedRoutes(Execution& execution) : execution_(execution) {}

  /// Connects the ROUTEs with imported nodes that became possible since the last call.
  void connect();
  /// Notes a scene that is attached. If it is new, or has statements, connect() has work.
  void note_scene(const SceneGraph& scene, bool is_new);
  /// Returns the node with this imported name in a scene. Returns an empty result while its Inline is not loaded, and
  /// for unknown names.
  [[nodiscard]] ImportedNode find(SceneGraph& scene, std::string_view imported);
  /// Returns the node that a scene exports under this name. Follows exported nodes that the scene has imported.
  [[nodiscard]] ImportedNode find_exported(SceneGraph& scene, std::string_view exported);
  /// Moves the reported problems to `diagnostics`, each only once: missing EXPORTs, events and equal types.
  void report(Diagnostics& diagnostics);

 private:
  /// Statements of a scene by name.
  struct Names {
    std::unordered_map<std::string_view, const X3DStatements::Import*> imports;
    std::unordered_map<std::string_view, const X3DStatements::Export*> exports;
  };
  const Names& names_of(const SceneGraph& scene);
  [[nodiscard]] ImportedNode find(SceneGraph& scene, std::string_view imported, int depth);
  [[nodiscard]] ImportedNode find_exported(SceneGraph& scene, std::string_view exported, int depth);
  [[nodiscard]] ImportedNode find_in(SceneGraph& scene, NodeId inline_node, std::string_view exported,
                                     SourceLocation location, int depth);
  void connect_routes(SceneGraph& scene);
  void connect_route(SceneGraph& scene, const X3DStatements::ImportedRoute& route);
  void note_problem(const SceneGraph& scene, Severity severity, SourceLocation location, std::string message);

  Execution& execution_;
  std::unordered_map<const SceneGraph*, Names> names_;  // filled during one search
  Diagnostics problems_;
  std::unordered_set<std::string> said_;
  bool dirty_ = false;
};

}  // namespace gs::vrml
