#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "net/load/load_types.h"

namespace gs::net {

/// Loads bytes by URL on other threads. All calls from one thread; only poll() returns results.
///
/// Two own threads: one for networks, one for disks. Received bytes are bounded: transfers wait while nobody polls.
/// Destruction stops everything at once and waits only for a pending disk read.
class Loader {
 public:
  [[nodiscard]] static std::unique_ptr<Loader> create(LoaderOptions options = {});
  ~Loader();
  Loader(const Loader&) = delete;
  Loader& operator=(const Loader&) = delete;

  /// Starts a request. Never blocks or fails; errors are events.
  RequestId request(Request request);
  /// Stops the events of this request. Received bytes stay in the cache. Ignores ids that have ended.
  void cancel(RequestId id);
  /// Changes the priority, also while the request runs: less urgent transfers pause for more urgent ones.
  void set_priority(RequestId id, int priority);
  /// Replaces LoaderOptions::bytes_per_second from now on; 0 means unlimited.
  void set_rate(std::uint64_t bytes_per_second);

  /// Returns the events since the last call: by priority, in order within a request, with at most `max_bytes` bytes of
  /// data. Remaining events do not call `wake` again; poll again while queued_bytes() is not 0.
  [[nodiscard]] std::vector<LoadEvent> poll(std::size_t max_bytes = std::size_t{4} << 20);

  /// Returns the bytes that wait for poll().
  [[nodiscard]] std::size_t queued_bytes() const;

 private:
  struct Parts;
  explicit Loader(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

}  // namespace gs::net
