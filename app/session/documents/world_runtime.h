#pragma once

#include "app/media/movie_player.h"
#include "app/script/script_runner.h"
#include "app/session/documents/network_gate.h"
#include "app/world/arrivals.h"
#include "app/world/opened_world.h"
#include "render/scene/render_scene.h"
#include "vrml/events/execution.h"
#include "vrml/syntax/parser.h"

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

namespace gs::render {
class MeshWorker;
}

namespace gs::app {

/// Returns the seconds since 1970-01-01 00:00 GMT, the time of worlds (VRML97 4.11). Never goes back.
[[nodiscard]] double world_time();

/// Render list of a running world for one viewer. Several views share it if nothing in the world depends on the viewer.
struct RuntimeScene {
  render::RenderScene scene;
  std::uint64_t version = 0;  // version of the world that the list shows
};

/// World in which time passes: its events, and the render lists of its views. Used by one thread, the world's. The
/// world and the cache must outlive it.
class WorldRuntime {
 public:
  WorldRuntime(OpenedWorld& world, render::MeshCache& meshes);
  ~WorldRuntime();
  WorldRuntime(const WorldRuntime&) = delete;
  WorldRuntime& operator=(const WorldRuntime&) = delete;

  /// Sets how Script programs run. Call before `start`.
  void set_script_settings(ScriptRunner::Settings settings) { script_settings_ = settings; }
  /// Sets the receiver of script messages. Without one, take_script_messages() returns them.
  void observe_scripts(std::function<void(const ScriptMessage&)> observer);
  [[nodiscard]] std::vector<ScriptMessage> take_script_messages();
  /// Makes nodes from VRML text; see make_nodes(). Scripts among them run from the next event on.
  [[nodiscard]] vrml::RunTimeNodes create(vrml::SceneGraph& scene, const std::string& label, std::string_view text,
                                          vrml::Diagnostics& diagnostics, const vrml::SourceText* written_by,
                                          std::shared_ptr<const vrml::TextSource> fetched_from = nullptr);
  /// Runs a line as part of a Script's program, and the events that follow; see ScriptRunner::evaluate(). With a null
  /// node, the line belongs to a console program, which has the browser's interface (VRML97 4.12.10) and the results of
  /// earlier lines. Call after `start`.
  [[nodiscard]] ScriptRunner::Evaluation evaluate(const vrml::SceneGraph& scene, vrml::NodeId script,
                                                  const std::string& line);
  /// Fetches a file and sends its nodes to an eventIn (createVrmlFromURL); see ScriptRequest::Kind::create_from_url.
  void create_from_url(ScriptRequest request) { ask_for_text(std::move(request), false); }
  /// Returns the browser state that programs can query, as of the last step. Speed and frame rate are set only if the
  /// world has Scripts or `measure_viewer` was called.
  [[nodiscard]] const BrowserState& browser() const { return browser_; }
  void measure_viewer() { measures_viewer_ = true; }
  [[nodiscard]] std::vector<ScriptRequest> take_script_requests();
  /// Returns the script runner, or null if the world has no Script. Used by the world's thread after `start`.
  [[nodiscard]] ScriptRunner* scripts() { return scripts_.get(); }
  [[nodiscard]] bool has_started() const { return started_; }
  /// Starts the world at `now`, in seconds since 1970, with the first cascade. Call once, on the thread that calls
  /// `step`.
  void start(double now);
  /// Advances time to `now`. Returns true if something changed.
  bool step(double now);
  /// Shows the movie frames of the present time. With `wait`, blocks until they are decoded; otherwise shows them as
  /// soon as they are. Returns true if a frame changed.
  bool show_movies(bool wait);
  /// Returns the number of frames that movies have shown. Their pixels change in place.
  [[nodiscard]] std::uint64_t movie_pictures() const { return movie_pictures_; }
  /// Sends an event of the user. Returns false if the node or eventIn is missing, or if the value has another type.
  bool send(const vrml::SceneGraph& scene, vrml::NodeId node, std::string_view event_in, const vrml::FieldValue& value);
  /// Sets the worker that makes large meshes of changed geometry. The former meshes are drawn meanwhile.
  void set_mesh_worker(std::shared_ptr<render::MeshWorker> worker);
  /// Takes the finished meshes at the start of a frame. Returns true if something changed.
  bool take_meshes();
  /// Applies received updates.
  void arrive(Arrivals&& arrivals);
  /// Returns the urls that were set since the last call. The caller fetches them and passes the results to `arrive`.
  [[nodiscard]] std::vector<UrlRequest> take_url_requests();
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
  /// Returns the time of the next event; see Execution::next_time().
  [[nodiscard]] std::optional<double> next_time() const {
    return progress_.empty() && durations_.empty() && !movies_run_ ? execution_.next_time() : execution_.now();
  }

  /// Returns a render list for a viewer at `viewer`. With `own`, the list is not shared.
  [[nodiscard]] std::shared_ptr<RuntimeScene> look(const glm::dvec3& viewer, bool own);
  /// Updates a render list for the viewer at `viewer`. Returns true if it changed.
  bool show(RuntimeScene& scene, const glm::dvec3& viewer);

  /// Returns the bound nodes of each bindable type.
  [[nodiscard]] render::BoundNodes bound() const;
  [[nodiscard]] vrml::Execution& execution() { return execution_; }

 private:
  bool take_changes();
  void want_scripts();
  void tell_programs(double now);
  void ask_for_texts();
  void ask_for_text(ScriptRequest&& one, bool computed);
  void watch_private_files();
  void warn_held_back(const std::vector<std::string>& messages);
  void tell_message(ScriptMessage message);
  void take_text(Arrivals::Text&& arrival);
  void tell_progress();
  void tell_durations();
  void open_movie(const MediaDuration& of);
  void add_changes(std::vector<vrml::NodeChange> changes);
  void forget(vrml::SceneGraph& scene, vrml::NodeId node);
  void note_urls(std::span<const vrml::NodeChange> changes);
  [[nodiscard]] bool is_gone(const Arrivals::Place& place) const;
  void show_content(Arrivals::Content&& arrival);
  void take_prototypes(Arrivals::Prototypes&& arrival);
  void take_outlines(Arrivals::Outlines&& arrival, std::vector<vrml::NodeChange>& changes);
  void ask_for_prototype(vrml::SceneGraph& scene, vrml::NodeId instance);

  OpenedWorld& world_;
  render::MeshCache& meshes_;
  vrml::Execution execution_;
  ScriptRunner::Settings script_settings_{0.05, false};
  std::function<void(const ScriptMessage&)> script_observer_;
  std::unique_ptr<ScriptRunner> scripts_;
  std::vector<ScriptRequest> script_requests_;
  std::unordered_map<std::size_t, ScriptRequest> asked_texts_;  // by number
  std::size_t next_text_ = 0;
  BrowserState browser_;
  std::optional<glm::dvec3> viewer_;  // position in the last step
  bool started_ = false;
  std::deque<std::vector<vrml::NodeChange>> batches_;  // changes that led to the last versions, newest last
  std::uint64_t version_ = 0;
  std::uint32_t replaced_ = 0;            // Execution::replaced of the newest version
  std::vector<UrlProgress> progress_;     // not yet reported to the nodes
  std::vector<MediaDuration> durations_;  // not yet reported to the nodes
  struct PlayedMovie {
    vrml::SceneGraph* scene;
    vrml::NodeId id;
    const vrml::Node* node;
    std::shared_ptr<MoviePlayers::Player> player;
  };
  MoviePlayers players_;
  std::vector<PlayedMovie> movies_;
  std::uint64_t movie_pictures_ = 0;
  bool movies_run_ = false;  // at least one movie is playing
  std::vector<UrlRequest> url_requests_;
  NetworkGate gate_;
  std::string assumed_private_;
  /// Newest Arrivals::Place::request of each place, if not 0.
  std::unordered_map<render::ImagePlace, std::uint32_t, render::HashImagePlace> url_numbers_;
  std::weak_ptr<RuntimeScene> shared_;
  std::vector<ScriptMessage> script_messages_;  // messages of this class, not of programs
  bool measures_viewer_ = false;
  vrml::NodeId console_;  // Script to which the console's lines belong
};

}  // namespace gs::app
