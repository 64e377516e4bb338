#pragma once

#include "app/loading/updates/loaded_world.h"
#include "app/loading/updates/resource_updates.h"
#include "app/loading/updates/url_refresh.h"
#include "app/session/rays/world_rays.h"
#include "app/session/running/run_time_requests.h"
#include "app/session/running/world_movies.h"
#include "app/session/running/world_programs.h"
#include "base/noncopyable.h"
#include "render/collection/render_scene.h"
#include "vrml/events/execution.h"

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace gs::render {
class MeshWorker;
}

namespace gs::app {

/// Returns the time of worlds: seconds since 1970-01-01 00:00 GMT (VRML97 4.11). It never decreases.
[[nodiscard]] double world_time();

/// Render scene of a running world for one viewer. Several views share one if the world does not depend on the viewer.
struct RuntimeScene {
  render::RenderScene scene;
  std::uint64_t version = 0;  // version of the world to which the list was updated
};

/// World in which time passes: its events, and the render lists of its views. Use on one thread. The opened world and
/// the mesh cache must outlive it.
class WorldRuntime : NonCopyable {
 public:
  WorldRuntime(LoadedWorld& world, render::MeshCache& meshes);
  ~WorldRuntime();

  /// Returns the Scripts of the world and their browser properties.
  [[nodiscard]] WorldPrograms& programs() { return programs_; }
  /// Returns the requests of the world for URLs, texts and other worlds.
  [[nodiscard]] RunTimeRequests& requests() { return requests_; }
  /// Returns the movies of the world. Their pixels change in place.
  [[nodiscard]] WorldMovies& movies() { return movies_; }
  [[nodiscard]] bool has_started() const { return started_; }
  /// Starts the world at `now`, in seconds since 1970, and runs the first cascade. Call once, on the thread that calls
  /// step().
  void start(double now);
  /// Advances time to `now`, in seconds since 1970. Returns true if the world changed.
  bool step(double now);
  /// Sends an event to a node on behalf of the user. Returns false if the node or eventIn does not exist, or if the
  /// value has another type.
  bool send(const vrml::SceneGraph& scene, vrml::NodeId node, std::string_view event_in, const vrml::FieldValue& value);
  /// Sets the worker that makes large meshes when geometry changes. Until a new mesh is ready, the old one is drawn.
  void set_mesh_worker(std::shared_ptr<render::MeshWorker> worker);
  /// Takes the meshes that the worker has finished. Call at the start of a frame. Returns true if a mesh changed.
  bool take_meshes();
  /// Applies updates from the reader.
  void arrive(ResourceUpdates&& updates);
  /// Returns the url fields that were set since the last call. The caller must fetch them and pass the results to
  /// arrive().
  [[nodiscard]] std::vector<UrlRequest> take_url_requests();
  /// Returns the time of the next event; see Execution::next_time().
  [[nodiscard]] std::optional<double> next_time() const;

  /// Returns a render scene for a viewer at `viewer`, in world space. If `own`, no other view shares it.
  [[nodiscard]] std::shared_ptr<RuntimeScene> look(const glm::dvec3& viewer, bool own);
  /// Updates a render scene to the present state of the world and a viewer at `viewer`. Returns true if the list
  /// changed.
  bool show(RuntimeScene& scene, const glm::dvec3& viewer);

  /// Returns the bound node of each bindable type.
  [[nodiscard]] render::BoundNodes bound() const;
  [[nodiscard]] vrml::Execution& execution() { return execution_; }

 private:
  class Work;
  void note_halt();
  void add_layers(const vrml::LayerSet& set, render::BoundNodes& nodes) const;
  bool take_changes();
  void note_loaded();
  void note_load(const ResourceUpdates::Place& place, bool loaded);
  void tell_progress();
  void tell_durations();
  void add_changes(std::vector<vrml::NodeChange> changes);
  void forget(vrml::SceneGraph& scene, vrml::NodeId node);
  void show_content(ResourceUpdates::Content&& update);
  void take_prototypes(ResourceUpdates::Prototypes&& update);
  void take_outlines(ResourceUpdates::Outlines&& update, std::vector<vrml::NodeChange>& changes);

  LoadedWorld& world_;
  render::MeshCache& meshes_;
  vrml::Execution execution_;
  WorldPrograms programs_{world_, execution_};
  RunTimeRequests requests_{world_, execution_, programs_};
  WorldMovies movies_{world_, execution_};
  UrlRefresh refresh_{execution_};
  WorldRays rays_{world_, meshes_, execution_, [this] { return bound(); }};
  bool started_ = false, told_halt_ = false;
  std::deque<std::vector<vrml::NodeChange>> batches_;  // changes of the last versions, newest last
  std::uint64_t version_ = 0;
  std::uint32_t replaced_ = 0;            // NodeLifetime::replaced() at the newest version
  std::vector<UrlProgress> progress_;     // progress that was not reported to the nodes yet
  std::vector<MediaDuration> durations_;  // durations that were not reported to the nodes yet
  std::weak_ptr<RuntimeScene> shared_;
};

}  // namespace gs::app
