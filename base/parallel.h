#pragma once

#include <atomic>
#include <cstddef>
#include <functional>

namespace gs {

/// Progress of one long task, and its cancellation flag. Any thread may set `cancelled`.
struct Progress {
  std::atomic<bool> cancelled{false};
  std::atomic<std::uint64_t> done{0}, total{0};  // in the unit of the current stage
  std::atomic<const char*> stage{""};            // "reading", "encoding", ...; must be a string literal
};

[[nodiscard]] inline bool is_cancelled(const Progress* progress) { return progress && progress->cancelled.load(); }

/// Calls work(i) for every i < count, in undefined order, on `threads` threads (0 means one per core). Returns when all
/// calls are done. If `progress->cancelled` is set, soon returns false; some calls may then not have been made.
/// Rethrows an exception of `work`.
bool parallel_for(std::size_t count, const std::function<void(std::size_t)>& work, unsigned threads = 0,
                  Progress* progress = nullptr);

}  // namespace gs
