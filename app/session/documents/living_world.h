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

/// Seconds since 1970-01-01 00:00 GMT, as worlds count them (VRML97 4.11). Never goes back.
[[nodiscard]] double world_time();

/// The RenderList of a living world as one viewer sees it. Several may look through the same one where nothing in the
/// world depends on the viewer.
struct LivingScene {
  render::RenderScene scene;
  std::uint64_t version = 0;  // of the world, that the list shows
};

/// A world in which time goes on: its events, and the lists of those who look at it, which follow them. One thread,
/// that of the world; the world and the cache must outlive it.
class LivingWorld {
 public:
  LivingWorld(OpenedWorld& world, render::MeshCache& meshes);
  ~LivingWorld();
  LivingWorld(const LivingWorld&) = delete;
  LivingWorld& operator=(const LivingWorld&) = delete;

  /// How the programs of Scripts are run, from `start` on.
  void set_script_settings(ScriptRunner::Settings settings) { script_settings_ = settings; }
  /// What the programs print and what is wrong with them; else take_script_messages has it.
  void observe_scripts(std::function<void(const ScriptMessage&)> observer);
  [[nodiscard]] std::vector<ScriptMessage> take_script_messages();
  /// Makes nodes of a text, see make_nodes; Scripts among them run from the next event on.
  [[nodiscard]] vrml::RunTimeNodes create(vrml::SceneGraph& scene, const std::string& label, std::string_view text,
                                          vrml::Diagnostics& diagnostics, const vrml::SourceText* written_by,
                                          std::shared_ptr<const vrml::TextSource> fetched_from = nullptr);
  /// Runs a line as a part of the program of a Script, see ScriptRunner::evaluate, with all that follows from it; of a
  /// null node, as a program of its own, which knows what Scripts know of the browser (VRML97 4.12.10) and what lines
  /// before have made. From `start` on.
  [[nodiscard]] ScriptRunner::Evaluation evaluate(const vrml::SceneGraph& scene, vrml::NodeId script,
                                                  const std::string& line);
  /// A file's nodes are to be sent to an eventIn (createVrmlFromURL): see ScriptRequest::Kind::create_from_url.
  void create_from_url(ScriptRequest request) { ask_for_text(std::move(request), false); }
  /// What programs may ask about the browser: as of the last step; its speed and frame rate, where there are Scripts or
  /// `measure_viewer` was called.
  [[nodiscard]] const BrowserState& browser() const { return browser_; }
  void measure_viewer() { measures_viewer_ = true; }
  [[nodiscard]] std::vector<ScriptRequest> take_script_requests();
  /// Of the world's thread from `start` on; null: the world has no Script.
  [[nodiscard]] ScriptRunner* scripts() { return scripts_.get(); }
  [[nodiscard]] bool has_started() const { return started_; }
  /// Begins at `now`, in seconds since 1970; with the first cascade. Call once, on the thread that steps it then.
  void start(double now);
  /// Lets time go on to `now`. True when something has changed.
  bool step(double now);
  /// The movies show the pictures of the present time: at once with `wait`, else as soon as they are decoded. True when
  /// one shows another than before.
  bool show_movies(bool wait);
  /// How often one has: their pixels change where they are.
  [[nodiscard]] std::uint64_t movie_pictures() const { return movie_pictures_; }
  /// An event that the user has caused. False: there is no such node or eventIn, or the value is of another type.
  bool send(const vrml::SceneGraph& scene, vrml::NodeId node, std::string_view event_in, const vrml::FieldValue& value);
  /// Large meshes of what changes are made there from now on, while the former ones are shown.
  void set_mesh_worker(std::shared_ptr<render::MeshWorker> worker);
  /// A frame begins: takes in the meshes that are done. True when something has changed.
  bool take_meshes();
  /// Takes in what has come.
  void arrive(Arrivals&& arrivals);
  /// The urls that have been set since the last call, for who fetches; what comes goes to `arrive`.
  [[nodiscard]] std::vector<UrlRequest> take_url_requests();
  /// Opens the target of an Anchor like a loadURL of a Script if a Script may have computed its url. Returns false
  /// otherwise: the caller opens it.
  bool open_computed_anchor(vrml::SceneGraph& scene, vrml::NodeId anchor);
  /// URL of the first private file that a Script of this world has read; empty if there is none.
  [[nodiscard]] const std::string& private_file() const;
  /// Treats the world as if a Script had read this file, for a world that such a Script has opened.
  void assume_private(const std::string& file) { assumed_private_ = file; }
  /// The question whether Scripts that have read a private file may use the network; nullopt if none waits.
  [[nodiscard]] std::optional<NetworkQuestion> network_question() const { return gate_.question(); }
  void answer_network_question(bool allow) { allow ? gate_.allow() : gate_.refuse(); }
  /// When there is something to do next; see Execution::next_time.
  [[nodiscard]] std::optional<double> next_time() const {
    return progress_.empty() && durations_.empty() && !movies_run_ ? execution_.next_time() : execution_.now();
  }

  /// A list for one who looks from `viewer`. `own`: not shared.
  [[nodiscard]] std::shared_ptr<LivingScene> look(const glm::dvec3& viewer, bool own);
  /// Brings the list up to date, for one who is at `viewer` now. True when it is another than before.
  bool show(LivingScene& scene, const glm::dvec3& viewer);

  /// Which bindable nodes are bound.
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
  std::optional<glm::dvec3> viewer_;  // in the last step
  bool started_ = false;
  std::deque<std::vector<vrml::NodeChange>> batches_;  // those that led to the last versions, the newest behind
  std::uint64_t version_ = 0;
  std::uint32_t replaced_ = 0;            // Execution::replaced, of the newest version
  std::vector<UrlProgress> progress_;     // that is to be told
  std::vector<MediaDuration> durations_;  // likewise
  struct PlayedMovie {
    vrml::SceneGraph* scene;
    vrml::NodeId id;
    const vrml::Node* node;
    std::shared_ptr<MoviePlayers::Player> player;
  };
  MoviePlayers players_;
  std::vector<PlayedMovie> movies_;
  std::uint64_t movie_pictures_ = 0;
  bool movies_run_ = false;  // the picture of one goes on
  std::vector<UrlRequest> url_requests_;
  NetworkGate gate_;
  std::string assumed_private_;
  /// Arrivals::Place::request of the newest, where not 0.
  std::unordered_map<render::ImagePlace, std::uint32_t, render::HashImagePlace> url_numbers_;
  std::weak_ptr<LivingScene> shared_;
  std::vector<ScriptMessage> script_messages_;  // of what no program has said
  bool measures_viewer_ = false;
  vrml::NodeId console_;  // the Script that lines of nobody's are part of
};

}  // namespace gs::app
