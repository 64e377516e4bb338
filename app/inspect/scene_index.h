#pragma once

#include "app/inspect/node_children.h"
#include "base/budget.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace gs::app {

/// Index of all nodes of a world. Stores the first position of each node in the text; all other positions are USEs.
/// Searches nodes by DEF name and type. The index is built in small parts, so that a world of a million nodes does not
/// block the program. Memory is charged to the world's budget. Nodes beyond it are not in the index. World's thread.
class SceneIndex {
 public:
  /// Clears the index and sets the world, which may be null. The world must outlive this object, or be replaced before
  /// it ends.
  void set_world(const vrml::Execution* world);
  [[nodiscard]] const vrml::Execution* world() const { return world_; }
  /// Continues to build the index with up to `work` visits of nodes. After nodes were added or removed, starts again,
  /// but only every few seconds. `now` is in seconds of any clock. Returns true if work remains.
  bool go_on(std::size_t work, double now);
  /// Returns true if the index has all nodes for which its memory suffices.
  [[nodiscard]] bool complete() const { return walked_; }
  [[nodiscard]] bool cut_short() const { return cut_short_; }
  [[nodiscard]] std::size_t size() const { return entries_.size(); }

  /// Returns true if the position of the node is a USE. The position is `element` of field `place` in `holder`. Returns
  /// false if the index does not have the node yet.
  [[nodiscard]] bool is_use(const NodeAt& node, const NodeAt& holder, std::uint16_t place, std::uint32_t element) const;
  /// Returns the path to the first position of a node. Empty if the index does not have the node, or if the node is no
  /// longer there.
  [[nodiscard]] std::vector<HeldStep> way_to(const NodeAt& node) const;

  /// Starts a search for nodes with this text in their DEF name or type, ignoring case. An empty text ends the search.
  void find(std::string_view text);
  [[nodiscard]] const std::string& sought() const { return sought_; }
  /// Returns the number of matches, at most kMaxMatches. Matches are in the order of the text.
  [[nodiscard]] std::size_t matches() const { return matches_.size(); }
  [[nodiscard]] NodeAt match(std::size_t index) const { return node_of(matches_[index]); }
  /// Returns true if the search has checked all nodes of the index, or found kMaxMatches.
  [[nodiscard]] bool searched() const { return scanned_ == entries_.size() || matches_.size() >= kMaxMatches; }
  static constexpr std::size_t kMaxMatches = 100'000;

  /// Returns the number of visits of nodes and entries so far, as a measure of cost.
  [[nodiscard]] std::uint64_t work_done() const { return work_done_; }

 private:
  static constexpr std::uint32_t kNone = UINT32_MAX;
  struct Entry {
    vrml::NodeId id;
    std::uint32_t parent = kNone;  // index in entries_; kNone at the top level
    std::uint32_t element = 0;
    std::uint16_t place = 0;  // as in HeldNodes
    std::uint16_t scene = 0;  // index in scenes_
  };
  struct Scene {
    const vrml::SceneGraph* scene;
    std::vector<std::uint32_t> entries;  // index in entries_, for each node index
  };
  struct Standing {
    std::uint32_t entry = kNone;  // index in entries_; kNone for the top level
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
  Share share_;
  std::vector<Standing> way_;
  std::size_t depth_ = 0;  // number of elements of way_ in use; the others keep their memory
  bool walked_ = false, cut_short_ = false;
  std::uint64_t made_of_ = 0;  // sum of the scenes' revisions when the index was begun
  double begun_at_ = 0;
  bool begun_ = false;
  mutable bool stale_ = false;  // true if a node has left its position in the index
  mutable std::vector<HeldNodes> looked_at_;

  std::string sought_;  // text of the search, in lower case
  std::vector<std::uint32_t> matches_;
  std::size_t scanned_ = 0;
  std::unordered_map<const vrml::NodeType*, bool> fitting_types_;
  std::uint64_t work_done_ = 0;
};

}  // namespace gs::app
