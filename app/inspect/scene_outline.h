#pragma once

#include "app/inspect/node_children.h"
#include "app/inspect/scene_index.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace gs::app {

/// Line of the node tree: a node at one of its positions in the world.
struct OutlineRow {
  NodeAt node;  // a null node is NULL in a list
  std::string_view field;
  std::optional<std::size_t> element;  // index in the list, if the node is in a list
  std::size_t depth = 0;
  bool can_open = false, open = false;
  bool use = false;  // true for a USE of the node (VRML97 4.6.2); it cannot be expanded
};

/// Tree of a world's nodes as lines that can be expanded. Its cost depends on the expanded and displayed lines, not on
/// the size of the world. It shows the world as it is. After each step of the world, call `refresh`. World's thread.
class SceneOutline {
 public:
  /// Sets the world, and the index that identifies USEs. Both must outlive this object, or be replaced before they end.
  /// Null means no world.
  void set_world(const vrml::Execution* world, const SceneIndex* index);
  /// Updates the lines. Drops expanded nodes that no longer exist, and adapts to changed lists. Call before each frame.
  void refresh();
  [[nodiscard]] std::size_t size() const { return top_.rows; }
  [[nodiscard]] OutlineRow row(std::size_t index) const;
  void set_open(std::size_t index, bool open);
  /// Returns the line of the parent, or nullopt for a top-level node.
  [[nodiscard]] std::optional<std::size_t> holder(std::size_t index) const;
  /// Expands all ancestors of a node. Returns the line of the node, or nullopt if the node no longer exists.
  std::optional<std::size_t> reveal(std::span<const HeldStep> way);
  /// Returns the number of visits of lines and lists so far, as a measure of cost.
  [[nodiscard]] std::uint64_t work_done() const { return work_done_; }

 private:
  static constexpr std::size_t kMaxDepth = 1000;
  /// Expanded line, or the top level of the tree.
  struct Branch {
    NodeAt node;
    std::size_t own = 0;                                  // number of direct children
    std::size_t rows = 0;  // number of lines below, including expanded ones
    std::map<std::size_t, std::unique_ptr<Branch>> open;  // expanded children, by child index
  };
  struct Found {
    std::vector<Branch*> way;  // top level and expanded lines on the path; the last is the parent
    std::vector<std::size_t> lines;  // line numbers of `way`, without the top level
    std::size_t number = 0;  // index among the children of the parent
    HeldNodes group;
    std::size_t element = 0;
  };
  [[nodiscard]] Found find(std::size_t index) const;
  bool held(const Branch& branch, std::size_t number, HeldNodes& group, std::size_t& element) const;
  void refresh(Branch& branch);
  [[nodiscard]] bool is_use(const Found& found, const NodeAt& node) const;
  [[nodiscard]] std::size_t count_held(const NodeAt& node) const;

  const vrml::Execution* world_ = nullptr;
  const SceneIndex* index_ = nullptr;
  mutable Branch top_;
  mutable std::vector<HeldNodes> held_;
  mutable std::uint64_t work_done_ = 0;
};

}  // namespace gs::app
