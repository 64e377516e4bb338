#pragma once

#include "app/session/documents.h"
#include "app/world/world_loader.h"
#include "app/world/world_loading.h"

#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

namespace gs::app {

/// Reads one world on a thread of its own, and tells meanwhile what there is to see. What it tells is moved or never
/// changes, but for streams, which are the taker's from then on and are fed through `OpenedWorld::feeds`.
/// The owner calls everything below.
class WorldReader {
 public:
  /// What has happened since the last time.
  struct News {
    std::shared_ptr<Document> document;  // as far as it has come, or the whole; null: no more than before
    bool over = false;  // it is the whole, or all there will be; without a scene: it could not be opened
    bool fed = false;   // bytes of its streams have come
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
  /// The thread has ended, so that the destructor does not wait.
  [[nodiscard]] bool ended() const { return ended_; }
  [[nodiscard]] News take();

 private:
  void run(const std::string& path, LoadOptions options);
  void tell(News news);

  std::function<void()> wake_;
  std::atomic<bool> cancelled_ = false, stop_ = false, ended_ = false;
  std::mutex mutex_;
  News news_;                        // guarded by mutex_
  WorldLoading* loading_ = nullptr;  // guarded by mutex_: for waking it
  std::jthread thread_;              // last: joined before what it uses goes
};

}  // namespace gs::app
