#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <span>
#include <vector>

#include "net/transfer/load_types.h"

namespace gs::net {

/// Queue of events from the loader's threads to the thread that polls: the reader thread in `app/`. The loader must
/// check `room` before it pushes data: the queue takes all data, even above its limit in bytes. Any thread.
class LoadQueue {
 public:
  LoadQueue(std::size_t max_bytes, std::size_t max_bytes_per_request, std::function<void()> wake)
      : max_bytes_(max_bytes), max_bytes_per_request_(max_bytes_per_request), wake_(std::move(wake)) {}

  // Functions for the polling thread.
  void open(RequestId id, int priority);
  /// Drops all events of a request, also later ones.
  void close(RequestId id);
  void set_priority(RequestId id, int priority);
  /// Returns events by priority. Events of one request stay in order. Returns at most `max_bytes` bytes of data, and
  /// all events without data.
  [[nodiscard]] std::vector<LoadEvent> poll(std::size_t max_bytes);
  [[nodiscard]] std::size_t queued_bytes() const { return queued_.load(std::memory_order_relaxed); }
  /// Reports whether `room` was 0 for the loader after the previous call.
  [[nodiscard]] bool clear_starved() { return starved_.exchange(false); }

  // Functions for the loader. They ignore closed requests.
  void push_head(RequestId id, LoadHead head);
  void push_data(RequestId id, std::uint64_t offset, std::span<const std::byte> bytes);
  void push_end(RequestId id, std::variant<LoadDone, LoadError> how);
  /// Drops events that were not polled. Adds a restart event if the owner has polled a head.
  void restart(RequestId id);
  /// Returns the bytes that the loader may still push for a request.
  [[nodiscard]] std::size_t room(RequestId id);

 private:
  struct Box {
    std::deque<LoadEvent> events;
    std::size_t front_taken = 0;  // bytes of the first data event that poll() has returned
    std::size_t bytes = 0;
    int priority = 0;
    bool seen = false;  // poll() has returned a head
    bool outdated = false;  // the polled head is invalid, and no restart event was polled yet
    bool ended = false;  // the last event of the request is in the queue
  };

  void forget_bytes(Box& box);
  /// Removes up to `budget` bytes of the first event, a data event. Leaves the rest in the queue.
  static LoadEvent take_data(Box& box, std::size_t budget);
  void take_from(Box& box, std::size_t& budget, std::vector<LoadEvent>& result);
  [[nodiscard]] Box* find(RequestId id);
  /// Calls wake_ once until the next poll().
  void notify(std::unique_lock<std::mutex>& lock);

  const std::size_t max_bytes_, max_bytes_per_request_;
  const std::function<void()> wake_;
  std::mutex mutex_;
  std::map<RequestId, Box> boxes_;
  std::atomic<std::size_t> queued_{0};
  std::atomic<bool> starved_{false};
  bool woken_ = false;
};

}  // namespace gs::net
