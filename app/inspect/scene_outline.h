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

/// Line of the node tree: a node at one of its positions.
struct OutlineRow {
  NodeAt node;  // null means NULL in a list
  std::string_view field;
  std::optional<std::size_t> element;  // index in a list
  std::size_t depth = 0;
  bool can_open = false, open = false;
  bool use = false;  // the node is defined elsewhere and only used here (VRML97 4.6.2); cannot be expanded
};

/// Expandable tree of a world's nodes, as lines. Its cost depends on what is expanded and displayed, not on the world's
/// size. It always shows the present world and is valid until the next step; then call `refresh`. Use on the world's
/// thread.
class SceneOutline {
 public:
  /// Sets the world. `index` identifies USEs. Both must outlive this object or be replaced first; null means no world.
  void set_world(const vrml::Execution* world, const SceneIndex* index);
  /// Updates the lines: drops expanded nodes that are gone, and adapts to changed lists. Call before each frame.
  void refresh();
  [[nodiscard]] std::size_t size() const { return top_.rows; }
  [[nodiscard]] OutlineRow row(std::size_t index) const;
  void set_open(std::size_t index, bool open);
  /// Returns the parent line; nullopt for a root.
  [[nodiscard]] std::optional<std::size_t> holder(std::size_t index) const;
  /// Expands all parents of a node and returns its line. Returns nullopt if the node is gone.
  std::optional<std::size_t> reveal(std::span<const HeldStep> way);
  /// Returns the total number of lines and lists visited, as a measure of cost.
  [[nodiscard]] std::uint64_t work_done() const { return work_done_; }

 private:
  static constexpr std::size_t kMaxDepth = 1000;
  /// An open line, or the whole.
  struct Branch {
    NodeAt node;
    std::size_t own = 0;                                  // number of direct children
    std::size_t rows = 0;                                 // number of lines below
    std::map<std::size_t, std::unique_ptr<Branch>> open;  // by child index
  };
  struct Found {
    std::vector<Branch*> way;        // the root and expanded lines; the last one is the parent
    std::vector<std::size_t> lines;  // line numbers of `way`, without the root
    std::size_t number = 0;          // child index in the parent
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
