#pragma once

#include "net/base/address_space.h"
#include "net/limits/token_bucket.h"

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

/// Limits of all clients together (`total_`) and of one client (`client_`). 0 means unlimited.
struct HttpLimits {
  std::uint64_t total_rate = 0, client_rate = 0;  // bytes of response bodies per second
  std::uint64_t requests_per_second = 200;  // per client; a burst may be twice as large
  std::size_t connections = 4096, connections_of_client = 256;
};

/// Key of a client: an IPv4 address, or the first 64 bits of an IPv6 address (the usual block of one customer).
using ClientKey = std::array<std::uint8_t, 16>;
[[nodiscard]] ClientKey client_key(const IpAddress& address);
/// Returns the key of an address. Returns zeros for families other than IPv4 and IPv6.
[[nodiscard]] ClientKey client_key(const sockaddr* address);
/// Returns an address such as "192.0.2.1" or "2001:db8::1". Returns "-" for families other than IPv4 and IPv6.
[[nodiscard]] std::string client_name(const sockaddr* address);

/// Shares the rate fairly among clients, and among the transfers of each client, in turns. In a turn, a transfer may
/// send one piece; all pieces have the same length. State machine without a clock. One thread.
class ClientLimits {
 public:
  using TransferId = std::uint64_t;

  ClientLimits(HttpLimits limits, Instant now);

  /// Reports whether one more connection may be opened, and counts it if so. `shared` means that the peer is a proxy;
  /// begin() then counts the clients of the proxy.
  [[nodiscard]] bool open(const ClientKey& peer, bool shared, Instant now);
  void close(const ClientKey& peer, bool shared, Instant now);
  /// Reports whether one more concurrent request of a client may be answered, and counts it if so. For clients of a
  /// proxy.
  [[nodiscard]] bool begin(const ClientKey& client, Instant now);
  void end(const ClientKey& client, Instant now);
  /// Reports whether the client's request rate allows one more request, and counts it if so.
  [[nodiscard]] bool admit(const ClientKey& client, Instant now);

  /// Reports whether rates are limited, so that transfers must wait for a turn.
  [[nodiscard]] bool paced() const { return limits_.total_rate > 0 || limits_.client_rate > 0; }
  /// Returns the number of bytes that a transfer may send in one turn.
  [[nodiscard]] std::size_t piece() const { return piece_; }
  /// Adds a transfer that waits for a turn.
  void wait(const ClientKey& client, TransferId transfer, Instant now);
  /// Returns the transfer that may send a piece now. Returns nullopt if none may.
  [[nodiscard]] std::optional<TransferId> next(Instant now);
  /// Returns the time at which next() will return a transfer. Instant::max() means that no transfer waits.
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
  std::deque<ClientKey> turns_;  // clients with waiting transfers
  std::size_t connections_ = 0;
};

}  // namespace gs::net
