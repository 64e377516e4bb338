#pragma once

#include "app/loading/world_loader.h"
#include "app/loading/world_loading.h"
#include "app/session/documents/documents.h"
#include "app/streams/load_ledger.h"

#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <unordered_map>
#include <unordered_set>
#include <vector>

namespace gs::app {

/// Reader of one world on an own thread, which reports progress meanwhile. Once the file is read, the world belongs to
/// the owner and time starts in it. Inlines, EXTERNPROTOs, images and vectors still load afterwards. Reported data is
/// moved or immutable, except for streams: they belong to the owner and are fed through `LoadedWorld::feeds`. The
/// owner's thread calls all functions below.
class WorldReader {
 public:
  /// Changes since the last call of `take`.
  struct News {
    /// A preview, or the complete world. A document without a scene could not be opened. Null if it has not changed.
    std::shared_ptr<Document> document;
    ResourceUpdates updates;    // for the running world
    bool over = false;          // only bytes of streams and results of `request` may follow
    bool streams_grew = false;  // bytes of streams were received
    LoadingState state;
  };

  /// Starts the thread. `wake` is called on that thread when there is news, and must be thread-safe.
  WorldReader(std::string path, LoadOptions options, std::function<void()> wake);
  /// Waits for the thread, which ends as soon as it can.
  ~WorldReader();
  WorldReader(const WorldReader&) = delete;
  WorldReader& operator=(const WorldReader&) = delete;

  /// Stops loading and keeps the parts received so far, as if the time limit had passed.
  void cancel();
  /// Sets the apparent size of the nodes that still load over the network.
  void prioritize(std::unordered_map<const vrml::Node*, float> importance);
  /// Fetches urls that were set in the running world. Later news contain the results.
  void request(std::vector<UrlRequest> requests);
  /// Tells the thread to end as soon as it can, because no result is needed any more.
  void retire();
  /// Returns the nodes that parts are still loading for.
  [[nodiscard]] std::unordered_set<const vrml::Node*> wanted();
  /// Returns true if the thread has ended, so that the destructor does not wait.
  [[nodiscard]] bool ended() const { return stage_ == Stage::ended; }
  [[nodiscard]] News take();
  /// Returns the progress of its files and streams. Never null.
  [[nodiscard]] const std::shared_ptr<LoadLedger>& ledger() const { return ledger_; }

 private:
  void run(const std::string& path, LoadOptions options);
  void tell(News news);
  void give_away(WorldLoading& loading);
  void take_requests(WorldLoading& loading);
  void exchange_priorities(WorldLoading& loading);

  std::function<void()> wake_;
  const std::shared_ptr<LoadLedger> ledger_ = std::make_shared<LoadLedger>();
  std::atomic<bool> cancelled_ = false;  // LoadOptions::cancelled
  enum class Stage : std::uint8_t { running, retired, ended };
  std::atomic<Stage> stage_ = Stage::running;
  std::mutex mutex_;
  News news_;                                                               // guarded by mutex_
  WorldLoading* loading_ = nullptr;                                         // guarded by mutex_; used to wake it
  std::optional<std::unordered_map<const vrml::Node*, float>> importance_;  // guarded by mutex_; not passed on yet
  std::unordered_set<const vrml::Node*> wanted_;                            // guarded by mutex_
  std::vector<UrlRequest> requests_;                                        // guarded by mutex_
  std::jthread thread_;  // last member: joined before the members that it uses are destroyed
};

}  // namespace gs::app
