#pragma once

#include "vrml/events/event_nodes.h"
#include "vrml/events/imported_routes.h"
#include "vrml/scene/scene_graph.h"

#include <cstdint>
#include <unordered_map>
#include <vector>

namespace gs::vrml {

/// ROUTE, and the scenes of its nodes. They differ if one of the nodes is imported.
struct PlacedRoute {
  const SceneGraph* scene = nullptr;     // of the source
  const SceneGraph* to_scene = nullptr;  // of the target
  Route route;
};

/// Connections that events of a world follow: ROUTEs, and the IS connections of PROTO instances. Part of Execution.
class RouteTable {
 public:
  enum class Way : std::uint8_t {
    route,    // from an eventOut to an eventIn, by ROUTE
    down,     // from an eventIn of a PROTO instance to an eventIn of a body node (4.8.2)
    up,       // from an eventOut of a body node to an eventOut of the instance
    removed,  // remains until the cascade ends, which may still follow it
  };
  struct Connection {
    std::uint32_t next = 0, previous = 0;
    std::uint32_t next_in = 0, previous_in = 0;  // neighbours in the list of the connections to the node `to`
    EventNode source = 0;
    std::uint32_t from = 0;  // index of the source's slot
    EventNode to = 0;
    std::uint32_t event_in = 0;  // index in the interfaces of the target's EventSchema
    Way way = Way::route;
  };

  explicit RouteTable(Execution& execution) : execution_(execution), imports_(execution) {}

  /// Adds a ROUTE, which does not appear in SceneGraph::routes. Returns false if the ROUTE exists already, or if the
  /// budget is exhausted. Also returns false if the ROUTE does not connect nodes of one scene with equal types.
  bool add(SceneGraph& scene, const Route& route) { return add(scene, scene, route); }
  /// Adds a ROUTE from a node of `from` to a node of `to`. Its values must not contain nodes if the scenes differ.
  bool add(SceneGraph& from, SceneGraph& to, const Route& route);
  /// Removes a ROUTE. Returns false if it does not exist.
  bool remove(SceneGraph& scene, const Route& route);
  /// Returns all ROUTEs of files, PROTO instances, Inlines and programs, in the order in which they were created.
  [[nodiscard]] std::vector<PlacedRoute> all() const;
  /// Reports whether a ROUTE or IS leads from an event to another node. `event` is an index in Behaviour::events.
  [[nodiscard]] bool is_listened_to(EventNode node, int event) const;
  /// Returns the ROUTEs with imported nodes.
  [[nodiscard]] ImportedRoutes& imports() { return imports_; }
  /// Returns a counter that increases whenever a ROUTE is added or removed.
  [[nodiscard]] std::uint64_t revision() const { return revision_; }

  /// Connects the interfaces of a PROTO instance to the nodes of its body, according to IS. Returns false if the budget
  /// is exhausted.
  bool connect_instance(SceneGraph& scene, NodeId instance);
  /// Removes all connections from and to a node.
  void disconnect_all(EventNode node);
  /// Makes the entries of removed connections available again. Call it only between cascades.
  void reuse_removed();

  [[nodiscard]] const Connection& connection(std::uint32_t place) const { return connections_[place]; }

 private:
  struct Ends {
    EventNode source = 0;
    std::uint32_t from = 0, to = 0;  // indices of the source's and the target's slot
    EventNode target = 0;
    std::uint32_t event_in = 0;
  };
  [[nodiscard]] bool find_ends(SceneGraph& from, SceneGraph& to, const Route& route, Ends& ends);
  void note_listener(EventNode source);
  std::uint32_t connect(EventNode source, std::uint32_t from, EventNode to, std::uint32_t event_in, Way way);
  void disconnect(std::uint32_t connection);

  Execution& execution_;
  ImportedRoutes imports_;
  std::vector<Connection> connections_{1};  // index 0 is unused
  std::vector<std::uint32_t> free_connections_, removed_connections_;
  std::unordered_map<std::uint64_t, std::uint32_t> routes_;  // connections, by source slot and target slot
  std::uint64_t revision_ = 0;
};

}  // namespace gs::vrml
