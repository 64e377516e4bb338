#pragma once

#include "app/loading/updates/loaded_world.h"
#include "app/loading/updates/resource_updates.h"
#include "app/session/documents/network_gate.h"
#include "app/session/documents/world_programs.h"
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

/// URLs and texts that a running world requests, and the network gate for them. Used by the world's thread.
class RunTimeRequests {
 public:
  RunTimeRequests(LoadedWorld& world, vrml::Execution& execution, WorldPrograms& programs);

  /// Requests the urls among changed fields, and the bodies of EXTERNPROTOs.
  void note_changes(std::span<const vrml::NodeChange> changes);
  /// Returns the urls that were set since the last call.
  [[nodiscard]] std::vector<UrlRequest> take_url_requests();
  /// Returns the requests of programs that the session must serve.
  [[nodiscard]] std::vector<ScriptRequest> take_script_requests();
  /// Fetches a file and sends its nodes to an eventIn (createVrmlFromURL); see ScriptRequest::Kind::create_from_url.
  void create_from_url(ScriptRequest request) { request_text(std::move(request), false); }
  /// Applies a received text.
  void take_text(ResourceUpdates::Text&& update);
  /// Reports whether an update is stale: its node, scene or URL no longer exists.
  [[nodiscard]] bool is_stale(const ResourceUpdates::Place& place) const;
  /// Opens the target of an Anchor like loadURL of a Script, if a Script may have computed its url. Returns false
  /// otherwise; the caller then opens the target.
  bool open_computed_anchor(vrml::SceneGraph& scene, vrml::NodeId anchor);

  /// Returns the URL of the first private file that a Script of this world has read, or an empty string.
  [[nodiscard]] const std::string& private_file() const;
  /// Treats the world as if a Script had read this file. For worlds that such a Script has opened.
  void assume_private(const std::string& file) { assumed_private_ = file; }
  /// Returns the question whether Scripts that have read a private file may use the network, or nullopt if none waits.
  [[nodiscard]] std::optional<NetworkQuestion> network_question() const { return gate_.question(); }
  void answer_network_question(bool allow) { allow ? gate_.allow() : gate_.refuse(); }

  /// Drops the requests of a removed node or scene, because their addresses may be reused.
  void forget_node(const vrml::Node& node);
  void forget_scene(const vrml::SceneGraph& scene);

 private:
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
  std::unordered_map<std::size_t, ScriptRequest> asked_texts_;  // by number
  std::size_t next_text_ = 0;
  /// Newest ResourceUpdates::Place::request of each place, if not 0.
  std::unordered_map<render::ImagePlace, std::uint32_t, render::HashImagePlace> url_numbers_;
};

}  // namespace gs::app
