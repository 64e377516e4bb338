#pragma once

#include "app/base/load_limit.h"
#include "app/formats/qnv/surface_pictures.h"
#include "app/streams/cell_stream.h"
#include "app/streams/load_ledger.h"
#include "app/world/content_handler.h"
#include "app/world/updates/missing_url.h"
#include "app/world/updates/resource_updates.h"
#include "app/world/world_loading.h"
#include "base/budget.h"

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <vector>

// Implementation of WorldLoading. It finds the bytes by candidates, schemes and priorities: world_loading.cpp,
// world_fetches.cpp, world_network.cpp and world_cells.cpp. Content handlers convert them: scene_handler.h and
// scene_references.cpp to nodes, cloud_handler.h to vectors, outline_reader.h to polygons.

namespace gs::app {

class SceneHandler;
class OutlineHandler;

/// Event on which the reader thread waits.
class Waker {
 public:
  void wake();
  void wait(std::chrono::milliseconds time);

 private:
  std::mutex mutex_;
  std::condition_variable something_;
  bool awake_ = false;  // guarded by mutex_
};

struct WorldLoading::State {
  State(const std::string& asked, const LoadOptions& options);
  ~State();

  // world_loading.cpp
  void start();
  bool step(std::chrono::milliseconds wait);
  void fetch(std::unique_ptr<Fetch> fetch, Urgency urgency);
  void begin_next_candidate(Fetch& fetch);
  void ask(Fetch& fetch, std::vector<net::ByteRange> ranges);
  bool take_front(Fetch& fetch, const net::LoadHead& head);
  void take_rest(Fetch& fetch);
  bool begin_local(Fetch& fetch, const net::Url& url);
  void local_step();
  bool take_events();
  void take(Fetch& fetch, net::LoadEvent& event);
  void begin_taking(Fetch& fetch, const Found& found);
  void deliver(Fetch& fetch, std::span<const std::byte> bytes);
  void finish(Fetch& fetch, const std::optional<std::string>& problem);
  void stop(const std::string& why);
  void cancel_rows();
  void follow_rate();
  void cancel(Fetch& fetch);
  void fail_candidate(Fetch& fetch, const std::string& why, const std::string& folder = {});
  bool refuse_folder(const std::string& folder, const std::string& reference);
  void report(Severity severity, const std::string& file, SourceLocation at, std::string message) {
    world.diagnostics.add({severity, file, at, std::move(message)});
  }
  void set_priorities();
  /// Gives a QNV node new or better vectors.
  void cloud_arrived(ResourceUpdates::Cloud cloud);
  void image_arrived(ResourceUpdates::Image image);
  void media_arrived(ResourceUpdates::Media media);
  void text_arrived(ResourceUpdates::Text text);
  void note_progress(const UrlProgress& progress);
  void outlines_arrived(ResourceUpdates::Outlines outlines);
  /// Passes received polygons to the OutlineGroups.
  void give_outlines();
  // world_requests.cpp: urls that are set in a running world
  void request(std::vector<UrlRequest> requests);
  /// Cancels the fetches of a handler and its inner handlers.
  void withdraw(const SceneHandler& handler);
  void give_content(SceneHandler& handler);
  ResourceUpdates take_updates();
  net::Loader* network();
  // world_cells.cpp
  bool begin_cells(Fetch& fetch, const net::Url& url);
  void open_cells(Fetch& fetch, const net::Url& url);
  bool step_cells();
  void stop_cells(const Fetch* fetch);
  void cancel_cells(std::uint64_t row);
  void set_cell_rate();
  [[nodiscard]] net::CellClientStatistics cell_statistics() const;

  [[nodiscard]] ReadFile reader_of(const net::Origin& origin);
  BytesResult read_now(const std::string& url, const net::Origin& from);

  SurfacePictures pictures;
  LoadOptions options;
  std::shared_ptr<LoadLedger> ledger;
  net::ReferencePolicy policy;
  LoadLimit limit;
  WorldBudget budget;
  LoadedWorld world;                                        // after `take`: only the members that accompany updates
  ResourceUpdates updates;                                  // since `take`
  std::vector<std::shared_ptr<SceneHandler>> withheld;      // contents of Inlines with incomplete files
  std::unordered_map<const vrml::Node*, float> importance;  // as the owner of the world computes it
  render::MeshCache meshes;
  std::shared_ptr<SceneHandler> root;
  std::chrono::steady_clock::time_point started = std::chrono::steady_clock::now();
  glm::dvec3 viewer{0, 0, 10};

  std::unique_ptr<net::Loader> loader;  // created for the first network resource
  std::unordered_map<std::uint64_t, Fetch*> by_request;
  std::vector<std::unique_ptr<Fetch>> fetches;  // not complete
  std::deque<Fetch*> local;                     // read here, one after the other
  std::vector<Fetch*> ended;
  std::vector<std::unique_ptr<RangedStream>> streams;
  /// Resource that is received as cells.
  struct Cells;
  std::vector<std::shared_ptr<Cells>> cells;
  std::deque<Fetch*> waiting_cells;                // requested by documents
  std::unordered_set<std::string> silent_servers;  // asked for cells without an answer
  net::CellClientStatistics ended_cells;           // statistics of finished cell streams
  std::deque<net::LoadEvent> events;               // polled, not handled yet
  std::size_t files = 0;
  std::uint64_t received = 0;
  enum class Phase : std::uint8_t {
    loading,
    too_many_files,  // more references than the limit; the next step stops
    done,            // complete, unless more urls are set
    stopped,         // stopped before everything was received
  };
  Phase phase = Phase::loading;
  [[nodiscard]] bool is_done() const { return phase == Phase::done || phase == Phase::stopped; }
  bool changed = false, streams_grew = false;  // since the last query
  bool taken = false;                          // the running world owns the scene
  std::chrono::steady_clock::time_point next_priorities;

  // Resources that several nodes share, by fetch key.
  struct SharedImage;
  struct SharedCloud;
  struct SharedMedia;
  struct TextHandler;
  std::vector<std::shared_ptr<OutlineHandler>> outlines;  // with new polygons
  std::unordered_map<std::string, std::shared_ptr<SharedImage>> shared_images;
  std::unordered_map<std::string, std::shared_ptr<SharedCloud>> shared_clouds;
  std::unordered_map<std::string, std::shared_ptr<SharedMedia>> shared_media;

  std::shared_ptr<Waker> waker = std::make_shared<Waker>();
};

}  // namespace gs::app
