#include "app/desktop/end_signals.h"

#include "app/base/console.h"
#include "app/base/exit_status.h"
#include "app/base/world_work.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <string>
#include <utility>

namespace gs::app {
namespace {

volatile std::sig_atomic_t told_to_end = 0;
std::atomic<Doorbell*> signal_bell = nullptr;
static_assert(std::atomic<Doorbell*>::is_always_lock_free);

extern "C" void end_on_signal(int) {
  told_to_end = 1;
  if (Doorbell* const bell = signal_bell.load()) bell->ring();
}

}  // namespace

void Doorbell::wait(double seconds) {
  timespec until{};
  (void)clock_gettime(CLOCK_MONOTONIC, &until);
  const double end = static_cast<double>(until.tv_nsec) * 1e-9 + std::max(0.0, seconds);
  until.tv_sec += static_cast<time_t>(end);
  until.tv_nsec = static_cast<long>((end - std::floor(end)) * 1e9);
  (void)sem_clockwait(&semaphore_, CLOCK_MONOTONIC, &until);
  while (sem_trywait(&semaphore_) == 0) {
  }
}

void Doorbell::wait() {
  while (sem_wait(&semaphore_) != 0) {  // repeat if a signal interrupted the wait
  }
}

EndOnSignals::EndOnSignals(Doorbell& bell) {
  told_to_end = 0;
  signal_bell = &bell;
  struct sigaction action {};
  action.sa_handler = end_on_signal;
  action.sa_flags = static_cast<int>(SA_RESETHAND);  // a second signal has its default effect: it ends the program
  (void)sigaction(SIGINT, &action, &before_[0]);
  (void)sigaction(SIGTERM, &action, &before_[1]);
}

EndOnSignals::~EndOnSignals() {
  (void)sigaction(SIGINT, &before_[0], nullptr);
  (void)sigaction(SIGTERM, &before_[1], nullptr);
  signal_bell = nullptr;
}

bool EndOnSignals::told() { return told_to_end != 0; }

EndWatch::EndWatch(std::function<void()> wake)
    : thread_([this, wake = std::move(wake)] {
        bell_.wait();
        if (EndOnSignals::told()) wake();
      }) {}

EndWatch::~EndWatch() {
  bell_.ring();
  thread_.join();
}

WorldStop::WorldStop(std::function<bool()> is_asked_to_stop, std::function<void()> during_waits) {
  set_stop_request(std::move(is_asked_to_stop), std::move(during_waits));
}

WorldStop::~WorldStop() { set_stop_request({}); }

}  // namespace gs::app
