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

/// Index of a world's nodes: the first position of each node in the text, and a search by DEF name and type. All other
/// positions are USEs. It is built incrementally, so that worlds with millions of nodes do not block. Memory is charged
/// to the world's budget; nodes that do not fit are not indexed. Use on the world's thread.
class SceneIndex {
 public:
  /// Starts again with this world; null clears the index. The world must outlive this object or be replaced first.
  void set_world(const vrml::Execution* world);
  [[nodiscard]] const vrml::Execution* world() const { return world_; }
  /// Continues the index for up to `work` visits of nodes. Starts again after nodes were added or removed, but only
  /// every few seconds. `now` is in seconds of any clock. Returns true if more work remains.
  bool go_on(std::size_t work, double now);
  /// Reports whether all nodes that fit are indexed.
  [[nodiscard]] bool complete() const { return walked_; }
  [[nodiscard]] bool cut_short() const { return cut_short_; }
  [[nodiscard]] std::size_t size() const { return entries_.size(); }

  /// Reports whether this position of the node is a USE. Returns false also if that is not known yet.
  [[nodiscard]] bool is_use(const NodeAt& node, const NodeAt& holder, std::uint16_t place, std::uint32_t element) const;
  /// Returns the path to the node's first position; empty if unknown or no longer present.
  [[nodiscard]] std::vector<HeldStep> way_to(const NodeAt& node) const;

  /// Searches nodes with this text in DEF name or type, ignoring case. An empty text ends the search.
  void find(std::string_view text);
  [[nodiscard]] const std::string& sought() const { return sought_; }
  /// Number of matches, up to kMaxMatches; matches are in text order.
  [[nodiscard]] std::size_t matches() const { return matches_.size(); }
  [[nodiscard]] NodeAt match(std::size_t index) const { return node_of(matches_[index]); }
  /// Reports whether the search has covered all indexed nodes.
  [[nodiscard]] bool searched() const { return scanned_ == entries_.size() || matches_.size() >= kMaxMatches; }
  static constexpr std::size_t kMaxMatches = 100'000;

  /// Returns the total number of nodes and entries visited, as a measure of cost.
  [[nodiscard]] std::uint64_t work_done() const { return work_done_; }

 private:
  static constexpr std::uint32_t kNone = UINT32_MAX;
  struct Entry {
    vrml::NodeId id;
    std::uint32_t parent = kNone;  // index in entries_
    std::uint32_t element = 0;
    std::uint16_t place = 0;  // HeldNodes::place
    std::uint16_t scene = 0;  // index in scenes_
  };
  struct Scene {
    const vrml::SceneGraph* scene;
    std::vector<std::uint32_t> entries;  // by node index
  };
  struct Standing {
    std::uint32_t entry = kNone;  // kNone means the roots
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
  std::size_t depth_ = 0;  // used length of way_; its lists are reused
  bool walked_ = false, cut_short_ = false;
  std::uint64_t made_of_ = 0;  // sum of scene revisions at the start
  double begun_at_ = 0;
  bool begun_ = false;
  mutable bool stale_ = false;  // a node was no longer at its indexed position
  mutable std::vector<HeldNodes> looked_at_;

  std::string sought_;  // lower case
  std::vector<std::uint32_t> matches_;
  std::size_t scanned_ = 0;
  std::unordered_map<const vrml::NodeType*, bool> fitting_types_;
  std::uint64_t work_done_ = 0;
};

}  // namespace gs::app
