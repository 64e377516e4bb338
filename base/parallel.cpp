#include "base/parallel.h"

#include <algorithm>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

namespace gs {

bool parallel_for(std::size_t count, const std::function<void(std::size_t)>& work, unsigned threads,
                  Progress* progress) {
  if (threads == 0) threads = std::max(1u, std::thread::hardware_concurrency());
  threads = static_cast<unsigned>(std::min<std::size_t>(threads, count));
  std::atomic<std::size_t> next{0};
  std::atomic<bool> stop{false};
  std::exception_ptr failure;
  std::mutex failure_mutex;
  const auto cancelled = [&] { return stop.load() || (progress && progress->cancelled.load()); };
  const auto run = [&] {
    try {
      for (std::size_t i = 0; !cancelled() && (i = next.fetch_add(1)) < count;) {
        work(i);
        if (progress) progress->done.fetch_add(1);
      }
    } catch (...) {
      const std::lock_guard lock(failure_mutex);
      if (!failure) failure = std::current_exception();
      stop = true;
    }
  };
  {
    std::vector<std::jthread> helpers;
    try {
      for (unsigned i = 1; i < threads; ++i) helpers.emplace_back(run);
    } catch (const std::system_error&) {
      // The system allows no more threads. Continues with the threads that have started.
    }
    run();
  }
  if (failure) std::rethrow_exception(failure);
  return !cancelled();
}

}  // namespace gs
