#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/noncopyable.h"
#include "net/transfer/load_types.h"

namespace gs::net {

/// Interface for requests by URL. Readers of streams use it, so that simulations can run them without threads.
class LoadRequests : NonCopyable {
 public:
  /// Starts a request. Never blocks. Errors are events of the request.
  virtual RequestId request(Request request) = 0;
  /// Stops the events of a request. Received bytes remain in the cache. Ignores requests that have ended.
  virtual void cancel(RequestId id) = 0;

 protected:
  ~LoadRequests() = default;
};

/// Loads bytes by URL on two own threads, one for networks and one for disks. Call all functions on one thread; only
/// poll() returns results.
///
/// Received bytes are bounded: if poll() is not called, transfers wait. The destructor stops all transfers at once and
/// waits only for a pending disk read.
class Loader final : public LoadRequests {
 public:
  [[nodiscard]] static std::unique_ptr<Loader> create(LoaderOptions options = {});
  ~Loader();

  RequestId request(Request request) override;
  void cancel(RequestId id) override;
  /// Changes the priority of a request. Running transfers with lower priority may pause for others.
  void set_priority(RequestId id, int priority);
  /// Replaces LoaderOptions::bytes_per_second from now on; 0 means unlimited.
  void set_rate(std::uint64_t bytes_per_second);

  /// Returns the events after the previous call, by priority, and in order within a request. Returns at most
  /// `max_bytes` bytes of data. If events remain, `wake` is not called for them: poll again while queued_bytes() is not
  /// 0.
  [[nodiscard]] std::vector<LoadEvent> poll(std::size_t max_bytes = std::size_t{4} << 20);

  /// Returns the received bytes that poll() has not returned yet.
  [[nodiscard]] std::size_t queued_bytes() const;

 private:
  struct Parts;
  explicit Loader(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

}  // namespace gs::net
