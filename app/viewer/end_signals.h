#pragma once

#include <semaphore.h>

#include <csignal>
#include <functional>
#include <thread>

namespace gs::app {

/// Semaphore that wakes a waiting thread; may be rung from other threads and signal handlers.
class Doorbell {
 public:
  Doorbell() { (void)sem_init(&semaphore_, 0, 0); }
  ~Doorbell() { (void)sem_destroy(&semaphore_); }
  Doorbell(const Doorbell&) = delete;
  Doorbell& operator=(const Doorbell&) = delete;

  void ring() { (void)sem_post(&semaphore_); }
  void wait(double seconds);
  void wait();

 private:
  sem_t semaphore_{};
};

/// Handler of SIGINT and SIGTERM while the object exists: the first signal rings `bell`, the second ends the program.
/// Only one object at a time.
class EndOnSignals {
 public:
  explicit EndOnSignals(Doorbell& bell);
  ~EndOnSignals();
  EndOnSignals(const EndOnSignals&) = delete;
  EndOnSignals& operator=(const EndOnSignals&) = delete;

  /// Returns true if a signal was received.
  [[nodiscard]] static bool told();

 private:
  struct sigaction before_[2]{};
};

/// Like EndOnSignals, for threads that cannot wait for a Doorbell. `wake` is called from another thread after a signal.
class EndWatch {
 public:
  explicit EndWatch(std::function<void()> wake);
  ~EndWatch();
  EndWatch(const EndWatch&) = delete;
  EndWatch& operator=(const EndWatch&) = delete;

 private:
  Doorbell bell_;
  EndOnSignals signals_{bell_};
  std::thread thread_;
};

/// Watchdog that ends the process, with a line on standard error, if a call of a Script exceeds its time limit by 2 s
/// and `is_asked_to_close` returns true. Another thread calls that function. The session's file remains, so that the
/// next start can restore the session. Only one object at a time.
class EndOverdueScripts {
 public:
  explicit EndOverdueScripts(std::function<bool()> is_asked_to_close);
  ~EndOverdueScripts();
  EndOverdueScripts(const EndOverdueScripts&) = delete;
  EndOverdueScripts& operator=(const EndOverdueScripts&) = delete;
};

}  // namespace gs::app
