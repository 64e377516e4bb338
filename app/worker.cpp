#include "app/worker.h"

#include <cassert>
#include <utility>

namespace gs::app {

void Worker::start(Job job, Delivery failed) {
  assert(!busy_);
  busy_ = true;
  thread_ = std::jthread([this, job = std::move(job), failed = std::move(failed)]() mutable {
    Delivery delivery;
    try {
      delivery = job();
    } catch (...) {
      delivery = std::move(failed);
    }
    job = nullptr;
    {
      const std::lock_guard lock(mutex_);
      delivery_ = std::move(delivery);
    }
    if (wake_) wake_();
  });
}

bool Worker::poll() {
  std::optional<Delivery> delivery;
  {
    const std::lock_guard lock(mutex_);
    delivery.swap(delivery_);
  }
  if (!delivery) return false;
  thread_.join();
  busy_ = false;
  if (*delivery) (*delivery)();
  return true;
}

}  // namespace gs::app
