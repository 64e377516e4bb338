#pragma once

#include "vrml/scene/budget.h"
#include "vrml/scene/diagnostic.h"
#include "vrml/scene/node_type.h"

#include <cassert>
#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace gs::vrml {

/// One node: its type and one value for each slot of the type.
struct Node {
  const NodeType* type = nullptr;
  FieldValue* values = nullptr;      // type->defaults.size() of them, owned by the scene
  std::string_view name;             // DEF name or empty; bytes owned by the scene
  const SceneGraph* text = nullptr;  // of the file that the node was written in: of a copy, that of the PROTO's body
  SourceLocation location;
  std::uint32_t value_capacity = 0;
  std::uint32_t generation = 1;
  std::uint64_t fields_set = 0;    // of an EXTERNPROTO instance: the slots (below 64) that have a value of their own
  bool in_prototype_body = false;  // part of a PROTO's declaration, not of the world
  MFNode expansion;                // of a PROTO instance: the nodes of its body; the first one stands for it
  std::uint32_t expansion_first =
      0;  // of a PROTO instance: index of the copy of Prototype::nodes[0]; the others follow
};

/// ROUTE from.event_out TO to.event_in (VRML97 4.10.2). The declarations belong to the nodes' types.
struct Route {
  NodeId from, to;
  const InterfaceDeclaration* event_out = nullptr;
  const InterfaceDeclaration* event_in = nullptr;
  friend bool operator==(const Route&, const Route&) = default;
};

/// `field IS name` in a PROTO body (VRML97 4.8.2).
struct IsMapping {
  NodeId node;
  const InterfaceDeclaration* inner = nullptr;  // of node's type
  const InterfaceDeclaration* outer = nullptr;  // of the PROTO's interface
};

/// Statements in the order of the file, which printing keeps.
struct Statement {
  enum class Kind : std::uint8_t { node, prototype, route };
  Kind kind;
  NodeId node;                     // Kind::node
  const NodeType* type = nullptr;  // Kind::prototype: PROTO or EXTERNPROTO
  Route route;                     // Kind::route
};

/// The body of a PROTO: the nodes that each instance gets copies of.
struct Prototype {
  std::vector<Statement> statements;
  std::vector<NodeId> nodes;  // all, in the order in which they were made
  std::vector<IsMapping> mappings;
  const SceneGraph* scene = nullptr;  // whose arena holds the nodes
  bool complete = false;              // the closing brace was seen
  // What one instance makes, with the instances in it; known when complete.
  std::uint64_t instance_nodes = 0, instance_bytes = 0;
  std::uint64_t body_bytes = 0;  // of this: without the instances in it
};

/// A world or a part of it: the arena of its nodes, its PROTOs, its ROUTEs.
///
/// Owned by one thread at a time. Cycles between nodes are allowed and cost nothing, because nodes
/// are freed with the scene. Node references stay valid while nodes are added.
class SceneGraph {
 public:
  /// `file_name` is what diagnostics call this text. Its nodes are drawn from `budget`, which the scenes of a world
  /// share.
  SceneGraph(std::string file_name, std::shared_ptr<Budget> budget);
  /// A world of its own.
  explicit SceneGraph(std::string file_name = {}, const Limits& limits = {});
  ~SceneGraph();
  SceneGraph(const SceneGraph&) = delete;
  SceneGraph& operator=(const SceneGraph&) = delete;

  /// A new node with its type's default values. Null NodeId when `limits.nodes` is reached or the budget spent.
  /// `type` must live as long as the scene: built in, or owned by it or by an attached library.
  NodeId create(const NodeType& type, SourceLocation location = {});

  [[nodiscard]] Node& node(NodeId id) {
    assert(contains(id));
    return nodes_[id.index];
  }
  [[nodiscard]] const Node& node(NodeId id) const {
    assert(contains(id));
    return nodes_[id.index];
  }
  [[nodiscard]] bool contains(NodeId id) const {
    return id && id.index < nodes_.size() && nodes_[id.index].generation == id.generation;
  }
  /// Nodes made so far; ids 1..node_count() in order of making.
  [[nodiscard]] std::size_t node_count() const { return nodes_.size() - 1; }
  [[nodiscard]] NodeId id_at(std::uint32_t index) const { return {index, nodes_[index].generation}; }

  /// The value of a field that the node's type declares with C++ type T; asserts that it does.
  template <class T>
  [[nodiscard]] const T& get(NodeId id, std::string_view field) const {
    const Node& n = node(id);
    const InterfaceDeclaration* declaration = n.type->find_field(field);
    assert(declaration && std::holds_alternative<T>(n.values[declaration->slot]));
    return *std::get_if<T>(&n.values[declaration->slot]);
  }
  /// Sets a field, also of a type the importers build; asserts that the type declares it so.
  template <class T>
  void set(NodeId id, std::string_view field, T value) {
    Node& n = node(id);
    const InterfaceDeclaration* declaration = n.type->find_field(field);
    assert(declaration && std::holds_alternative<T>(n.values[declaration->slot]));
    *std::get_if<T>(&n.values[declaration->slot]) = std::move(value);
  }

  /// The node that `id` stands for: a PROTO instance's first body node, through nested instances
  /// (VRML97 4.8.3); `id` itself for any other; null when the instance has no content (yet).
  [[nodiscard]] NodeId resolve(NodeId id) const;
  /// `resolve(id)` if that node is of the built-in type `type_name`, else null.
  [[nodiscard]] NodeId resolve_as(NodeId id, std::string_view type_name) const;

  /// The scene of the file in which the value of a slot was written: that of the node, unless IS handed the value on
  /// (VRML97 4.8.2). It tells what a url is relative to, and what it may name.
  [[nodiscard]] const SceneGraph& text_of(NodeId id, int slot) const;
  void set_text(NodeId id, int slot, const SceneGraph& text);

  void set_name(NodeId id, std::string_view name);
  /// A copy of `name` that lives as long as the scene.
  const std::string* keep_name(std::string_view name);
  /// Adds a declaration to the type that the Script `id` alone has, and its value to the node.
  void declare(NodeId id, NodeType& type, InterfaceDeclaration declaration);

  /// Appends a top-level node: to `roots` and to the statements.
  void add_root(NodeId id);
  [[nodiscard]] const MFNode& roots() const { return roots_; }
  [[nodiscard]] std::vector<Statement>& statements() { return statements_; }
  [[nodiscard]] const std::vector<Statement>& statements() const { return statements_; }
  /// ROUTEs of the live world: top-level ones and those of PROTO instances.
  [[nodiscard]] std::vector<Route>& routes() { return routes_; }
  [[nodiscard]] const std::vector<Route>& routes() const { return routes_; }

  /// A PROTO, EXTERNPROTO or Script type that lives as long as the scene.
  NodeType& add_type(std::unique_ptr<NodeType> type);
  [[nodiscard]] const std::deque<std::unique_ptr<NodeType>>& types() const { return types_; }

  /// Content of an Inline node; it has a name scope of its own (VRML97 4.4.3).
  void attach_inline(NodeId inline_node, std::unique_ptr<SceneGraph> content);
  /// Null while nothing has been attached.
  [[nodiscard]] SceneGraph* inlined(NodeId inline_node) const;
  [[nodiscard]] const std::unordered_map<std::uint32_t, std::unique_ptr<SceneGraph>>& inlines() const {
    return inlines_;
  }
  /// Keeps a scene alive whose PROTOs are used here through EXTERNPROTO.
  SceneGraph& attach_library(std::unique_ptr<SceneGraph> library);

  /// Counts `count` more nodes of `bytes` as copies for PROTO instances; false when the limit is reached.
  [[nodiscard]] bool reserve_expansion(std::size_t count, std::size_t bytes);
  /// Draws memory for names, lists and the like from the budget. False when it is spent, and from then on.
  [[nodiscard]] bool charge(std::size_t bytes);
  /// Whether something was left out because the budget for nodes is spent.
  [[nodiscard]] bool exhausted() const { return exhausted_; }

  [[nodiscard]] const std::string& file_name() const { return file_name_; }
  [[nodiscard]] const Limits& limits() const { return budget_->limits(); }
  [[nodiscard]] const std::shared_ptr<Budget>& budget() const { return budget_; }

 private:
  FieldValue* allocate_values(std::size_t count);

  std::string file_name_;
  std::shared_ptr<Budget> budget_;
  Share nodes_share_, instances_share_;
  std::size_t charged_ = 0;  // of nodes_share_
  bool exhausted_ = false;
  std::size_t expanded_nodes_ = 0;
  std::deque<Node> nodes_;  // [0] is unused: index 0 is NULL
  std::vector<std::unique_ptr<std::byte[]>> value_blocks_;
  std::size_t block_left_ = 0;
  std::byte* block_next_ = nullptr;
  std::deque<std::string> names_;
  MFNode roots_;
  std::vector<Statement> statements_;
  std::vector<Route> routes_;
  std::unordered_map<std::uint64_t, const SceneGraph*> value_texts_;  // by node and slot, where it is not the node's
  std::deque<std::unique_ptr<NodeType>> types_;
  std::unordered_map<std::uint32_t, std::unique_ptr<SceneGraph>> inlines_;
  std::vector<std::unique_ptr<SceneGraph>> libraries_;
};

}  // namespace gs::vrml
