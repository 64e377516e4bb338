#include "app/insitu/step_encoder.h"

#include "base/thread_time.h"

#include <algorithm>
#include <exception>
#include <iterator>
#include <memory>
#include <new>
#include <system_error>
#include <utility>

namespace gs::app::insitu {

double StepEncoder::encode(const StepData& data, Clock::time_point ended) {
  double waited = 0;
  std::vector<std::string> problems;
  EncodedFacts facts;
  try {
    std::vector<StepStream> streams = encode_step(data, limits_, problems);
    for (const StepStream& stream : streams) {
      facts.bytes += stream.bytes.size();
      facts.max_error = std::max(facts.max_error, stream.max_error);
      facts.thinning = std::max(facts.thinning, stream.thinning);
    }
    const Clock::time_point begun = Clock::now();
    const double processor = thread_seconds();
    if (auto problem = publisher_->publish(data.step, data.time, std::move(streams)))
      problems.push_back(std::move(*problem));
    const double passed = std::chrono::duration<double>(Clock::now() - begun).count();
    waited = std::max(passed - (thread_seconds() - processor), 0.0);
  } catch (const std::bad_alloc&) {
    problems.emplace_back("not enough memory to encode step " + std::to_string(data.step));
  } catch (const std::exception& problem) {
    problems.emplace_back("step " + std::to_string(data.step) + " cannot be encoded: " + problem.what());
  }
  facts.seconds = std::chrono::duration<double>(Clock::now() - ended).count();
  costs_.note_step(facts);
  const std::lock_guard lock(mutex_);
  std::ranges::move(problems, std::back_inserter(messages_));
  return waited;
}

double StepEncoder::start(StepData data, Clock::time_point ended, const StepCost& cost) {
  wait();
  const auto held = std::make_shared<const StepData>(std::move(data));
  const auto work = [this, held, ended, cost] {
    (void)encode(*held, ended);
    const double used = thread_seconds();
    costs_.add(used, used);
    const std::lock_guard lock(mutex_);
    cost_ = StepCost{cost.seconds + used, cost.grid_bytes};
    busy_ = false;
  };
  {
    const std::lock_guard lock(mutex_);
    busy_ = true;
  }
  try {
    thread_ = std::thread(work);
    return 0;
  } catch (const std::exception&) {  // the system has no more threads, or memory does not suffice
    const std::lock_guard lock(mutex_);
    busy_ = false;
  }
  return encode(*held, ended);
}

void StepEncoder::wait() {
  if (thread_.joinable()) thread_.join();
}

bool StepEncoder::is_busy() const {
  const std::lock_guard lock(mutex_);
  return busy_;
}

std::optional<StepCost> StepEncoder::take_cost() {
  const std::lock_guard lock(mutex_);
  return std::exchange(cost_, std::nullopt);
}

std::vector<std::string> StepEncoder::take_messages() {
  const std::lock_guard lock(mutex_);
  return std::exchange(messages_, {});
}

}  // namespace gs::app::insitu
