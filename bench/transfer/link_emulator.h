#pragma once

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
  double worst_delay = 0;         // seconds that a packet came out later than it should have
  std::uint64_t late = 0;         // packets of which it was more than a millisecond
  std::uint64_t not_carried = 0;  // that the system did not take
};

/// Two hosts and the link between them: each a network namespace of this process with a TUN device (MTU 1500), so that
/// TCP and UDP are the kernel's own, and a thread that carries the IPv4 packets from one to the other as a LinkSpec
/// says. Needs the right to make network namespaces: root, or `unshare -r`. Packets are as large as on a line: the
/// devices offer the kernel no offloads.
class EmulatedLink {
 public:
  static constexpr const char *kServerAddress = "10.77.0.1", *kClientAddress = "10.77.0.2";

  /// `congestion_control`: TCP's of both hosts, such as cubic. The error says what the system did not allow.
  [[nodiscard]] static std::variant<std::unique_ptr<EmulatedLink>, std::string> create(
      const LinkSpec& spec, const std::string& congestion_control);
  ~EmulatedLink();
  EmulatedLink(const EmulatedLink&) = delete;
  EmulatedLink& operator=(const EmulatedLink&) = delete;

  /// Runs something on the thread of a host, and waits for it: sockets, threads and processes that it makes belong to
  /// that host. The threads live as long as the link. One caller at a time.
  void on_server(const std::function<void()>& work);
  void on_client(const std::function<void()>& work);

  /// When the first packet reached the client: of TCP the SYN with its acknowledgement, so it is when the connection
  /// stands there. Any thread.
  [[nodiscard]] std::optional<std::chrono::steady_clock::time_point> first_at_client() const;
  /// Any thread.
  [[nodiscard]] LinkCounts counts() const;

 private:
  struct State;
  explicit EmulatedLink(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace gs::bench
