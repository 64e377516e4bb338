#pragma once

#include <functional>
#include <mutex>
#include <optional>
#include <thread>

namespace gs::app {

/// Runs one job at a time on a thread of its own, so that the window stays alive meanwhile.
///
/// A job returns a delivery: what remains to be done on the owner's thread, holding all that the job
/// made. So results are moved between threads and never shared. The owner calls everything below.
class Worker {
 public:
  using Delivery = std::function<void()>;
  using Job = std::function<Delivery()>;

  /// `wake` is called on the worker's thread after each job; it must be safe there.
  explicit Worker(std::function<void()> wake = {}) : wake_(std::move(wake)) {}
  /// Waits for the job that runs, and drops its delivery.
  ~Worker() = default;
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  /// True from `start` until its delivery was made.
  [[nodiscard]] bool busy() const { return busy_; }
  /// Starts `job`. Must not be busy. `failed` is delivered in its place when it throws.
  void start(Job job, Delivery failed);
  /// Makes the delivery of a job that has ended, and then returns true. The worker is free again
  /// before the delivery runs, so that it may start the next job.
  bool poll();

 private:
  std::function<void()> wake_;
  bool busy_ = false;
  std::mutex mutex_;
  std::optional<Delivery> delivery_;  // guarded by mutex_
  std::jthread thread_;               // last: joined before what it uses goes
};

}  // namespace gs::app
