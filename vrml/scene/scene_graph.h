#pragma once

#include "base/budget.h"
#include "base/diagnostic.h"
#include "vrml/scene/node_type.h"
#include "vrml/scene/source_text.h"

#include <cassert>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

namespace gs::vrml {

/// Node: its type, and one value for each slot of the type.
struct Node {
  const NodeType* type = nullptr;
  FieldValue* values = nullptr;  // type->defaults.size() values, which the scene owns
  std::string_view name;  // DEF name or empty; the text owns the bytes
  const SourceText* text = nullptr;  // text in which the node was written; for a copy, the text of the PROTO's body
  SourceLocation location;
  std::uint32_t value_capacity = 0;
  std::uint32_t generation = 0;  // generation of its NodeId
  std::uint64_t fields_set = 0;  // EXTERNPROTO instances: one bit per slot below 64 with an explicit value
  bool in_prototype_body = false;  // belongs to the declaration of a PROTO, not to the world
  bool recycled = false;  // another node had its index before
  bool strings_set = false;        // an event has set an MFString field
  std::uint32_t owner = 0;  // index of the run-time text that it was made for; 0 means the file
  MFNode expansion;  // PROTO instances: copies of the body's nodes; the first one represents the instance
  /// PROTO instances: index of the copy of Prototype::nodes[0]; the other copies follow. Nodes in the body of a PROTO:
  /// index in Prototype::nodes.
  std::uint32_t expansion_first = 0;
  std::uint32_t instance = 0;  // copies in a PROTO instance: index of the instance
};

/// IS statement in the body of a PROTO: `field IS name` (VRML97 4.8.2).
struct IsMapping {
  NodeId node;
  const InterfaceDeclaration* inner = nullptr;  // declaration in the node's type
  const InterfaceDeclaration* outer = nullptr;  // declaration in the PROTO's interface
};

/// Body of a PROTO. Each instance gets copies of its nodes.
struct Prototype {
  std::vector<Statement> statements;
  std::vector<NodeId> nodes;  // all nodes in the order of creation; see SceneGraph::put_in_body
  std::vector<IsMapping> mappings;
  const SceneGraph* scene = nullptr;  // scene with these nodes in its arena
  const SourceText* text = nullptr;   // text that declares the PROTO
  bool complete = false;              // the closing brace was read
  // Number of nodes and bytes of one instance, including nested instances. Set if complete.
  std::uint64_t instance_nodes = 0, instance_bytes = 0;
  std::uint64_t body_bytes = 0;  // bytes without nested instances
};

/// World or a part of it: the arena of its nodes, its PROTOs and ROUTEs, and the text of its file.
///
/// One thread owns the scene at a time. References to nodes stay valid while nodes are added. Nodes of the file are
/// freed with the scene, so that cycles between nodes do no harm. Nodes made at run time have separate texts
/// (RunTimeText). `remove` frees such nodes, and their indices are used again. The last node of a run-time text frees
/// the text's names, types, libraries and budget.
class SceneGraph : public SourceText {
 public:
  /// `file_name` identifies the file in diagnostics. Memory for nodes is charged to `budget`, which all scenes of a
  /// world share.
  SceneGraph(std::string file_name, std::shared_ptr<Budget> budget);
  /// Makes a scene with its own budget.
  explicit SceneGraph(std::string file_name = {}, const Limits& limits = {});
  ~SceneGraph();

  /// Creates a node with the default values of `type`. Returns a null NodeId if `limits.nodes` or the budget is
  /// exhausted. `type` must outlive the node: a built-in type, or a type that the node's text or an attached library
  /// owns.
  NodeId create(const NodeType& type, SourceLocation location = {});
  /// Reserves `count` consecutive node indices for `create_at`, and returns the first. Returns 0 if memory or a limit
  /// is exhausted.
  [[nodiscard]] std::uint32_t reserve_places(std::uint32_t count);
  void release_places(std::uint32_t first, std::uint32_t count);
  /// Creates a node at a reserved index. Returns null if there is no memory for its values.
  NodeId create_at(std::uint32_t place, const NodeType& type, SourceLocation location);
  /// Appends the node to the body of `prototype`.
  void put_in_body(NodeId id, Prototype& prototype);
  /// Frees nodes. Also frees the bodies of PROTO instances and the content of Inlines among them. The ids become
  /// invalid; values that contain these ids do not change. The last node of a run-time text frees the text's names and
  /// types.
  void remove(std::span<const NodeId> ids);

  [[nodiscard]] Node& node(NodeId id) {
    assert(contains(id));
    return nodes_[id.index];
  }
  [[nodiscard]] const Node& node(NodeId id) const {
    assert(contains(id));
    return nodes_[id.index];
  }
  [[nodiscard]] bool contains(NodeId id) const {
    return id && id.index < nodes_.size() && nodes_[id.index].generation == id.generation && id.generation != 0;
  }
  /// Returns the number of node indices. They are 1..node_count(), in the order of creation except for indices used
  /// again. A removed node's entry looks like a part of a PROTO declaration, and `contains` returns false for its id.
  [[nodiscard]] std::size_t node_count() const { return nodes_.size() - 1; }
  [[nodiscard]] NodeId id_at(std::uint32_t index) const { return {index, nodes_[index].generation}; }
  [[nodiscard]] const Node& node_at(std::uint32_t index) const { return nodes_[index]; }
  /// Returns the serial number of this scene, unique in the process. It distinguishes this scene from a later one at
  /// the same address.
  [[nodiscard]] std::uint64_t serial() const { return serial_; }
  /// Returns a counter that increases whenever nodes are made or removed.
  [[nodiscard]] std::uint64_t revision() const { return revision_; }
  /// Returns and clears the list of nodes that were made at run time, or at indices used again. The order of indices
  /// does not show that these nodes are new.
  [[nodiscard]] std::vector<NodeId> take_made() { return std::exchange(made_, {}); }

  /// Returns the value of a field. T is its C++ type. Asserts that the node's type declares the field with this type.
  template <class T>
  [[nodiscard]] const T& get(NodeId id, std::string_view field) const {
    const Node& n = node(id);
    const InterfaceDeclaration* declaration = n.type->find_field(field);
    assert(declaration && std::holds_alternative<T>(n.values[declaration->slot]));
    return *std::get_if<T>(&n.values[declaration->slot]);
  }
  /// Sets a field, even of a type that an importer built. Asserts that the node's type declares the field with this
  /// type.
  template <class T>
  void set(NodeId id, std::string_view field, T value) {
    Node& n = node(id);
    const InterfaceDeclaration* declaration = n.type->find_field(field);
    assert(declaration && std::holds_alternative<T>(n.values[declaration->slot]));
    *std::get_if<T>(&n.values[declaration->slot]) = std::move(value);
  }

  /// Returns the node that represents `id`. For a PROTO instance, this is its first body node, through nested instances
  /// (VRML97 4.8.3); null if the instance has no nodes yet. For other nodes, returns `id`.
  [[nodiscard]] NodeId resolve(NodeId id) const;
  /// Returns `resolve(id)` if that node has a built-in type of this kind; otherwise null.
  [[nodiscard]] NodeId resolve_as(NodeId id, NodeKind kind) const;

  /// Returns the text in which the value of a slot was written. This is the text of the node, unless IS passed the
  /// value on (VRML97 4.8.2). The base of relative URLs and access rights depend on this text.
  [[nodiscard]] const SourceText& text_of(NodeId id, int slot) const;
  void set_text(NodeId id, int slot, const SourceText& text);

  void set_name(NodeId id, std::string_view name);
  /// Returns a copy of `name` that lives as long as writing(), the text for which nodes are made.
  const std::string* keep_name(std::string_view name);
  /// Adds a declaration to `type`, the private type of the Script `id`, and its value to the Script.
  void declare(NodeId id, NodeType& type, InterfaceDeclaration declaration);
  /// Returns the text for which nodes are made: the file or a run-time text.
  [[nodiscard]] SourceText& writing() {
    return writing_ == 0 ? static_cast<SourceText&>(*this) : *texts_[writing_].text;
  }
  /// Returns the index of the run-time text that declares the type; 0 if none does.
  [[nodiscard]] std::uint32_t owner_of(const NodeType& type) const;
  /// Returns the index of the text that declares a type; 0 for the file. The type may have been deleted. Returns
  /// nullopt if no text declares it.
  [[nodiscard]] std::optional<std::uint32_t> text_declaring(const NodeType* type) const;
  [[nodiscard]] const SourceText& text_at(std::uint32_t owner) const {
    return owner == 0 ? static_cast<const SourceText&>(*this) : *texts_[owner].text;
  }
  /// Returns the number of run-time texts in memory.
  [[nodiscard]] std::size_t run_time_texts() const { return texts_.size() - 1 - free_texts_.size(); }

  /// Replaces the top-level nodes of the file, for replaceWorld.
  void set_roots(MFNode roots) { roots_ = std::move(roots); }
  /// Returns the ROUTEs of the world after loading: ROUTEs at the top level and in PROTO instances.
  [[nodiscard]] std::vector<Route>& routes() { return routes_; }
  [[nodiscard]] const std::vector<Route>& routes() const { return routes_; }

  /// Sets the content of an Inline node; the content has a separate name scope (VRML97 4.4.3). Null removes the
  /// content.
  void attach_inline(NodeId inline_node, std::shared_ptr<SceneGraph> content);
  /// Returns the content of an Inline node; null if it has none.
  [[nodiscard]] SceneGraph* inlined(NodeId inline_node) const;
  [[nodiscard]] const std::unordered_map<std::uint32_t, std::shared_ptr<SceneGraph>>& inlines() const {
    return inlines_;
  }

  /// Counts `count` more nodes with `bytes` bytes as copies for PROTO instances. Returns false if the limit is reached.
  [[nodiscard]] bool reserve_expansion(std::size_t count, std::size_t bytes);
  /// Draws memory for names, lists and similar data from the budget. Returns false if the budget is exhausted. After
  /// that, the scene never charges more.
  [[nodiscard]] bool charge(std::size_t bytes);
  /// Returns the bytes charged to the budget.
  [[nodiscard]] std::size_t charged() const { return charged_; }
  /// Reports whether something was omitted because the budget for nodes was exhausted.
  [[nodiscard]] bool exhausted() const { return exhausted_; }

  [[nodiscard]] const Limits& limits() const { return budget_->limits(); }
  [[nodiscard]] const std::shared_ptr<Budget>& budget() const { return budget_; }

 private:
  friend class WritingFor;
  friend class RunTimeText;
  /// Run-time text, and the resources that it owns.
  struct OwnedText {
    std::unique_ptr<SourceText> text;  // null if the index is free
    std::size_t nodes = 0;  // number of nodes made for it, except those of PROTO bodies
    std::size_t charged = 0;  // bytes drawn, except indices and values of nodes, which are used again
    std::size_t expanded_nodes = 0, expanded_bytes = 0;
    bool open = false;  // is being read
  };

  bool draw(std::size_t bytes);
  FieldValue* allocate_values(std::size_t count, bool needed);
  void free_values(FieldValue* values, std::size_t used, std::size_t capacity);
  std::uint32_t next_generation();
  void free_node(NodeId id, std::vector<NodeId>& more);
  void end_text_if_unused(std::uint32_t owner);

  std::shared_ptr<Budget> budget_;
  Share nodes_share_, instances_share_;
  std::size_t charged_ = 0;  // used part of nodes_share_
  bool exhausted_ = false;
  std::size_t expanded_nodes_ = 0;
  std::uint32_t generation_ = 0, generations_left_ = 0;
  std::uint64_t revision_ = 0;
  std::uint64_t serial_;
  std::deque<Node> nodes_;  // index 0 is unused, because it is NULL
  std::vector<std::unique_ptr<std::byte[]>> value_blocks_;
  std::size_t block_left_ = 0;
  std::byte* block_next_ = nullptr;
  std::unordered_map<std::size_t, std::vector<FieldValue*>> free_values_;  // free values by capacity
  std::unordered_map<std::uint32_t, std::vector<std::uint32_t>> free_places_;  // free indices by length of their run
  std::vector<NodeId> made_;
  std::vector<OwnedText> texts_{1};
  std::vector<std::uint32_t> free_texts_;
  std::uint32_t writing_ = 0;
  std::vector<Route> routes_;
  // Texts of values by node and slot, if different from the node's text.
  std::unordered_map<std::uint64_t, const SourceText*> value_texts_;
  std::unordered_map<std::uint32_t, std::shared_ptr<SceneGraph>> inlines_;
};

/// Guard: during its lifetime, new nodes belong to the run-time text with this index, or to the file (0).
class WritingFor {
 public:
  WritingFor(SceneGraph& scene, std::uint32_t owner) : scene_(scene), before_(std::exchange(scene.writing_, owner)) {}
  ~WritingFor() { scene_.writing_ = before_; }
  WritingFor(const WritingFor&) = delete;
  WritingFor& operator=(const WritingFor&) = delete;

 private:
  SceneGraph& scene_;
  std::uint32_t before_;
};

/// New text of a running world. As long as this object lives, nodes that are read into the scene belong to this text.
/// The text is freed with the last of its nodes, or with this object if it has no nodes.
class RunTimeText {
 public:
  /// `written_by` is the text that requested this text. `fetched_from` is the source of a text that was read from a
  /// URL; null means that a Script computed the text.
  RunTimeText(SceneGraph& scene, std::string file_name, const SourceText& written_by,
              std::shared_ptr<const TextSource> fetched_from = nullptr);
  ~RunTimeText();
  RunTimeText(const RunTimeText&) = delete;
  RunTimeText& operator=(const RunTimeText&) = delete;
  [[nodiscard]] std::uint32_t owner() const { return owner_; }
  [[nodiscard]] SourceText& text() const { return *scene_.texts_[owner_].text; }

 private:
  SceneGraph& scene_;
  std::uint32_t owner_;
  std::optional<WritingFor> writing_;
};

/// Returns the index of a node in the body of a PROTO. Returns nullopt if the body does not contain the node. Both
/// belong to the same scene.
[[nodiscard]] std::optional<std::uint32_t> place_in_body(const Prototype& prototype, NodeId id);

}  // namespace gs::vrml
