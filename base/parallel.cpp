#include "base/parallel.h"

#include "base/noncopyable.h"

#include <sched.h>

#include <algorithm>
#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <thread>

namespace gs {
namespace {

/// Returns the number of cores that the process may use.
unsigned usable_cores() {
  static const unsigned cores = [] {
    const unsigned all = std::max(1u, std::thread::hardware_concurrency());
    cpu_set_t set;
    CPU_ZERO(&set);
    if (::sched_getaffinity(0, sizeof set, &set) != 0) return all;
    return std::clamp(static_cast<unsigned>(CPU_COUNT(&set)), 1u, all);
  }();
  return cores;
}

/// Loop that helpers may join.
struct Loop {
  explicit Loop(const std::function<void()>& body) : run(body) {}
  const std::function<void()>& run;  // runs until no call is left
  unsigned wanted = 0;               // helpers that may still join
  unsigned joined = 0;               // helpers that run the loop
  std::condition_variable left;      // signals that the last helper has left
};

/// Pool of helper threads, because starting a thread takes longer than a small loop. Any thread.
class Helpers : NonCopyable {
 public:
  /// Returns the helpers of the program. They are never destroyed, because detached threads may still use them.
  static Helpers& of_program() {
    static Helpers& helpers = *new Helpers;
    return helpers;
  }

  /// Offers a loop to `count` helpers. Starts helpers only while there are fewer than `most`.
  void offer(Loop& loop, unsigned count, unsigned most) {
    const std::lock_guard lock(mutex_);
    loop.wanted = count;
    waiting_.push_back(&loop);
    wanted_ += count;
    for (; idle_ + starting_ < wanted_ && threads_ < most; ++threads_, ++starting_) {
      try {
        std::thread([this] { help(); }).detach();
      } catch (const std::exception&) {
        break;  // the system allows no more threads, or lacks memory for them; the loop must be withdrawn all the same
      }
    }
    if (count == 1)
      offered_.notify_one();
    else
      offered_.notify_all();
  }
  /// Withdraws the offer, and waits for the helpers that have joined.
  void withdraw(Loop& loop) {
    std::unique_lock lock(mutex_);
    wanted_ -= loop.wanted;
    loop.wanted = 0;
    std::erase(waiting_, &loop);
    loop.left.wait(lock, [&] { return loop.joined == 0; });
  }

 private:
  void help() {
    std::unique_lock lock(mutex_);
    --starting_;
    for (;;) {
      ++idle_;
      offered_.wait(lock, [&] { return !waiting_.empty(); });
      --idle_;
      Loop& loop = *waiting_.front();
      --wanted_;
      ++loop.joined;
      if (--loop.wanted == 0) waiting_.pop_front();
      lock.unlock();
      loop.run();
      lock.lock();
      if (--loop.joined == 0) loop.left.notify_one();
    }
  }

  std::mutex mutex_;
  std::condition_variable offered_;
  std::deque<Loop*> waiting_;  // loops with `wanted` above 0
  unsigned wanted_ = 0;        // sum over `waiting_`
  unsigned threads_ = 0, idle_ = 0, starting_ = 0;
};

}  // namespace

bool parallel_for(std::size_t count, const std::function<void(std::size_t)>& work, unsigned threads,
                  Progress* progress) {
  // Starts a stated number of threads even if other loops use all helpers.
  const bool is_stated = threads > 0;
  if (!is_stated) threads = usable_cores();
  const unsigned cores = threads;
  threads = static_cast<unsigned>(std::min<std::size_t>(threads, count));
  std::atomic<std::size_t> next{0};
  std::atomic<bool> stop{false};
  std::exception_ptr failure;
  std::mutex failure_mutex;
  const auto cancelled = [&] { return stop.load() || (progress && progress->cancelled.load()); };
  const std::function<void()> run = [&] {
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
  if (threads > 1) {
    constexpr unsigned kMostHelpers = 1024;
    Loop loop(run);
    Helpers& helpers = Helpers::of_program();
    helpers.offer(loop, threads - 1, is_stated ? kMostHelpers : cores - 1);
    run();
    helpers.withdraw(loop);
  } else {
    run();
  }
  if (failure) std::rethrow_exception(failure);
  return !cancelled();
}

}  // namespace gs
