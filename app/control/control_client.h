#pragma once

#include "app/session/documents/documents.h"
#include "vrml/events/node_names.h"
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

/// A node of a world, and in which of its scenes.
struct PlacedNode {
  vrml::SceneGraph* scene = nullptr;
  vrml::NodeId id;
};

/// An eventOut of a node of a world.
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

/// What clients do in one world.
struct ControlledWorld {
  std::weak_ptr<Document> document;
  std::unique_ptr<vrml::NodeNames> names;  // null: nobody has asked for one
  /// Who is told, by number of the client and of what it watches.
  std::unordered_map<WatchedEvent, std::vector<std::pair<std::uint64_t, std::uint64_t>>, HashWatchedEvent> watched;
};

/// An eventOut that a client is told of.
struct Watch {
  vrml::SceneGraph* scene = nullptr;
  WatchedEvent event;
  std::optional<vrml::FieldValue> latest;  // that it was not told of, since it has much to read
  double time = 0;                         // of that
  std::uint64_t missed = 0;                // events before that which it is never told of
};

/// An event that a client sends.
struct ClientEvent {
  PlacedNode node;
  const vrml::InterfaceDeclaration* event_in = nullptr;
  vrml::FieldValue value;
};

/// A client, and what it has of a world: numbers stand for nodes, which are held for it.
struct ControlClient {
  std::uint64_t number = 0;
  std::size_t viewport = 0;                                      // in sight, whose world it is about
  ControlledWorld* world = nullptr;                              // null: none has come there, yet
  std::unordered_map<std::uint64_t, PlacedNode> nodes;           // by number
  std::unordered_map<std::uint64_t, std::uint64_t> known_nodes;  // numbers, by generation and index
  std::uint64_t last_node = 0, last_watch = 0;
  std::map<std::uint64_t, Watch> watches;
  std::vector<std::uint64_t> late;  // watches with a `latest`
  bool updates = false;             // between beginUpdate and endUpdate
  std::vector<ClientEvent> update;
  std::size_t update_bytes = 0;              // of the messages that made it
  bool wants_browser_events = false;         // adviseBrowser
  std::vector<std::string> waits_for_world;  // ids of calls of awaitWorld
};

}  // namespace gs::app
