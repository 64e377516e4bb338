#include "app/loading/fetch/loading.h"

#include <algorithm>

namespace gs::app {

void Waker::wake() {
  {
    const std::lock_guard lock(mutex_);
    awake_ = true;
  }
  something_.notify_one();
}

void Waker::wait(std::chrono::milliseconds time) {
  std::unique_lock lock(mutex_);
  something_.wait_for(lock, time, [this] { return awake_; });
  awake_ = false;
}

LoadLimit limit_of(const LoadOptions& options) {
  using Clock = std::chrono::steady_clock;
  const auto time = std::chrono::duration<double>(std::clamp(options.timeout_seconds, 0.0, 1e6));
  return LoadLimit(Clock::now() + std::chrono::duration_cast<Clock::duration>(time), options.cancelled);
}

Loading::Loading(const std::string& path, const LoadOptions& given)
    : options(given),
      ledger(given.ledger ? given.ledger : std::make_shared<LoadLedger>()),
      limit(limit_of(given)),
      budget(std::make_shared<Budget>(given.limits)),
      results(path, given.allow_network, budget),
      fetcher(*this) {
  budget->stop_when([time = limit] { return time.over(); });
  ledger->set_wake([waker = waker] { waker->wake(); });
}

Loading::~Loading() { ledger->set_wake({}); }

}  // namespace gs::app
