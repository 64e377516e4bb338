#pragma once

#include "app/inspect/node_children.h"
#include "vrml/scene/budget.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace gs::app {

/// Where the nodes of a world are: which place of the text, in its order, each has first, all others being USEs of it;
/// and a search by DEF name and type. Made a part at a time, so that a world of millions of nodes holds nobody up.
/// Memory is drawn from the world's budget; what finds no room is not found. One thread, that of the world.
class SceneIndex {
 public:
  /// Begins anew; null: there is no world, and nothing is remembered. It must outlive this, or be taken away before.
  void set_world(const vrml::Execution* world);
  [[nodiscard]] const vrml::Execution* world() const { return world_; }
  /// Goes on, at most for so much `work`, in nodes and looks at nodes; begins anew where nodes have come and gone, but
  /// not before some seconds have gone by since the last time. `now`: of any clock. True: there is more
  /// to do at once.
  bool go_on(std::size_t work, double now);
  /// All nodes are known that found room.
  [[nodiscard]] bool complete() const { return walked_; }
  [[nodiscard]] bool cut_short() const { return cut_short_; }
  [[nodiscard]] std::size_t size() const { return entries_.size(); }

  /// Whether this place of the node is not the first one that the text has for it. False also where that is not known
  /// yet.
  [[nodiscard]] bool is_use(const NodeAt& node, const NodeAt& holder, std::uint16_t place, std::uint32_t element) const;
  /// The way to the node's first place; empty: it is not known, or not there any more.
  [[nodiscard]] std::vector<HeldStep> way_to(const NodeAt& node) const;

  /// Nodes whose DEF name or type has this in it, whatever the case of its letters; empty: none are looked for.
  void find(std::string_view text);
  [[nodiscard]] const std::string& sought() const { return sought_; }
  /// In the order of the text; of very many, the first.
  [[nodiscard]] std::size_t matches() const { return matches_.size(); }
  [[nodiscard]] NodeAt match(std::size_t index) const { return node_of(matches_[index]); }
  /// Whether all that is known was looked at.
  [[nodiscard]] bool searched() const { return scanned_ == entries_.size() || matches_.size() >= kMostMatches; }
  static constexpr std::size_t kMostMatches = 100'000;

  /// Nodes and entries that were looked at, so far: what it has cost.
  [[nodiscard]] std::uint64_t work_done() const { return work_done_; }

 private:
  static constexpr std::uint32_t kNone = UINT32_MAX;
  struct Entry {
    vrml::NodeId id;
    std::uint32_t parent = kNone;  // of entries_
    std::uint32_t element = 0;
    std::uint16_t place = 0;  // HeldNodes::place
    std::uint16_t scene = 0;  // of scenes_
  };
  struct Scene {
    const vrml::SceneGraph* scene;
    std::vector<std::uint32_t> entries;  // by index of node
  };
  struct Standing {
    std::uint32_t entry = kNone;  // kNone: the roots
    std::size_t group = 0, element = 0;
    std::vector<HeldNodes> held;
  };

  void begin();
  [[nodiscard]] NodeAt node_of(std::uint32_t entry) const {
    return {scenes_[entries_[entry].scene].scene, entries_[entry].id};
  }
  [[nodiscard]] std::uint32_t entry_of(const NodeAt& node) const;
  bool enter(const NodeAt& node, std::uint32_t parent, std::uint16_t place, std::uint32_t element);
  std::size_t walk(std::size_t work);
  std::size_t scan(std::size_t work);
  [[nodiscard]] bool fits(const NodeAt& node);
  [[nodiscard]] std::uint64_t revision() const;
  [[nodiscard]] bool holds(const NodeAt& holder, const Entry& entry, const NodeAt& node) const;

  const vrml::Execution* world_ = nullptr;
  std::vector<Entry> entries_;
  std::vector<Scene> scenes_;
  std::unordered_map<const vrml::SceneGraph*, std::uint16_t> scene_numbers_;
  vrml::Share share_;
  std::vector<Standing> way_;
  std::size_t depth_ = 0;  // of way_, whose lists are used again
  bool walked_ = false, cut_short_ = false;
  std::uint64_t made_of_ = 0;  // revisions of the scenes
  double begun_at_ = 0;
  bool begun_ = false;
  mutable bool stale_ = false;  // a node was not where it was found
  mutable std::vector<HeldNodes> looked_at_;

  std::string sought_;  // in small letters
  std::vector<std::uint32_t> matches_;
  std::size_t scanned_ = 0;
  std::unordered_map<const vrml::NodeType*, bool> fitting_types_;
  std::uint64_t work_done_ = 0;
};

}  // namespace gs::app
