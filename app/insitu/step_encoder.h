#pragma once

#include "app/insitu/publisher.h"
#include "app/insitu/session_costs.h"
#include "app/insitu/step_streams.h"
#include "base/noncopyable.h"

#include <chrono>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace gs::app::insitu {

/// Cost of a step for StepPace.
struct StepCost {
  double seconds = 0;
  std::uint64_t grid_bytes = 0;
};

/// Encoder of the steps on rank 0. It encodes and publishes a step on the calling thread, or on its own thread. Call it
/// from one thread.
class StepEncoder : NonCopyable {
 public:
  using Clock = std::chrono::steady_clock;

  /// `costs` and the publisher must live until the last wait(), or longer than this object.
  StepEncoder(StreamLimits limits, SessionCosts& costs) : limits_(std::move(limits)), costs_(costs) {}
  ~StepEncoder() { wait(); }
  void set_publisher(Publisher* publisher) { publisher_ = publisher; }

  /// Encodes and publishes a step, which ended at `ended`. Returns the seconds in which the output blocked without
  /// using the processor.
  double encode(const StepData& data, Clock::time_point ended);
  /// Waits for the previous step, then calls encode() on a thread. `cost` is the cost of the step so far. If the system
  /// has no thread, encodes now and returns the result. Throws if memory does not suffice; the encoder is then idle.
  double start(StepData data, Clock::time_point ended, const StepCost& cost);
  /// Waits until the thread has ended.
  void wait();

  /// Reports whether the thread encodes a step.
  [[nodiscard]] bool is_busy() const;
  /// Returns the cost of the step that the thread encoded, once for each step.
  [[nodiscard]] std::optional<StepCost> take_cost();
  /// Returns the messages about steps that could not be encoded or published.
  [[nodiscard]] std::vector<std::string> take_messages();

 private:
  const StreamLimits limits_;
  SessionCosts& costs_;
  Publisher* publisher_ = nullptr;

  mutable std::mutex mutex_;  // guards the members up to `thread_`
  std::vector<std::string> messages_;
  std::optional<StepCost> cost_;
  bool busy_ = false;
  std::thread thread_;
};

}  // namespace gs::app::insitu
