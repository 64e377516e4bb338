#pragma once

#include "app/loading/world_loader.h"
#include "app/loading/world_loading.h"
#include "app/session/documents/documents.h"
#include "app/streams/load_ledger.h"
#include "base/noncopyable.h"

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
class WorldReader : NonCopyable {
 public:
  /// Changes since the last call of take().
  struct News {
    /// Preview or complete document, if there is a new one, else null. A complete document without a scene means that
    /// the world could not be opened.
    std::shared_ptr<Document> document;
    ResourceUpdates updates;    // updates for the running world
    bool over = false;          // loading has finished; only bytes of streams and results of request() may follow
    bool streams_grew = false;  // bytes of streams were received
    LoadingState state;
  };

  /// Starts the thread. It calls `wake` when take() would return something new. `wake` must be thread-safe.
  WorldReader(std::string path, LoadOptions options, std::function<void()> wake);
  /// Waits for the end of the thread, which is soon.
  ~WorldReader();

  /// Stops loading as if the time limit had passed: the parts that were received remain.
  void cancel();
  /// Sets the importance of nodes that still load over the network: their apparent size.
  void prioritize(std::unordered_map<const vrml::Node*, float> importance);
  /// Requests URLs that were set in the running world. A later result of take() contains their contents.
  void request(std::vector<UrlRequest> requests);
  /// Asks the thread to end soon, because its results are no longer needed.
  void retire();
  /// Returns the nodes for which something is still loading.
  [[nodiscard]] std::unordered_set<const vrml::Node*> wanted();
  /// Returns true if the thread has ended, so that the destructor does not wait.
  [[nodiscard]] bool ended() const { return stage_ == Stage::ended; }
  [[nodiscard]] News take();
  /// Returns the progress of this world's files and streams. Never null.
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
  WorldLoading* loading_ = nullptr;                                         // guarded by mutex_; for waking it
  std::optional<std::unordered_map<const vrml::Node*, float>> importance_;  // guarded by mutex_; not passed on yet
  std::unordered_set<const vrml::Node*> wanted_;                            // guarded by mutex_
  std::vector<UrlRequest> requests_;                                        // guarded by mutex_
  std::jthread thread_;  // last member: it must be joined before the members that it uses are destroyed
};

}  // namespace gs::app
