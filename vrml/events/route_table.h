#pragma once

#include "vrml/events/event_nodes.h"
#include "vrml/scene/scene_graph.h"

#include <cstdint>
#include <unordered_map>
#include <vector>

namespace gs::vrml {

/// ROUTE that events follow, with the scene of its nodes.
struct PlacedRoute {
  const SceneGraph* scene = nullptr;
  Route route;
};

/// Paths of the events of a world: ROUTEs, and the IS connections of PROTO instances. Part of Execution.
class RouteTable {
 public:
  enum class Way : std::uint8_t {
    route,    // to an eventIn
    down,     // from an eventIn of a PROTO instance to that of a body node (4.8.2)
    up,       // from an eventOut of a body node to that of the instance
    removed,  // kept until the cascade ends, since its path may contain it
  };
  struct Connection {
    std::uint32_t next = 0, previous = 0;
    std::uint32_t next_in = 0, previous_in = 0;  // list of the connections that lead to `to`
    EventNode source = 0;
    std::uint32_t from = 0;  // slot
    EventNode to = 0;
    std::uint32_t event_in = 0;  // index in the target's interfaces
    Way way = Way::route;
  };

  explicit RouteTable(Execution& execution) : execution_(execution) {}

  /// Adds a ROUTE; it does not appear in SceneGraph::routes. Returns false if it exists already, if it does not connect
  /// nodes of one scene with equal types, or if the budget is exhausted.
  bool add(SceneGraph& scene, const Route& route);
  /// Returns false if there is no such ROUTE.
  bool remove(SceneGraph& scene, const Route& route);
  /// Returns all ROUTEs of files, PROTO instances, Inlines and programs in order of creation.
  [[nodiscard]] std::vector<PlacedRoute> all() const;
  /// Returns a number that changes whenever ROUTEs are added or removed.
  [[nodiscard]] std::uint64_t revision() const { return revision_; }

  /// Connects the interface of a PROTO instance to the nodes of its body, according to IS. Returns false if the budget
  /// is exhausted.
  bool connect_instance(SceneGraph& scene, NodeId instance);
  /// Removes all connections from and to a node.
  void disconnect_all(EventNode node);
  /// Reuses removed connections. Call it only between cascades.
  void reuse_removed();

  [[nodiscard]] const Connection& connection(std::uint32_t place) const { return connections_[place]; }

 private:
  struct Ends {
    EventNode source = 0;
    std::uint32_t from = 0, to = 0;  // slots
    EventNode target = 0;
    std::uint32_t event_in = 0;
  };
  [[nodiscard]] bool find_ends(SceneGraph& scene, const Route& route, Ends& ends);
  std::uint32_t connect(EventNode source, std::uint32_t from, EventNode to, std::uint32_t event_in, Way way);
  void disconnect(std::uint32_t connection);

  Execution& execution_;
  std::vector<Connection> connections_{1};  // [0] is unused
  std::vector<std::uint32_t> free_connections_, removed_connections_;
  std::unordered_map<std::uint64_t, std::uint32_t> routes_;  // connections by source and target slot
  std::uint64_t revision_ = 0;
};

}  // namespace gs::vrml
