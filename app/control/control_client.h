#pragma once

#include "app/inspect/event_watch.h"
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

/// Node with its scene: the scene of the world, or the content of an Inline.
struct PlacedNode {
  vrml::SceneGraph* scene = nullptr;
  vrml::NodeId id;
};

/// State that all clients of one world share.
struct ControlledWorld {
  std::weak_ptr<Document> document;
  std::unique_ptr<vrml::NodeNames> names;  // null before the first client looks up a name
  /// Watches of each eventOut, as pairs of client number and watch number.
  std::unordered_map<WatchedEvent, std::vector<std::pair<std::uint64_t, std::uint64_t>>, HashWatchedEvent> watched;
};

/// Watch of a client on an eventOut.
struct Watch {
  vrml::SceneGraph* scene = nullptr;
  WatchedEvent event;
  std::optional<vrml::FieldValue> latest;  // last value, if it is not sent because the client reads slowly
  double time = 0;                         // timestamp of `latest`
  std::uint64_t missed = 0;  // number of dropped events before `latest`
};

/// Event that a client sends to a node.
struct ClientEvent {
  PlacedNode node;
  const vrml::InterfaceDeclaration* event_in = nullptr;
  vrml::FieldValue value;
};

/// Client with the nodes of its world. It refers to a node by a number, which keeps the node alive.
struct ControlClient {
  std::uint64_t number = 0;
  std::size_t viewport = 0;  // index among the visible viewports
  ControlledWorld* world = nullptr;                              // null while the viewport shows no world
  std::unordered_map<std::uint64_t, PlacedNode> nodes;  // nodes by their numbers
  std::unordered_map<std::uint64_t, std::uint64_t> known_nodes;  // number of each node, by generation and index
  std::uint64_t last_node = 0, last_watch = 0;
  std::map<std::uint64_t, Watch> watches;
  std::vector<std::uint64_t> late;  // numbers of the watches with a `latest`
  bool updates = false;  // true between beginUpdate and endUpdate
  std::vector<ClientEvent> update;
  std::size_t update_bytes = 0;  // bytes of JSON in that update so far
  bool wants_browser_events = false;  // true after adviseBrowser was called
  std::vector<std::string> waits_for_world;  // ids of unanswered awaitWorld calls
};

}  // namespace gs::app
