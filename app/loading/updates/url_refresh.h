#pragma once

#include "base/noncopyable.h"
#include "vrml/events/execution.h"

#include <optional>
#include <unordered_map>
#include <vector>

namespace gs::app {

/// Timetable for nodes that load their urls again and again: those with autoRefresh above 0 (ISO/IEC 19775-1 9.3.2).
/// Use on the world's thread.
class UrlRefresh : NonCopyable {
 public:
  explicit UrlRefresh(vrml::Execution& execution) : execution_(execution) {}

  /// Reads autoRefresh and autoRefreshTimeLimit of a node again. Call it for new nodes and after each change.
  void note(vrml::SceneGraph& scene, vrml::NodeId id);
  /// Calls note() for all nodes of a scene.
  void note_scene(vrml::SceneGraph& scene);
  /// Drops a node that is removed.
  void forget(const vrml::Node& node) { entries_.erase(&node); }

  /// Returns the nodes that must load their urls again now. A node that still loads waits for its next turn. Drops
  /// nodes with failed urls.
  [[nodiscard]] std::vector<vrml::NodeChange> take_due();
  /// Returns the time of the next turn; nullopt if there is none.
  [[nodiscard]] std::optional<double> next_time() const;

 private:
  struct Entry {
    vrml::SceneGraph* scene;
    vrml::NodeId node;
    double interval, limit;  // seconds
    double next, end;        // times of the next turn and of the end of the turns
  };

  vrml::Execution& execution_;
  std::unordered_map<const vrml::Node*, Entry> entries_;
};

}  // namespace gs::app
