#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "net/load/load_types.h"

namespace gs::net {

/// Events on their way from the loader's threads to the main thread, bounded in bytes. The bound is kept by who pushes:
/// data is taken even without room, so that nothing is lost. Safe for all threads.
class LoadQueue {
 public:
  LoadQueue(std::size_t max_bytes, std::size_t max_bytes_per_request, std::function<void()> wake)
      : max_bytes_(max_bytes), max_bytes_per_request_(max_bytes_per_request), wake_(std::move(wake)) {}

  // The main thread's side.
  void open(RequestId id, int priority);
  /// Nothing more of this request comes out.
  void close(RequestId id);
  void set_priority(RequestId id, int priority);
  /// Events by priority, those of one request in order; data of at most `max_bytes`, and whatever has no bytes.
  [[nodiscard]] std::vector<LoadEvent> poll(std::size_t max_bytes);
  [[nodiscard]] std::optional<LoadProgress> progress(RequestId id) const;
  [[nodiscard]] LoadProgress progress() const;
  [[nodiscard]] std::size_t queued_bytes() const { return queued_.load(std::memory_order_relaxed); }
  /// Whether someone found no room since the last call.
  [[nodiscard]] bool take_starved() { return starved_.exchange(false); }

  // The loader's side. Requests that are closed are passed over.
  void push_head(RequestId id, LoadHead head);
  void push_data(RequestId id, std::uint64_t offset, std::span<const std::byte> bytes);
  void push_end(RequestId id, std::variant<LoadDone, LoadError> how);
  /// Forgets what was not polled. Tells the owner, if he has seen anything.
  void restart(RequestId id);
  void set_wanted(RequestId id, std::optional<std::uint64_t> bytes);
  /// How many more bytes may be pushed for this request.
  [[nodiscard]] std::size_t room(RequestId id);

 private:
  struct Box {
    std::deque<LoadEvent> events;
    std::size_t front_taken = 0;  // bytes of the first event's data that are handed out already
    std::size_t bytes = 0;
    int priority = 0;
    std::uint64_t received = 0;
    std::optional<std::uint64_t> wanted;
    bool seen = false;      // the owner has got a head
    bool outdated = false;  // of a version that is void, and does not know it yet
    bool ended = false;     // the last event is in
  };

  void forget_bytes(Box& box);
  /// The data event at the front, as far as `budget` reaches; the rest stays.
  static LoadEvent take_data(Box& box, std::size_t budget);
  void take_from(Box& box, std::size_t& budget, std::vector<LoadEvent>& result);
  [[nodiscard]] Box* find(RequestId id);
  /// Calls wake_, unless it was called since the last poll and nobody looked.
  void notify(std::unique_lock<std::mutex>& lock);

  const std::size_t max_bytes_, max_bytes_per_request_;
  const std::function<void()> wake_;
  mutable std::mutex mutex_;
  std::map<RequestId, Box> boxes_;
  std::atomic<std::size_t> queued_{0};
  std::atomic<bool> starved_{false};
  bool woken_ = false;
};

}  // namespace gs::net
