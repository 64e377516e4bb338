#pragma once

#include <semaphore.h>

#include <csignal>
#include <functional>
#include <thread>

namespace gs::app {

/// Wakes who waits; from other threads, and from signals.
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

/// While it is there, SIGINT and SIGTERM ring, and end the program only when they come again. One at a time.
class EndOnSignals {
 public:
  explicit EndOnSignals(Doorbell& bell);
  ~EndOnSignals();
  EndOnSignals(const EndOnSignals&) = delete;
  EndOnSignals& operator=(const EndOnSignals&) = delete;

  /// One has come.
  [[nodiscard]] static bool told();

 private:
  struct sigaction before_[2]{};
};

/// The same for who cannot wait for a Doorbell: `wake` is called from another thread when one has come.
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

/// Ends the process, with a line on standard error, when a Script is overdue by 2 s inside one call of the engine and
/// `is_asked_to_close` returns true. Another thread calls that. The session's file stays, so that the next start offers
/// the session. One at a time.
class EndOverdueScripts {
 public:
  explicit EndOverdueScripts(std::function<bool()> is_asked_to_close);
  ~EndOverdueScripts();
  EndOverdueScripts(const EndOverdueScripts&) = delete;
  EndOverdueScripts& operator=(const EndOverdueScripts&) = delete;
};

}  // namespace gs::app
