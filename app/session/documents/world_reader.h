#pragma once

#include "app/session/documents/documents.h"
#include "app/streams/load_ledger.h"
#include "app/world/world_loader.h"
#include "app/world/world_loading.h"

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

/// Reads one world on a thread of its own, and tells meanwhile what there is to see. As soon as its file is read the
/// world is the owner's, and lives; Inlines, EXTERNPROTOs, pictures and vectors go on arriving. What it tells is moved
/// or never changes, but for streams, which are the owner's from then on and are fed through `OpenedWorld::feeds`. The
/// owner calls everything below.
class WorldReader {
 public:
  /// What has happened since the last time.
  struct News {
    /// A preview as far as it has come, or the world that lives from then on; one without a scene could not be opened.
    /// Null: no other than before.
    std::shared_ptr<Document> document;
    Arrivals arrivals;          // for the living world
    bool over = false;          // no more will come but bytes of streams, and what `request` asks for
    bool streams_grew = false;  // such bytes have come
    LoadingState state;
  };

  /// `wake` is called on the reader's thread when there is news; it must be safe there.
  WorldReader(std::string path, LoadOptions options, std::function<void()> wake);
  /// Waits for the thread, which ends as soon as it can.
  ~WorldReader();
  WorldReader(const WorldReader&) = delete;
  WorldReader& operator=(const WorldReader&) = delete;

  /// What has come is all there will be, as if the time for loading were over.
  void cancel();
  /// How large what still comes over the network is seen.
  void prioritize(std::unordered_map<const vrml::Node*, float> importance);
  /// Urls have been set in the living world; what they name is among the arrivals of later news.
  void request(std::vector<UrlRequest> requests);
  /// Nobody waits for it any more: the thread ends as soon as it can.
  void retire();
  /// The nodes for which it comes.
  [[nodiscard]] std::unordered_set<const vrml::Node*> wanted();
  /// The thread has ended, so that the destructor does not wait.
  [[nodiscard]] bool ended() const { return stage_ == Stage::ended; }
  [[nodiscard]] News take();
  /// Its files and streams. Never null.
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
  WorldLoading* loading_ = nullptr;                                         // guarded by mutex_: for waking it
  std::optional<std::unordered_map<const vrml::Node*, float>> importance_;  // guarded by mutex_: not told yet
  std::unordered_set<const vrml::Node*> wanted_;                            // guarded by mutex_
  std::vector<UrlRequest> requests_;                                        // guarded by mutex_
  std::jthread thread_;                                                     // last: joined before what it uses goes
};

}  // namespace gs::app
