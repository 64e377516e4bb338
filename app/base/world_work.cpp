#include "app/base/world_work.h"

#include <algorithm>
#include <utility>

namespace gs::app {
namespace {

using WorkClock = std::chrono::steady_clock;
constexpr std::chrono::milliseconds kLongWork{500}, kLongWait{100}, kBetweenRequests{20};

/// State of the session's thread.
struct Work {
  std::function<bool()> is_asked_to_stop;
  std::function<void()> during_waits;
  int depth = 0;  // number of WorldWork objects
  WorkClock::time_point began, asked;
  bool stopped = false;
};

Work& work() {
  static thread_local Work of_thread;
  return of_thread;
}

// Reports whether `after` has passed since `began`, and it is time to ask again.
bool is_due(Work& state, WorkClock::time_point began, std::chrono::milliseconds after) {
  const WorkClock::time_point now = WorkClock::now();
  if (now - began < after || now - state.asked < kBetweenRequests) return false;
  state.asked = now;
  return true;
}

}  // namespace

void set_stop_request(std::function<bool()> is_asked_to_stop, std::function<void()> during_waits) {
  work().is_asked_to_stop = std::move(is_asked_to_stop);
  work().during_waits = std::move(during_waits);
}

WorldWork::WorldWork() : counts_(static_cast<bool>(work().is_asked_to_stop)) {
  Work& state = work();
  if (!counts_ || state.depth++ > 0) return;
  state.began = WorkClock::now();
  state.stopped = false;
}

// After a stop, the work for the next world gets its full time.
WorldWork::~WorldWork() {
  if (!counts_) return;
  Work& state = work();
  --state.depth;
  if (std::exchange(state.stopped, false)) state.began = WorkClock::now();
}

bool WorldWork::was_stopped() const { return counts_ && work().stopped; }

bool is_work_unwanted() {
  Work& state = work();
  if (state.depth == 0 || !state.is_asked_to_stop) return false;
  state.stopped = state.stopped || (is_due(state, state.began, kLongWork) && state.is_asked_to_stop());
  return state.stopped;
}

bool is_wait_unwanted(WorkClock::time_point began) {
  Work& state = work();
  if (!state.is_asked_to_stop) return false;
  if (!is_due(state, state.depth > 0 ? std::min(began, state.began) : began, kLongWait)) return false;
  if (state.during_waits) state.during_waits();
  return state.is_asked_to_stop();
}

}  // namespace gs::app
