#pragma once

#include "base/noncopyable.h"
#include "vrml/inventor/output/transforms.h"
#include "vrml/syntax/scene_sink.h"

#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gs::vrml::inventor {

/// Writer of VRML97 nodes, with the groups and Transforms that are open. A group becomes a node with its first child.
/// If transforms were added before, that node is a Transform; children after later transforms are put into further
/// Transforms. One thread.
class Output : NonCopyable {
 public:
  explicit Output(SceneSink& sink) : sink_(sink) { groups_.emplace_back(); }

  [[nodiscard]] SceneGraph& scene() { return sink_.scene(); }

  /// Makes a node in `target`. Returns null if a limit is reached. After its fields are set, call end().
  NodeId begin(std::string_view type, NodeTarget target, SourceLocation location, std::string_view name = {});
  /// Makes a node of a type that only X3D has.
  NodeId begin_x3d(std::string_view type, NodeTarget target, SourceLocation location, std::string_view name = {});
  void end(NodeId node) { sink_.end_node(node); }
  /// Makes a node without fields to set.
  NodeId make(std::string_view type, NodeTarget target, SourceLocation location, std::string_view name = {});
  /// Adds an existing node to another target.
  void place(NodeId node, NodeTarget target);
  [[nodiscard]] NodeTarget field(NodeId node, std::string_view name);
  /// Sets a field.
  template <class T>
  void set(NodeId node, std::string_view name, T value) {
    sink_.scene().set<T>(node, name, std::move(value));
  }

  /// Event interface of a Script.
  struct Event {
    AccessType access;
    FieldType type;
    const char* name;
  };
  /// Adds a Script with this program. Returns false if a limit is reached.
  bool add_script(const std::string& name, const std::string& code, std::initializer_list<Event> events,
                  NodeTarget target, SourceLocation location);
  void route(const RouteNames& names) { sink_.routes().add(names); }

  /// Opens a group. It becomes a node with its first child, or at once with open_group_in().
  void open_group(std::string_view name, SourceLocation location);
  /// Opens a group of type `type` in `target`, and returns its node.
  NodeId open_group_in(NodeTarget target, std::string_view type, SourceLocation location, std::string_view name = {});
  /// Closes the innermost group. Returns its node, or null if it has no children.
  NodeId close_group();
  /// Makes the innermost group a node of this type. Its children go to `children`.
  NodeId make_group(std::string_view type);

  /// Returns the target for children with the current transformation. Returns nullopt if a limit is reached.
  [[nodiscard]] std::optional<NodeTarget> target();
  /// Returns the target for children without the transforms since the group began; see inner_matrix().
  [[nodiscard]] std::optional<NodeTarget> group_target();
  /// Returns group_from_local for group_target().
  [[nodiscard]] glm::dmat4 inner_matrix() const;
  /// Returns world_from_local of the text.
  [[nodiscard]] glm::dmat4 world_matrix() const;

  void add_transform(Operation operation);
  /// Adds a Transform with this name around the following children of the group, so that events can move it. Returns
  /// its name, or an empty string if it cannot move; the transform is then added unchanged.
  std::string add_moving_transform(const TransformFields& fields, const std::string& name);
  /// Stores the transformation for TransformSeparator, and restores it.
  void save_transforms();
  void restore_transforms();

  /// Puts all later children into a nested group if the group already has visible children.
  void split_group(SourceLocation location);
  [[nodiscard]] bool has_shapes() const { return groups_.back().has_shapes; }
  void note_shape() { groups_.back().has_shapes = true; }
  [[nodiscard]] std::size_t depth() const { return groups_.size(); }

 private:
  struct Group {
    std::string name;
    SourceLocation location;
    std::optional<NodeTarget> parent;  // explicit target; otherwise the parent group
    NodeId node;                       // node that receives children
    NodeId outer;                      // node of the whole group, if split_group() has replaced `node`
    NodeId wrapper;                    // Transform for the current transformation
    std::vector<Operation> operations;
    std::size_t base = 0;            // operations that `node` itself applies
    std::vector<std::size_t> saved;  // numbers of operations at the open TransformSeparators
    std::size_t splits = 0;
    bool has_shapes = false;
  };
  [[nodiscard]] std::optional<NodeTarget> target_in(std::size_t index);
  [[nodiscard]] std::optional<NodeTarget> node_target(std::size_t index);
  void set_transform(NodeId node, std::span<const Operation> operations);

  SceneSink& sink_;
  std::vector<Group> groups_;  // the first one is the root
  bool said_inexact_ = false;
};

}  // namespace gs::vrml::inventor
