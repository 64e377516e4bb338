#pragma once

#include "app/session/documents/documents.h"
#include "vrml/scene/node_names.h"
#include "vrml/scene/scene_graph.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

namespace gs::app {

/// Node with its scene, which is that of the world or of an Inline.
struct PlacedNode {
  vrml::SceneGraph* scene = nullptr;
  vrml::NodeId id;
};

/// eventOut of a node of a world.
struct WatchedEvent {
  vrml::NodeId node;
  const vrml::InterfaceDeclaration* event = nullptr;
  friend bool operator==(const WatchedEvent&, const WatchedEvent&) = default;
};
struct HashWatchedEvent {
  std::size_t operator()(const WatchedEvent& one) const {
    return std::hash<std::uint64_t>()(std::uint64_t{one.node.generation} << 32 | one.node.index) * 31 +
           std::hash<const void*>()(one.event);
  }
};

/// State of the clients of one world.
struct ControlledWorld {
  std::weak_ptr<Document> document;
  std::unique_ptr<vrml::NodeNames> names;  // null until a client looks up a name
  /// Numbers of the client and of its watch, by watched event.
  std::unordered_map<WatchedEvent, std::vector<std::pair<std::uint64_t, std::uint64_t>>, HashWatchedEvent> watched;
};

/// eventOut that a client watches.
struct Watch {
  vrml::SceneGraph* scene = nullptr;
  WatchedEvent event;
  std::optional<vrml::FieldValue> latest;  // not sent yet, because the client reads slowly
  double time = 0;                         // timestamp of `latest`
  std::uint64_t missed = 0;                // number of events that were dropped before `latest`
};

/// Event that a client sends.
struct ClientEvent {
  PlacedNode node;
  const vrml::InterfaceDeclaration* event_in = nullptr;
  vrml::FieldValue value;
};

/// Client with its nodes of a world. Numbers refer to nodes, which are kept alive for it.
struct ControlClient {
  std::uint64_t number = 0;
  std::size_t viewport = 0;                                      // visible viewport with the client's world
  ControlledWorld* world = nullptr;                              // null while the viewport shows no world
  std::unordered_map<std::uint64_t, PlacedNode> nodes;           // by number
  std::unordered_map<std::uint64_t, std::uint64_t> known_nodes;  // numbers of nodes, by generation and index
  std::uint64_t last_node = 0, last_watch = 0;
  std::map<std::uint64_t, Watch> watches;
  std::vector<std::uint64_t> late;  // watches with a `latest`
  bool updates = false;             // between beginUpdate and endUpdate
  std::vector<ClientEvent> update;
  std::size_t update_bytes = 0;              // size of the messages of the update
  bool wants_browser_events = false;         // adviseBrowser was called
  std::vector<std::string> waits_for_world;  // ids of awaitWorld calls
};

}  // namespace gs::app
