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

/// Guard that lets the user stop Scripts while the session's thread waits for them. Calls `is_asked_to_stop` on that
/// thread, about 50 times a second. If it returns true, the programs of that world end at once, and the session
/// continues. Only one object may exist at a time.
class ScriptStop : NonCopyable {
 public:
  explicit ScriptStop(std::function<bool()> is_asked_to_stop);
  ~ScriptStop();
};

}  // namespace gs::app
