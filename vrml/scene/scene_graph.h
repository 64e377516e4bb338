#pragma once

#include "base/budget.h"
#include "base/diagnostic.h"
#include "vrml/scene/node_arena.h"
#include "vrml/scene/particle_clouds.h"
#include "vrml/scene/scene_memory.h"
#include "vrml/scene/scene_texts.h"

#include <cassert>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

namespace gs::vrml {

class SceneGraph;

/// Inlines that stand for the urls of a GeoLOD (X3D 25.3.4). They belong to its text, but no field refers to them.
struct GeoTiles {
  MFNode root;           // Inline of rootUrl; empty if there is none
  MFNode children;       // Inlines of child1Url to child4Url; empty before the viewer is in range for the first time
  bool refined = false;  // the children are shown instead of the root

  /// Returns the shown tiles. Null means that the GeoLOD shows its rootNode.
  [[nodiscard]] const MFNode* shown() const { return refined ? &children : root.empty() ? nullptr : &root; }
};

/// Contents of the Inline nodes of a scene, and the Inlines of its GeoLODs. Each content has a separate name scope
/// (VRML97 4.4.3). One thread.
class InlineContents {
 public:
  /// Sets the content of an Inline node. Null removes the content.
  void attach(NodeId inline_node, std::shared_ptr<SceneGraph> content) {
    if (content)
      contents_[inline_node.index] = std::move(content);
    else
      contents_.erase(inline_node.index);
  }
  /// Returns the content of an Inline node; null if it has none.
  [[nodiscard]] SceneGraph* of(NodeId inline_node) const {
    const auto found = contents_.find(inline_node.index);
    return found == contents_.end() ? nullptr : found->second.get();
  }
  /// Returns the contents by the index of their Inline node.
  [[nodiscard]] const std::unordered_map<std::uint32_t, std::shared_ptr<SceneGraph>>& all() const { return contents_; }
  /// Returns the tiles of a GeoLOD; makes an empty set at first.
  [[nodiscard]] GeoTiles& tiles(NodeId lod) { return tiles_[lod.index]; }
  /// Returns the tiles of a GeoLOD; null for other nodes, and before it has tiles.
  [[nodiscard]] const GeoTiles* tiles_of(NodeId lod) const {
    const auto found = tiles_.empty() ? tiles_.end() : tiles_.find(lod.index);
    return found == tiles_.end() ? nullptr : &found->second;
  }
  /// Returns the ROUTEs of PROTO instances from or to nodes that the content of their Inlines exports.
  [[nodiscard]] std::vector<X3DStatements::ImportedRoute>& instance_routes() { return instance_routes_; }
  [[nodiscard]] const std::vector<X3DStatements::ImportedRoute>& instance_routes() const { return instance_routes_; }
  /// Removes the content and the tiles of a node that is freed.
  void forget(NodeId node) {
    contents_.erase(node.index);
    tiles_.erase(node.index);
  }

 private:
  std::unordered_map<std::uint32_t, std::shared_ptr<SceneGraph>> contents_;
  std::unordered_map<std::uint32_t, GeoTiles> tiles_;  // by index of the GeoLOD
  std::vector<X3DStatements::ImportedRoute> instance_routes_;
};

/// World or a part of it: its nodes, PROTOs, ROUTEs and Inlines, and the text of its file.
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

  /// Creates a node with the default values of `type`, in the text `texts().writing()`. Returns a null NodeId if
  /// `limits.nodes` or the budget is exhausted. `type` must outlive the node: a built-in type, or a type that the
  /// node's text or an attached library owns.
  NodeId create(const NodeType& type, SourceLocation location = {});
  /// Creates a node at an index that NodeArena::reserve() returned. Returns null if there is no memory for its values.
  NodeId create_at(std::uint32_t index, const NodeType& type, SourceLocation location);
  /// Appends the node to the body of `prototype`.
  void put_in_body(NodeId id, Prototype& prototype);
  /// Adds a declaration to `type`, the private type of the Script `id`, and its value to the Script.
  void declare(NodeId id, NodeType& type, InterfaceDeclaration declaration);
  /// Frees nodes. Also frees the bodies of PROTO instances and the content of Inlines among them. The ids become
  /// invalid; values that contain these ids do not change. The last node of a run-time text frees the text's names and
  /// types.
  void remove(std::span<const NodeId> ids);
  /// Frees a run-time text that is closed and has no nodes, with its names and types.
  void remove_text_if_unused(std::uint32_t index);

  [[nodiscard]] Node& node(NodeId id) { return nodes_[id]; }
  [[nodiscard]] const Node& node(NodeId id) const { return nodes_[id]; }
  [[nodiscard]] bool contains(NodeId id) const { return nodes_.contains(id); }
  [[nodiscard]] NodeArena& nodes() { return nodes_; }
  [[nodiscard]] const NodeArena& nodes() const { return nodes_; }
  /// Returns the serial number of this scene, unique in the process. It distinguishes this scene from a later one at
  /// the same address.
  [[nodiscard]] std::uint64_t serial() const { return serial_; }

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

  /// Replaces the top-level nodes of the file, for replaceWorld.
  void set_roots(MFNode roots) { roots_ = std::move(roots); }
  /// Returns the ROUTEs of the world after loading: ROUTEs at the top level and in PROTO instances.
  [[nodiscard]] std::vector<Route>& routes() { return routes_; }
  [[nodiscard]] const std::vector<Route>& routes() const { return routes_; }
  [[nodiscard]] InlineContents& inlines() { return inlines_; }
  [[nodiscard]] const InlineContents& inlines() const { return inlines_; }
  /// Returns the particles of the active ParticleSystems. They are no content of the scene.
  [[nodiscard]] ParticleClouds& particles() const { return *particles_; }
  [[nodiscard]] SceneTexts& texts() { return texts_; }
  [[nodiscard]] const SceneTexts& texts() const { return texts_; }
  [[nodiscard]] SceneMemory& memory() { return memory_; }
  [[nodiscard]] const SceneMemory& memory() const { return memory_; }
  [[nodiscard]] const Limits& limits() const { return memory_.budget()->limits(); }
  [[nodiscard]] const std::shared_ptr<Budget>& budget() const { return memory_.budget(); }

 private:
  void free_node(NodeId id, std::vector<NodeId>& more);

  SceneMemory memory_;
  SceneTexts texts_;
  NodeArena nodes_;  // destroyed before the texts, which own types of nodes
  std::uint64_t serial_;
  std::vector<Route> routes_;
  InlineContents inlines_;
  std::unique_ptr<ParticleClouds> particles_ = std::make_unique<ParticleClouds>();
};

/// Guard: during its lifetime, new nodes belong to the run-time text with this index, or to the file (0).
class WritingFor {
 public:
  WritingFor(SceneGraph& scene, std::uint32_t owner) : texts_(scene.texts()), before_(texts_.write_for(owner)) {}
  ~WritingFor() { texts_.write_for(before_); }
  WritingFor(const WritingFor&) = delete;
  WritingFor& operator=(const WritingFor&) = delete;

 private:
  SceneTexts& texts_;
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
  [[nodiscard]] SourceText& text() const { return scene_.texts().at(owner_); }

 private:
  SceneGraph& scene_;
  std::uint32_t owner_;
  std::optional<WritingFor> writing_;
};

/// Returns the index of a node in the body of a PROTO. Returns nullopt if the body does not contain the node. Both
/// belong to the same scene.
[[nodiscard]] std::optional<std::uint32_t> place_in_body(const Prototype& prototype, NodeId id);

}  // namespace gs::vrml
