#pragma once

#include "base/noncopyable.h"
#include "vrml/scene/coordinates/units.h"
#include "vrml/scene/scene_graph.h"
#include "vrml/syntax/problems/text_limits.h"
#include "vrml/syntax/prototype_sink.h"
#include "vrml/syntax/route_sink.h"
#include "vrml/syntax/tokens/name_table.h"
#include "vrml/syntax/tokens/recent_types.h"
#include "vrml/syntax/x3d_statement_sink.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <vector>

namespace gs::vrml {

/// Name in a text, and its position.
struct SourceName {
  std::string_view text;
  SourceLocation location;
};

/// Destination of a node. Without a value, the node is a statement of the file or of a PROTO's body.
struct NodeTarget {
  FieldValue* value = nullptr;  // SFNode or MFNode that receives the node
  std::string_view field;       // name of a field that restricts the node's role (VRML97 4.6); otherwise empty
};

/// Start of a node, up to its opening brace.
struct NodeHeader {
  SourceName type;
  std::string_view name;  // DEF name; empty if the node has none
  NodeTarget target;
  std::size_t depth = 0;  // number of constructs around the node; Limits::nesting limits it
};

/// Node with an incomplete body.
struct OpenNode {
  NodeId id;  // null if the grammar must skip the body
  const NodeType* type = nullptr;
  NodeType* own_type = nullptr;    // type of a Script or shader, which the body extends; null for other nodes
  std::uint64_t fields_given = 0;  // one bit per slot below 64 with a value in the text
};

/// Builder of a scene for the grammars of all encodings: nodes, DEF and USE, fields, PROTO, EXTERNPROTO, IS and ROUTE.
///
/// A grammar reads text and values, and stores its stack of open constructs. The sink resolves names and types, checks
/// roles, access types and limits, and reports problems at the positions that the grammar passes. Calls of begin_ and
/// end_ functions are nested like the constructs. After each call, the scene contains all received data. Names may come
/// from untrusted text. The grammar must stop if limits().is_exhausted() returns true. One thread.
class SceneSink : NonCopyable {
 public:
  /// `scene` and `diagnostics` must outlive the sink. New nodes belong to the text `scene.texts().writing()`.
  SceneSink(SceneGraph& scene, Diagnostics& diagnostics);

  [[nodiscard]] SceneGraph& scene() { return scene_; }
  [[nodiscard]] TextProblems& problems() { return problems_; }
  [[nodiscard]] TextLimits& limits() { return limits_; }
  /// Returns the part for PROFILE, COMPONENT, META, UNIT, IMPORT and EXPORT of X3D.
  [[nodiscard]] X3DStatementSink& statements() { return x3d_; }
  /// Returns the part for PROTO, EXTERNPROTO, IS and the interfaces of Scripts.
  [[nodiscard]] PrototypeSink& prototypes() { return prototypes_; }
  /// Returns the part for ROUTEs.
  [[nodiscard]] RouteSink& routes() { return routes_; }

  /// Returns the node type with this name in the current scope (VRML97 4.4.3, 4.8.4); null if there is none.
  [[nodiscard]] const NodeType* find_type(std::string_view name);
  /// Returns the stand-in for a type of other browsers that find_type() does not know; null if there is none. Reports
  /// its first use.
  [[nodiscard]] const NodeType* find_stand_in(SourceName name);
  /// Makes a node. The grammar then reads the body and calls end_node(). If the result has no id, the grammar must skip
  /// the body: the type is unknown, or a limit is reached.
  [[nodiscard]] OpenNode begin_node(const NodeHeader& header);
  /// Names a node after other parts of its body, because members of JSON have no order.
  void name_node(const OpenNode& node, SourceName name);
  /// Completes a node: checks its measures, and expands it if it is a PROTO instance.
  void end_node(NodeId id);
  /// Adds the node with this DEF name to another destination (USE).
  void use_node(SourceName name, NodeTarget target);

  /// Returns the field or exposedField with this name. If the node has none, reports it and returns null.
  /// May give a node of VRML97 the X3D type of its name (SceneSink::extend).
  [[nodiscard]] const InterfaceDeclaration* find_field(OpenNode& node, SourceName name);
  /// Returns the storage for the value of a field. It becomes invalid with the next declare() for this node. Nodes must
  /// be added to it with begin_node() or use_node().
  [[nodiscard]] NodeTarget target_of(const OpenNode& node, const InterfaceDeclaration& field);
  /// Marks that the text gives a value to the field. Reports fields with several values.
  void field_given(OpenNode& node, const InterfaceDeclaration& field, SourceName name);
  /// Adds the ROUTEs that wait for the end of the scope. The grammar calls it once, at the end of the text.
  void finish();

 private:
  friend class X3DStatementSink;
  friend class PrototypeSink;
  friend class RouteSink;
  /// Name scope (VRML97 4.4.3): the file, or the body of a PROTO.
  struct Scope {
    NameTable names;  // nodes by DEF name; null for a skipped node
    std::unordered_map<std::string_view, const NodeType*> types;
    std::vector<RouteNames> waiting_routes;
    std::unordered_set<std::string> imported_names;
    NodeType* prototype = nullptr;  // PROTO with this body; null for the file
    std::size_t open_nodes = 0;
    std::size_t interfaces_around = 0;  // number of open interfaces at the start of the scope
    bool has_extended = false;          // extend() has changed the type of a node
    /// Returns the statements of the scope; `text` is the text of the file.
    [[nodiscard]] std::vector<Statement>& statements(SourceText& text);
  };
  /// Units of the text, and the measures of its fields.
  struct Measures {
    Units units;
    std::unordered_map<const InterfaceDeclaration*, Measure> of_fields;  // PROTO fields that IS connects to measures
    /// Returns the factor for the values of a field.
    [[nodiscard]] double unit_of(const NodeType& type, const InterfaceDeclaration& field) const;
    /// Converts the lists that the text gives to a node.
    void convert_lists(Node& node) const;
  };

  [[nodiscard]] bool in_prototype_body() const { return scopes_.back().prototype && open_interfaces_ == 0; }
  [[nodiscard]] const NodeType* search_type(std::string_view name) const;
  [[nodiscard]] const NodeType* find_x3d_type(SourceName name);
  [[nodiscard]] bool is_lenient(const NodeType& type) const;
  void check_support(const NodeType& type, SourceLocation location);
  void skip_unknown(const NodeHeader& header);
  [[nodiscard]] bool take_extension(const NodeType& type, SourceName name);
  [[nodiscard]] const NodeType* x3d_type_with(NodeId node, std::string_view interface) const;
  void use_imported(SourceName name, NodeTarget target);
  bool extend(NodeId node, SourceName interface);
  [[nodiscard]] const InterfaceDeclaration* add_script_field(OpenNode& node, SourceName name);
  void place(NodeId node, NodeTarget target);
  void place_checked(NodeId node, NodeTarget target, SourceLocation location);
  bool place_in_shape(NodeId node, NodeTarget target);

  SceneGraph& scene_;
  SourceText& text_;  // text that is read: the scene's file or a run-time text
  TextProblems problems_;
  TextLimits limits_;
  X3DStatementSink x3d_{*this};
  PrototypeSink prototypes_{*this};
  RouteSink routes_{*this};
  std::vector<Scope> scopes_;
  RecentTypes recent_types_;  // of find_type() in the current scope
  NodeId made_shape_;         // last Shape that was made for misplaced nodes
  Measures measures_;
  std::size_t routes_before_ = 0;                    // ROUTEs of the scene before this text
  std::size_t open_interfaces_ = 0;                  // open PROTO interfaces; their default nodes are live
  std::unordered_set<std::string_view> said_types_;  // types with a reported problem: declared twice, of X3D, ignored
  std::unordered_map<std::string_view, const NodeType*> stand_ins_;  // stand-ins for the types that the text uses
  std::unordered_set<std::string> said_extensions_;                  // fields of other browsers that were reported
  std::unordered_set<std::string> unknown_types_;                    // types that were reported as unknown
  std::unordered_set<std::uint64_t> said_measures_;                  // positions of nodes with invalid measures
};

}  // namespace gs::vrml
