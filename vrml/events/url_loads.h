#pragma once

#include "vrml/event_model/behaviour.h"
#include "vrml/scene/scene_graph.h"

#include <cstdint>
#include <unordered_map>
#include <vector>

namespace gs::vrml {

class Execution;

/// State of the urls of a node.
enum class UrlLoad : std::uint8_t { pending, loaded, failed };

/// Loading of the urls of a world's nodes, which LoadSensors observe (ISO/IEC 19775-1 9.4.3). The caller that loads the
/// urls notes each change. Part of Execution.
class UrlLoads {
 public:
  /// Numbers of watched nodes by the state of their urls.
  struct Counts {
    std::size_t pending = 0, loaded = 0, failed = 0;
    [[nodiscard]] std::size_t all() const { return pending + loaded + failed; }
  };

  explicit UrlLoads(Execution& execution) : execution_(execution) {}

  /// Notes the state of the urls of a node. A node without a note is pending.
  void note(const Node& node, UrlLoad state);
  /// Notes that nothing more is loaded at present: pending nodes have failed, until a new note.
  void end();
  /// Drops the note of a node that is removed.
  void forget(const Node& node) { states_.erase(&node); }

  /// Returns the state of a node.
  [[nodiscard]] UrlLoad state_of(const Node& node) const {
    const auto found = states_.find(&node);
    return found == states_.end() ? UrlLoad::pending : found->second;
  }
  /// Returns the states of nodes. PROTO instances count as their first node. Ignores nodes without urls, and nodes that
  /// must not be loaded.
  [[nodiscard]] Counts count(const SceneGraph& scene, const MFNode& nodes) const;

  /// Adds or removes a LoadSensor, for the behaviour of these nodes.
  void add_sensor(EventNode sensor) { sensors_.push_back(sensor); }
  void remove_sensor(EventNode sensor) { std::erase(sensors_, sensor); }

 private:
  void wake();

  Execution& execution_;
  std::unordered_map<const Node*, UrlLoad> states_;
  std::vector<EventNode> sensors_;
  bool ended_ = false;  // pending nodes count as failed
};

}  // namespace gs::vrml
