#pragma once

#include "base/noncopyable.h"
#include "vrml/scene/scene_graph.h"

#include <string>

namespace gs::vrml {

class SceneSink;

/// ROUTE from.event_out TO to.event_in, with names instead of nodes.
struct RouteNames {
  std::string from, event_out, to, event_in;
  SourceLocation location;
};

/// Part of SceneSink for ROUTEs (VRML97 4.10.2). Names may come from untrusted text. One thread.
class RouteSink : NonCopyable {
 public:
  explicit RouteSink(SceneSink& sink) : sink_(sink) {}

  /// Adds a ROUTE. If one of its nodes is not defined yet, the ROUTE waits until the end of the scope.
  void add(const RouteNames& route);

 private:
  friend class SceneSink;
  /// Adds the ROUTEs that wait for the end of the scope.
  void finish();
  void renew_declarations();
  [[nodiscard]] bool extends_nodes(const RouteNames& wanted, NodeId from, NodeId to) const;
  void connect_route(const RouteNames& wanted, NodeId from, NodeId to);
  void make_browser(SourceLocation location);

  SceneSink& sink_;
};

}  // namespace gs::vrml
