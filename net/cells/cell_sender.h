#pragma once

#include "net/cells/cell_session.h"

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace gs::net {

struct CellServerOptions {
  SipKey secret{};  // secret key of cookies; random, new at every start
  std::uint64_t total_rate = 100'000'000;  // bits per second, for all clients together
  std::uint64_t client_rate = 50'000'000;  // bits per second, per client
  std::size_t most_clients = 256, most_of_address = 8;
  Instant forget{30'000'000};  // a client without messages for this time is removed
  CellSession::Options session;
};

/// Datagram to send, with its destination.
struct OutgoingDatagram {
  Endpoint to;
  std::vector<std::byte> bytes;
};

struct CellServerStatistics {
  std::uint64_t clients = 0;  // clients at present
  std::uint64_t accepted = 0, refused = 0,
                foreign = 0;  // started sessions; requests; unknown datagrams
  std::uint64_t datagrams = 0, bytes = 0;  // number and bytes of sent datagrams
  std::uint64_t parity_datagrams = 0, parity_bytes = 0;  // parity among the sent datagrams
};

/// Serves sources as cells to many clients: handles their messages and divides the rate. State machine without I/O and
/// clock. The owner passes it datagrams and sends the datagrams that it returns. One thread. Safe for untrusted
/// datagrams.
///
/// Stores nothing about an address that has not returned its cookie. Sends such an address no more bytes than it
/// received from it.
class CellServer {
 public:
  CellServer(CellServerOptions options, std::shared_ptr<CellLibrary> library);

  void receive(const Endpoint& from, std::span<const std::byte> bytes, Instant now);
  /// Returns the next datagram to send. Returns nullopt before `deadline`.
  [[nodiscard]] std::optional<OutgoingDatagram> next(Instant now);
  /// Returns the time at which `next` will return a datagram if no datagram is received before. Instant::max() means
  /// never.
  [[nodiscard]] Instant deadline(Instant now);
  /// Queues goodbye messages to all clients. `next` returns them.
  void stop();
  [[nodiscard]] CellServerStatistics statistics() const;

 private:
  using Sessions = std::map<Endpoint, std::unique_ptr<CellSession>>;
  void handle_request(const Endpoint& from, const RequestMessage& request, Instant now);
  CellSession* session_for(const Endpoint& from, const RequestMessage& request, Instant age, Instant now);
  void open(const Endpoint& from, CellSession& session, const RequestMessage& request);
  void refuse(const Endpoint& to, const RequestMessage& request, Refusal why, std::string text);
  void answer(const Endpoint& to, const ContractMessage& message);
  std::shared_ptr<const ErasureEncoder> encoder(const std::shared_ptr<CellSource>& source, std::size_t cells);
  void divide(Instant now);
  void forget(Instant now);

  CellServerOptions options_;
  std::shared_ptr<CellLibrary> library_;
  CookieMaker cookies_;
  Sessions sessions_;
  std::map<Endpoint, TokenBucket> opens_;  // limits of new sessions, by client address
  Endpoint turn_;  // client that was served last in turn
  TokenBucket total_;
  std::deque<OutgoingDatagram> answers_;
  struct Shared {
    std::weak_ptr<CellSource> source;
    std::weak_ptr<const ErasureEncoder> encoder;
  };
  std::map<std::pair<const CellSource*, std::size_t>, Shared> encoders_;
  CellServerStatistics statistics_;
};

}  // namespace gs::net
