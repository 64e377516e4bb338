#pragma once

#include "net/base/address_space.h"
#include "net/base/token_bucket.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>

struct sockaddr;

namespace gs::net {

/// What all clients together, and one, may take. 0: no limit.
struct HttpLimits {
  std::uint64_t total_rate = 0, client_rate = 0;  // bytes a second, of bodies
  std::uint64_t requests_per_second = 200;        // of one client; twice as many at once
  std::size_t connections = 1024, connections_of_client = 256;
};

/// Where a client is: an IPv4 address, or the first 64 bits of one of IPv6,
/// which belong to one customer.
using ClientKey = std::array<std::uint8_t, 16>;
[[nodiscard]] ClientKey client_key(const IpAddress& address);
/// All zero for other families.
[[nodiscard]] ClientKey client_key(const sockaddr* address);
/// "192.0.2.1", "2001:db8::1"; "-" for others.
[[nodiscard]] std::string client_name(const sockaddr* address);

/// Shares the rate fairly: clients take turns, and so do the transfers of one
/// client; a turn is a piece of the same length for everyone. A state machine
/// without clock. One thread.
class ClientLimits {
 public:
  using TransferId = std::uint64_t;

  ClientLimits(HttpLimits limits, Instant now);

  /// Whether one more connection may be opened; counts it if so. `shared`: its peer is a proxy, whose clients are
  /// counted by their requests.
  [[nodiscard]] bool open(const ClientKey& peer, bool shared, Instant now);
  void close(const ClientKey& peer, bool shared, Instant now);
  /// Whether one more request of a client behind a proxy may be answered at a time, as if it were a connection; counts
  /// it if so.
  [[nodiscard]] bool begin(const ClientKey& client, Instant now);
  void end(const ClientKey& client, Instant now);
  /// Whether one more request may be answered; counts it if so.
  [[nodiscard]] bool admit(const ClientKey& client, Instant now);

  /// Whether transfers have to wait for their turn at all.
  [[nodiscard]] bool paced() const { return limits_.total_rate > 0 || limits_.client_rate > 0; }
  /// Bytes of a turn.
  [[nodiscard]] std::size_t piece() const { return piece_; }
  /// A transfer waits for a turn.
  void wait(const ClientKey& client, TransferId transfer, Instant now);
  /// The transfer whose turn it is: it may send a piece.
  [[nodiscard]] std::optional<TransferId> next(Instant now);
  /// When `next` will have something; Instant::max() for never.
  [[nodiscard]] Instant deadline(Instant now);
  [[nodiscard]] std::size_t connections() const { return connections_; }

 private:
  struct Client {
    std::size_t connections = 0;
    TokenBucket bytes, requests;
    std::deque<TransferId> waiting;
    Instant seen{};
  };
  Client& client(const ClientKey& key, Instant now);
  void forget(Instant now);

  HttpLimits limits_;
  std::size_t piece_ = 0;
  TokenBucket total_;
  std::map<ClientKey, Client> clients_;
  std::deque<ClientKey> turns_;  // clients that wait
  std::size_t connections_ = 0;
};

}  // namespace gs::net
