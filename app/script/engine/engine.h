#pragma once

#include "app/script/bounds/block_limit.h"
#include "base/noncopyable.h"

#include <jsapi.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

namespace gs::app::script {

/// Reason why the engine stopped a program. The program cannot catch this.
enum class Stop : std::uint8_t { none, time, memory };

class JobQueue;

/// SpiderMonkey on one thread, for all worlds of that thread. Also contains the watcher, which ends programs that take
/// too long.
class Engine : NonCopyable {
 public:
  /// Returns the engine of the calling thread. The first call creates it. Returns null if memory is insufficient.
  static Engine* of_this_thread();
  ~Engine();

  [[nodiscard]] JSContext* context() const { return context_; }

  /// Max bytes of one memory block of a program. Suffices for a string of 2^24 characters that grows.
  static constexpr std::size_t kMaxBlock = std::size_t{20} << 20;

  /// Scope in which a program may use the engine, for at most `seconds` and `heap_bytes`. A turn that had to wait for
  /// a processor may take up to 1 s longer. Within another turn, the limits of the outer turn apply. `late_message`
  /// must outlive the turn; see on_overdue().
  class Turn : NonCopyable {
   public:
    Turn(Engine& engine, double seconds, std::size_t heap_bytes, const std::string& late_message);
    ~Turn();
    /// Returns the reason why the engine stopped the program; Stop::none if it did not.
    [[nodiscard]] Stop stop() const { return engine_.stop_; }
    /// Runs one promise job that was enqueued in this turn. Returns false if there is none. For `*good`, see
    /// JobQueue::run_one().
    bool run_job(bool* good);

   private:
    Engine& engine_;
    bool outermost_;
    std::size_t first_job_;
    BlockLimit blocks_{kMaxBlock};
  };

  /// Adds to the bytes of values that SpiderMonkey does not count; `bytes` may be negative.
  void add_bytes(std::ptrdiff_t bytes) { own_bytes_ += bytes; }
  /// Reports whether these further bytes would stay within the heap limit of programs.
  [[nodiscard]] bool may_have(std::size_t bytes) const;
  /// Counts new nodes. After enough of them, rest() collects garbage.
  void note_nodes(std::size_t count);
  /// Collects garbage if enough nodes were made since the last collection. Call between programs.
  void rest();

  /// Sets the function that receives `late_message` when a turn exceeds its time by over 2 s. Another thread calls it
  /// about a hundred times a second until the turn ends.
  static void on_overdue(std::function<void(const std::string&)> observer);

 private:
  explicit Engine(JSContext* context);
  static bool on_interrupt(JSContext* context);
  [[nodiscard]] bool over_time() const;
  [[nodiscard]] bool over_memory();
  void watch();
  void collect_leftovers();
  void tell_overdue() const;

  using Clock = std::chrono::steady_clock;
  JSContext* context_;
  std::unique_ptr<JobQueue> jobs_;
  int depth_ = 0;
  Stop stop_ = Stop::none;
  std::atomic<Clock::time_point> deadline_;
  double processor_deadline_ = 0;  // seconds of thread_seconds()
  std::atomic<const std::string*> late_message_ = nullptr;
  std::size_t heap_limit_ = 0;
  std::ptrdiff_t own_bytes_ = 0, next_own_collection_ = 0;
  std::size_t nodes_made_ = 0, next_collection_ = 2000;
  std::uint32_t measured_at_ = 0;  // number of collections at the last measurement
  std::size_t measured_ = 0;
  std::atomic<bool> busy_ = false;
  std::atomic<std::uint32_t> turns_ = 0;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool watching_ = false, ends_ = false;  // guarded by mutex_
  std::atomic<bool> asleep_ = true;
  std::thread watcher_;
};

}  // namespace gs::app::script
