#pragma once

#include "base/noncopyable.h"
#include "vrml/printing/written_node.h"
#include "vrml/scene/scene_graph.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <vector>

namespace gs::vrml {

/// ROUTE with the names that its nodes and events have in the text.
struct NamedRoute {
  std::string_view from, event_out, to, event_in;
};

/// Name scope (VRML97 4.4.3) of a text that is written: the file, or the body of a PROTO. Knows the nodes that the text
/// contains so far, and gives names to nodes that need one. One thread.
class WrittenScope : NonCopyable {
 public:
  /// `prototype` is the PROTO with the body; null for the file.
  WrittenScope(const SceneGraph& scene, NodeTranslator& translator, const NodeType* prototype);

  [[nodiscard]] const SceneGraph& scene() const { return scene_; }
  /// Counts how often the nodes of a tree are used. Nodes with several uses need a name.
  void count(NodeId root);
  void count(const FieldValue& value);
  /// Counts the nodes of a statement, and the ends of a ROUTE.
  void count(const Statement& statement);
  /// Gives names to the nodes of IMPORT and EXPORT statements. Imported names are not available for other nodes.
  void count(const X3DStatements& statements);

  /// Reports whether the text contains a node.
  [[nodiscard]] bool is_printed(NodeId id) const;
  /// Notes that the text contains a node. Returns false if it was noted before, so that a USE is due.
  bool begin_node(NodeId id) { return printed_.insert(id.index).second; }
  /// Returns the node as it is written, with its name if it needs one.
  [[nodiscard]] WrittenNode written(NodeId id);
  /// Returns the name of a node in the text; makes one at first.
  [[nodiscard]] const std::string& name_of(NodeId id);
  /// Returns a ROUTE with names; nullopt if its nodes or events are left out.
  [[nodiscard]] std::optional<NamedRoute> named(const Route& route);

  /// Reports whether a field has a node that the text contains.
  [[nodiscard]] bool has_children(const WrittenField& field) const;
  /// Reports whether the text contains exactly one node of a list.
  [[nodiscard]] bool has_one_child(const WrittenField& field) const;
  /// Reports whether a field has exactly one node, and its text is a USE.
  [[nodiscard]] bool has_one_use(const WrittenField& field) const;

 private:
  const SceneGraph& scene_;
  NodeTranslator& translator_;
  std::unordered_set<std::uint32_t> seen_, printed_, needs_name_;
  std::unordered_map<std::uint32_t, std::string> names_;
  std::unordered_set<std::string> used_;
  std::unordered_map<std::string, std::size_t> suffixes_;
  std::unordered_map<std::uint32_t, IsMappings> mappings_;
};

}  // namespace gs::vrml
