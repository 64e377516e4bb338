#pragma once

#include "vrml/scene/scene_graph.h"
#include "vrml/syntax/name_table.h"
#include "vrml/syntax/problems/text_limits.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <vector>

namespace gs::vrml {

/// Name in a text, with its position.
struct SourceName {
  std::string_view text;
  SourceLocation location;
};

/// Receiver of a node. Without a value, the node is a statement of the file or of the PROTO's body.
struct NodeTarget {
  FieldValue* value = nullptr;  // an SFNode or MFNode
  std::string_view field;       // name of a field that restricts the node's role (VRML97 4.6); empty if none does
};

/// Start of a node, as a grammar reads it.
struct NodeHeader {
  SourceName type;
  std::string_view name;  // DEF name; empty if the node has none
  NodeTarget target;
  std::size_t depth = 0;  // number of constructs around the node, for Limits::nesting
};

/// Node with an open body.
struct OpenNode {
  NodeId id;  // null if the grammar must skip the body
  const NodeType* type = nullptr;
  NodeType* own_type = nullptr;    // the type of a Script, which the body extends; null for other nodes
  std::uint64_t fields_given = 0;  // bit mask of the slots below 64
};

/// ROUTE from.event_out TO to.event_in, by name.
struct RouteNames {
  std::string from, event_out, to, event_in;
  SourceLocation location;
};

/// Builder of a scene for the grammars of all encodings: nodes, DEF and USE, fields, PROTO, EXTERNPROTO, IS and ROUTE.
///
/// A grammar reads text and values, and keeps its stack of open constructs. The sink resolves names and types, checks
/// roles, access types and limits, and reports problems at the positions that the grammar supplies. begin_ and end_
/// calls nest like the constructs. The scene contains all received data after each call. Names may come from untrusted
/// text; the grammar must stop once limits().is_exhausted() returns true. Single-threaded.
class SceneSink {
 public:
  /// `scene` and `diagnostics` must outlive the sink. Nodes are made for `scene.writing()`.
  SceneSink(SceneGraph& scene, Diagnostics& diagnostics);
  SceneSink(const SceneSink&) = delete;
  SceneSink& operator=(const SceneSink&) = delete;

  [[nodiscard]] SceneGraph& scene() { return scene_; }
  [[nodiscard]] TextProblems& problems() { return problems_; }
  [[nodiscard]] TextLimits& limits() { return limits_; }

  /// Returns the node type of this name in the present scope (VRML97 4.4.3, 4.8.4), or null.
  [[nodiscard]] const NodeType* find_type(std::string_view name) const;
  /// Makes a node. The grammar reads its body and calls end_node(), or skips the body if the result has no id: its type
  /// is unknown, or a limit is reached.
  [[nodiscard]] OpenNode begin_node(const NodeHeader& header);
  /// Completes a node: checks its measures and expands a PROTO instance.
  void end_node(NodeId id);
  /// Adds the node with this DEF name once more.
  void use_node(SourceName name, NodeTarget target);

  /// Returns the field or exposedField of the node. Reports an unknown name and returns null.
  [[nodiscard]] const InterfaceDeclaration* find_field(const OpenNode& node, SourceName name);
  /// Returns the storage for the field's value; invalid after the next declare() for this node. Nodes in it must pass
  /// through begin_node() or use_node().
  [[nodiscard]] NodeTarget target_of(const OpenNode& node, const InterfaceDeclaration& field);
  /// Notes that the text gives the field a value. Reports fields with several values.
  void field_given(OpenNode& node, const InterfaceDeclaration& field, SourceName name);
  /// Maps a field or event of the node to one of the PROTO's interface with IS (VRML97 4.8.2).
  void connect(const OpenNode& node, SourceName inner, SourceName outer);

  /// Begins the interface of a PROTO or EXTERNPROTO. After end_interface(), a PROTO needs begin_body() and end_body(),
  /// and an EXTERNPROTO end_external(); a broken declaration ends without them.
  [[nodiscard]] NodeType& begin_prototype(SourceName name, bool external);
  /// Reports whether a PROTO, EXTERNPROTO or Script may declare this interface. It may be declared only once.
  [[nodiscard]] bool may_declare(const NodeType& type, const InterfaceDeclaration& declaration,
                                 SourceLocation location);
  /// Adds a declaration to a PROTO, EXTERNPROTO, or to the type of the Script `script`.
  void declare(NodeType& type, NodeId script, InterfaceDeclaration declaration);
  void end_interface() { --open_interfaces_; }
  void begin_body(NodeType& type);
  void end_body();
  void end_external(NodeType& type, MFString url);

  /// Adds a ROUTE. If one of its nodes is not defined yet, the ROUTE waits until the scope ends.
  void add_route(const RouteNames& route);
  /// Ends the text: adds the waiting ROUTEs. Call once, after all constructs have ended.
  void finish() { add_waiting_routes(); }

 private:
  /// Name scope (VRML97 4.4.3): the file, or the body of a PROTO.
  struct Scope {
    NameTable names;  // a null node marks a skipped one
    std::unordered_map<std::string_view, const NodeType*> types;
    std::vector<RouteNames> waiting_routes;
    NodeType* prototype = nullptr;  // PROTO of this body; null for the file
    std::size_t open_nodes = 0;
    std::size_t interfaces_around = 0;  // open interfaces at the start of the scope
  };

  [[nodiscard]] bool in_prototype_body() const { return scopes_.back().prototype && open_interfaces_ == 0; }
  [[nodiscard]] const NodeType* find_stand_in(SourceName name);
  [[nodiscard]] std::vector<Statement>& statements();
  void skip_unknown(const NodeHeader& header);
  void place(NodeId node, NodeTarget target);
  void add_type(NodeType& type);
  void connect_route(const RouteNames& wanted, NodeId from, NodeId to);
  void add_waiting_routes();

  SceneGraph& scene_;
  SourceText& text_;  // text being read: the scene's file or a run-time text
  TextProblems problems_;
  TextLimits limits_;
  std::vector<Scope> scopes_;
  std::size_t open_interfaces_ = 0;                  // open PROTO interfaces; their default nodes are live
  std::unordered_set<std::string_view> said_types_;  // names reported as declared twice
  std::unordered_map<std::string_view, const NodeType*> stand_ins_;  // stand-ins that were needed
  std::unordered_set<std::string> unknown_types_;                    // types reported as unknown
  std::unordered_set<std::uint64_t> said_measures_;                  // positions of nodes with invalid measures
};

}  // namespace gs::vrml
