#pragma once

#include "base/noncopyable.h"
#include "bench/transfer/link_direction.h"

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <variant>

namespace gs::bench {

/// Counts of a link since its creation.
struct LinkCounts {
  DirectionCounts to_client, to_server;
  double worst_delay = 0;         // largest delay of a packet beyond its due time, in seconds
  std::uint64_t late = 0;         // packets over a millisecond late
  std::uint64_t not_carried = 0;  // rejected by the system
};

/// Two hosts and a link between them. Each host is a network namespace with a TUN device (MTU 1500), so the kernel's
/// TCP and UDP run. A thread carries the IPv4 packets as a LinkSpec defines. Needs root or `unshare -r` to make
/// namespaces. The devices have no offloads, so no packet is larger than the MTU.
class EmulatedLink : NonCopyable {
 public:
  static constexpr const char *kServerAddress = "10.77.0.1", *kClientAddress = "10.77.0.2";

  /// Makes a link. `congestion_control` is TCP's on both hosts, such as cubic. The error names the system call that
  /// failed.
  [[nodiscard]] static std::variant<std::unique_ptr<EmulatedLink>, std::string> create(
      const LinkSpec& spec, const std::string& congestion_control);
  ~EmulatedLink();

  /// Runs a function on the thread of a host, and waits. Its sockets, threads and processes belong to that host. The
  /// threads live as long as the link. One caller at a time.
  void on_server(const std::function<void()>& work);
  void on_client(const std::function<void()>& work);

  /// Returns the arrival time of the first packet at the client. For TCP that is the SYN with its acknowledgement, so
  /// the client is connected. Any thread.
  [[nodiscard]] std::optional<std::chrono::steady_clock::time_point> first_at_client() const;
  /// Any thread.
  [[nodiscard]] LinkCounts counts() const;

 private:
  struct State;
  explicit EmulatedLink(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace gs::bench
