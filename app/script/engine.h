#pragma once

#include "app/script/bounds/block_limit.h"

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

/// Why a program was stopped that nothing of its own can catch.
enum class Stop : std::uint8_t { none, time, memory };

class JobQueue;

/// SpiderMonkey on one thread, for all worlds of that thread; and the clock that ends programs which take too long.
class Engine {
 public:
  /// Returns the engine of the calling thread, made by the first call. Returns null if there is no memory for it.
  static Engine* of_this_thread();
  ~Engine();
  Engine(const Engine&) = delete;
  Engine& operator=(const Engine&) = delete;

  [[nodiscard]] JSContext* context() const { return context_; }

  /// Max size of one memory block of a program: a string of 2^24 characters, with room to grow.
  static constexpr std::size_t kMaxBlock = std::size_t{20} << 20;

  /// Time that a program has the engine for. Inside another turn, the outer one's limits hold. `late_message` outlives
  /// the turn; see on_overdue.
  class Turn {
   public:
    Turn(Engine& engine, double seconds, std::size_t heap_bytes, const std::string& late_message);
    ~Turn();
    Turn(const Turn&) = delete;
    Turn& operator=(const Turn&) = delete;
    /// Returns the reason that ended it, if any.
    [[nodiscard]] Stop stop() const { return engine_.stop_; }
    /// Runs one promise job that this turn enqueued. Returns false if there is none. `*good`: see JobQueue::run_one.
    bool run_job(bool* good);

   private:
    Engine& engine_;
    bool outermost_;
    std::size_t first_job_;
    BlockLimit blocks_{kMaxBlock};
  };

  /// Bytes of values that the engine does not count itself.
  void add_bytes(std::ptrdiff_t bytes) { own_bytes_ += bytes; }
  /// Whether programs may have so many more bytes.
  [[nodiscard]] bool may_have(std::size_t bytes) const;
  /// Collects garbage when so many nodes have been made since the last time.
  void note_nodes(std::size_t count);
  /// Between programs: what has been put off.
  void rest();

  /// Sets the function that gets `late_message` of a turn that exceeds its time by over 2 s. It is called about a
  /// hundred times a second, on another thread, until the turn ends.
  static void on_overdue(std::function<void(const std::string&)> observer);

 private:
  explicit Engine(JSContext* context);
  static bool on_interrupt(JSContext* context);
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
  std::atomic<const std::string*> late_message_ = nullptr;
  std::size_t heap_limit_ = 0;
  std::ptrdiff_t own_bytes_ = 0, next_own_collection_ = 0;
  std::size_t nodes_made_ = 0, next_collection_ = 2000;
  std::uint32_t measured_at_ = 0;  // number of the collection
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
