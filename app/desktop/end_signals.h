#pragma once

#include "base/noncopyable.h"

#include <semaphore.h>

#include <csignal>
#include <functional>
#include <thread>

namespace gs::app {

/// Semaphore that wakes a waiting thread. Other threads and signal handlers may call ring().
class Doorbell : NonCopyable {
 public:
  Doorbell() { (void)sem_init(&semaphore_, 0, 0); }
  ~Doorbell() { (void)sem_destroy(&semaphore_); }

  void ring() { (void)sem_post(&semaphore_); }
  void wait(double seconds);
  void wait();

 private:
  sem_t semaphore_{};
};

/// Handler of SIGINT and SIGTERM, as long as the object exists. The first signal rings `bell`; the second one ends the
/// program. Only one object may exist at a time.
class EndOnSignals : NonCopyable {
 public:
  explicit EndOnSignals(Doorbell& bell);
  ~EndOnSignals();

  /// Returns true if a signal was received.
  [[nodiscard]] static bool told();

 private:
  struct sigaction before_[2]{};
};

/// Handler like EndOnSignals, for a main thread that cannot wait for a Doorbell. Calls `wake` on another thread after a
/// signal.
class EndWatch : NonCopyable {
 public:
  explicit EndWatch(std::function<void()> wake);
  ~EndWatch();

 private:
  Doorbell bell_;
  EndOnSignals signals_{bell_};
  std::thread thread_;
};

/// Guard that lets the user stop the work for a world on the calling thread, see app/base/world_work.h: after 0.1 s of
/// waiting for Scripts or 0.5 s of other work, `is_asked_to_stop` is called about 50 times a second. If it returns
/// true, the Scripts or the events of that world end at once, and the session continues. `during_waits` is called as
/// often while Scripts are awaited. Only one object may exist at a time.
class WorldStop : NonCopyable {
 public:
  explicit WorldStop(std::function<bool()> is_asked_to_stop, std::function<void()> during_waits = {});
  ~WorldStop();
};

}  // namespace gs::app
