#pragma once

#include <atomic>
#include <cstddef>
#include <functional>

namespace gs::qnv {

/// How far a long piece of work is, and whether it should stop. One for each piece of work; any thread may
/// set `cancelled`.
struct Progress {
  std::atomic<bool> cancelled{false};
  std::atomic<std::uint64_t> done{0}, total{0};  // in the unit of the work's current stage
  std::atomic<const char*> stage{""};            // "reading", "encoding", ...; a literal
};

/// Calls work(i) for every i < count, in no order, on `threads` threads (0: one a core). Returns when all
/// are done, or soon after `progress->cancelled`: then some were not called and the result is false.
/// An exception of `work` is thrown again here.
bool parallel_for(std::size_t count, const std::function<void(std::size_t)>& work, unsigned threads = 0,
                  Progress* progress = nullptr);

}  // namespace gs::qnv
