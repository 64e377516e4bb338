#include "bench/transfer/jobs.h"

#include <algorithm>
#include <condition_variable>
#include <cstdio>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

namespace gs::bench {
namespace {

// Returns the cost of a transfer. The machine has `parallel` units, which concurrent transfers share. With high loss
// TCP is slow on any line, so it costs one unit.
unsigned cost_of(const TransferSpec& spec, unsigned parallel) {
  constexpr double kFast = 5e7, kMedium = 5e6, kMuchLoss = 0.1;
  if (spec.link.bits_per_second < kMedium || (!spec.cells && spec.link.loss >= kMuchLoss)) return 1;
  return spec.link.bits_per_second < kFast ? std::min(2U, parallel) : parallel;
}

class Schedule {
 public:
  Schedule(const std::vector<TransferSpec>& specs, unsigned parallel) : room_(parallel), waiting_(specs.size()) {
    for (const TransferSpec& spec : specs) costs_.push_back(cost_of(spec, parallel));
    for (std::size_t i = 0; i < waiting_.size(); ++i) waiting_[i] = i;
    // Transfers that need the whole machine start first. Otherwise they would wait for all others.
    std::stable_sort(waiting_.begin(), waiting_.end(), [&](auto a, auto b) { return costs_[a] > costs_[b]; });
  }
  /// Waits until the next transfer fits, and returns it. Returns nullopt if none is left.
  [[nodiscard]] std::optional<std::size_t> take() {
    std::unique_lock lock(mutex_);
    for (;;) {
      if (waiting_.empty()) return std::nullopt;
      const auto found =
          std::find_if(waiting_.begin(), waiting_.end(), [&](std::size_t job) { return costs_[job] <= room_; });
      if (found != waiting_.end()) {
        const std::size_t job = *found;
        waiting_.erase(found);
        room_ -= costs_[job];
        return job;
      }
      changed_.wait(lock);
    }
  }
  /// Ends a transfer. Returns the number of ended transfers.
  [[nodiscard]] std::size_t done(std::size_t job) {
    const std::lock_guard lock(mutex_);
    room_ += costs_[job];
    changed_.notify_all();
    return ++done_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<unsigned> costs_;
  unsigned room_;
  std::vector<std::size_t> waiting_;
  std::size_t done_ = 0;
};

void say(const TransferSpec& spec, const Recording& recording, std::size_t done, std::size_t all) {
  const std::string& trouble = recording.problem.empty() ? recording.failure : recording.problem;
  std::fprintf(stderr, "%zu/%zu: %s by %s, %g Mbit/s, %g ms, %g %%: %s at %.2f s%s%s\n", done, all, spec.file.c_str(),
               spec.cells ? "cells" : "HTTP", spec.link.bits_per_second / 1e6, spec.link.round_trip * 1e3,
               spec.link.loss * 100, recording.complete ? "done" : "not done", recording.last(),
               trouble.empty() ? "" : "; ", trouble.c_str());
}

}  // namespace

std::vector<Recording> transfer_all(const std::vector<TransferSpec>& specs, const ServerSpec& server,
                                    unsigned parallel) {
  std::vector<Recording> recordings(specs.size());
  Schedule schedule(specs, std::max(1U, parallel));
  std::vector<std::jthread> workers;
  for (unsigned i = 0; i < parallel; ++i)
    workers.emplace_back([&] {
      while (const auto job = schedule.take()) {
        ServerSpec own = server;
        own.scratch += "/" + std::to_string(*job);
        recordings[*job] = transfer(specs[*job], own);
        std::error_code error;
        std::filesystem::remove_all(own.scratch, error);
        say(specs[*job], recordings[*job], schedule.done(*job), specs.size());
      }
    });
  workers.clear();  // joins
  return recordings;
}

}  // namespace gs::bench
