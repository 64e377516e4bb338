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

/// Watchdog for Scripts that block the program. It acts if a call of a Script exceeds its time limit by 2 s and
/// `is_asked_to_close` returns true. Then it ends the process with a line on standard error. It calls
/// `is_asked_to_close` on another thread. The session file remains, so that the next start can restore the session.
/// Only one object may exist at a time.
class EndOverdueScripts : NonCopyable {
 public:
  explicit EndOverdueScripts(std::function<bool()> is_asked_to_close);
  ~EndOverdueScripts();
};

}  // namespace gs::app
