#pragma once

#include "vrml/event_model/behaviour.h"
#include "vrml/event_model/placement.h"
#include "vrml/event_model/states.h"

#include <array>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

namespace gs::vrml {

class Execution;

/// Running sensors that rest, because the viewer is outside of their boxes (Behaviour::idle_box). One comparison of all
/// boxes per step replaces the calls of their on_time. Part of Execution.
///
/// A sensor wakes when the viewer's path may meet its box, and when its position, its fields or the hierarchy change.
/// The results are exactly those of a call in each step.
class IdleSensors {
 public:
  explicit IdleSensors(Execution& execution) : execution_(execution) {}

  /// Reports whether no node rests or was woken since the last take_woken().
  [[nodiscard]] bool empty() const { return nodes_.empty() && woken_.empty(); }
  [[nodiscard]] std::size_t count() const { return nodes_.size(); }
  /// Begins a step: wakes the sensors that the viewer's path since the last step may meet.
  void begin_step();
  /// Lets a node rest if possible, after its on_time was called in this step. Returns false if the node must run.
  [[nodiscard]] bool take(EventNode node);
  /// Wakes a node if it rests.
  void wake(EventNode node);
  void wake_all();
  /// Wakes the sensors below a transforming node with changed fields.
  void node_moved(const Node& node);
  /// Returns and clears the list of woken nodes.
  [[nodiscard]] std::vector<EventNode> take_woken() { return std::exchange(woken_, {}); }

  /// Discards a node that is removed.
  void remove(EventNode node);
  /// Discards removed nodes.
  void forget_removed();

 private:
  /// Reference to a resting node. Stale if the node has woken since.
  struct Ref {
    EventNode node;
    std::uint32_t serial;
  };

  [[nodiscard]] ViewerMoment moment();
  void follow_hierarchy();
  void wake_met(const glm::dvec3& from, const glm::dvec3& to);
  [[nodiscard]] bool rests(const Ref& ref) const;
  [[nodiscard]] bool afford(std::size_t refs);
  void refer(EventNode node, std::span<const Placement::Path> paths, std::uint32_t serial);
  void leave(EventNode node);

  Execution& execution_;
  // Resting nodes. Their bounds are rounded outwards.
  std::array<std::vector<float>, 3> lower_, upper_;
  std::vector<EventNode> nodes_;
  std::vector<std::uint32_t> serials_;
  std::vector<EventNode> woken_;
  std::unordered_map<const Node*, std::vector<Ref>> below_;  // resting nodes below each transforming node
  ViewerMoment last_;                                        // moment of the last step
  bool recorded_ = false;                                    // last_ is of the present step
  std::uint32_t serial_ = 0;
  std::size_t afforded_ = 0;  // bytes drawn
  bool full_ = false;  // no more memory was granted
};

}  // namespace gs::vrml
