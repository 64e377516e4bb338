#pragma once

#include "app/loading/updates/loaded_world.h"
#include "app/loading/updates/resource_updates.h"
#include "app/session/running/network_gate.h"
#include "app/session/running/world_programs.h"
#include "render/collection/render_scene.h"
#include "vrml/events/execution.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

namespace gs::app {

/// Requests of a running world for URLs and texts, including the network gate. Use on the world's thread.
class RunTimeRequests {
 public:
  RunTimeRequests(LoadedWorld& world, vrml::Execution& execution, WorldPrograms& programs);

  /// Requests the content of changed url fields, and the bodies of EXTERNPROTOs of new nodes.
  void note_changes(std::span<const vrml::NodeChange> changes);
  /// Requests the content of the url fields of nodes again.
  void refresh(std::span<const vrml::NodeChange> nodes);
  /// Returns the urls that were set since the last call.
  [[nodiscard]] std::vector<UrlRequest> take_url_requests();
  /// Returns the requests of Scripts that the session must fulfil.
  [[nodiscard]] std::vector<ScriptRequest> take_script_requests();
  /// Fetches a file and sends its nodes to an eventIn (createVrmlFromURL). See ScriptRequest::Kind::create_from_url.
  void create_from_url(ScriptRequest request) { request_text(std::move(request), false); }
  /// Applies a text that was fetched.
  void take_text(ResourceUpdates::Text&& update);
  /// Reports whether an update is stale: its node, scene or URL no longer exists.
  [[nodiscard]] bool is_stale(const ResourceUpdates::Place& place) const;
  /// Opens the target of an Anchor in the way of loadURL, if a Script may have computed its url. Otherwise returns
  /// false, and the caller must open the target.
  bool open_computed_anchor(vrml::SceneGraph& scene, vrml::NodeId anchor);

  /// Returns the URL of the first private file that a Script of this world has read, or an empty string.
  [[nodiscard]] const std::string& private_file() const;
  /// Treats the world as if its Scripts had read the private file. Used if a Script that read the file opened this
  /// world.
  void assume_private(const std::string& file) { assumed_private_ = file; }
  /// Returns the question whether Scripts that have read a private file may use the network; nullopt if nothing is to
  /// be decided.
  [[nodiscard]] std::optional<NetworkQuestion> network_question() const { return gate_.question(); }
  void answer_network_question(bool allow) { allow ? gate_.allow() : gate_.refuse(); }

  /// Drops the requests of a node that is removed. forget_scene() does so for a scene. Required because their addresses
  /// may be reused.
  void forget_node(const vrml::Node& node);
  void forget_scene(const vrml::SceneGraph& scene);

 private:
  void request_url(const vrml::NodeChange& change, std::size_t field, bool refresh);
  void request_texts();
  void request_text(ScriptRequest&& one, bool computed);
  void request_prototype(vrml::SceneGraph& scene, vrml::NodeId instance);
  void watch_private_files();
  void warn_held_back(const std::vector<std::string>& messages);

  LoadedWorld& world_;
  vrml::Execution& execution_;
  WorldPrograms& programs_;
  NetworkGate gate_;
  std::string assumed_private_;
  std::vector<UrlRequest> url_requests_;
  std::vector<ScriptRequest> script_requests_;
  std::unordered_map<std::size_t, ScriptRequest> asked_texts_;  // requested texts, by request number
  std::size_t next_text_ = 0;
  /// Newest ResourceUpdates::Place::request of each place, if not 0.
  std::unordered_map<render::ImagePlace, std::uint32_t, render::HashImagePlace> url_numbers_;
};

}  // namespace gs::app
