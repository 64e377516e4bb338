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

/// A line of the tree of a world: a node at one of its places.
struct OutlineRow {
  NodeAt node;  // null: NULL in a list
  std::string_view field;
  std::optional<std::size_t> element;  // of a list
  std::size_t depth = 0;
  bool can_open = false, open = false;
  bool use = false;  // the node stands elsewhere in the text, and is only used here (VRML97 4.6.2); it does not open
};

/// The tree of a world's nodes as lines, of which some are open. What it costs follows what is open and what is looked
/// at, whatever the world holds; it is always as the world is now. Valid until the world goes on: then `refresh`. One
/// thread, that of the world.
class SceneOutline {
 public:
  /// `index` tells USEs apart. Both must outlive it, or be taken away before; null: there is no world.
  void set_world(const vrml::Execution* world, const SceneIndex* index);
  /// What is open and gone is no more, and lists are as long as they are. To be called before a frame.
  void refresh();
  [[nodiscard]] std::size_t size() const { return top_.rows; }
  [[nodiscard]] OutlineRow row(std::size_t index) const;
  void set_open(std::size_t index, bool open);
  /// The line that holds the line; nothing: it is a root.
  [[nodiscard]] std::optional<std::size_t> holder(std::size_t index) const;
  /// Opens all that leads to a node, and tells its line. Nothing: it is not there any more.
  std::optional<std::size_t> reveal(std::span<const HeldStep> way);
  /// Lines and lists that were looked at, so far: what it has cost.
  [[nodiscard]] std::uint64_t work_done() const { return work_done_; }

 private:
  static constexpr std::size_t kMostDepth = 1000;
  /// An open line, or the whole.
  struct Branch {
    NodeAt node;
    std::size_t own = 0;                                  // nodes that it holds
    std::size_t rows = 0;                                 // all lines below it
    std::map<std::size_t, std::unique_ptr<Branch>> open;  // by number of what it holds
  };
  struct Found {
    std::vector<Branch*> way;        // the whole, and open lines; the last one holds the line
    std::vector<std::size_t> lines;  // of these, but for the whole
    std::size_t number = 0;          // in it
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
