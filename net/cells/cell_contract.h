#pragma once

#include "net/atm/cells.h"
#include "net/base/address_space.h"
#include "net/base/siphash.h"
#include "net/base/token_bucket.h"
#include "net/cells/cell_source.h"
#include "net/cells/erasure.h"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace gs::net {

// What clients and servers of cells say to each other beside the cells. The
// bytes are defined in CELLS.md.

/// The label of GhostSpace's cells, and the type of its messages on the
/// associated channel.
constexpr std::uint32_t kCellLabel = 1000;
constexpr std::uint16_t kContractChannel = 0x7ff8;
/// Every message that comes before the server knows the client is at least so
/// long.
constexpr std::size_t kHelloBytes = 256;
constexpr std::size_t kMostPath = 900, kMostText = 200, kMostSlots = 8, kMostRegions = 8, kMostWishes = 64;
constexpr std::uint8_t kFewestCells = 4;  // in a datagram

/// An address and port of UDP; IPv4 is mapped into IPv6 (RFC 4291 2.5.5.2).
struct Endpoint {
  IpAddress address{};
  std::uint16_t port = 0;
  friend auto operator<=>(const Endpoint&, const Endpoint&) = default;
};

/// "Who are you?" of a client; `nonce` tells its sessions apart.
struct HelloMessage {
  std::uint64_t nonce = 0;
};
/// Proof of the address: goes to the client, and back with each request.
struct CookieMessage {
  std::uint64_t nonce = 0;
  std::uint32_t time = 0;  // milliseconds of the server's clock
  std::uint64_t tag = 0;
  friend bool operator==(const CookieMessage&, const CookieMessage&) = default;
};
/// What the client wants in one of its slots; takes the place of what it wanted
/// there before. Sent until answered.
struct RequestMessage {
  CookieMessage cookie;
  std::uint32_t number = 0;         // rises with each new wish
  std::uint8_t slot = 0;            // 0 to 7
  std::uint8_t weight = 1;          // share of the rate, 1 to 255
  std::uint8_t cells = kMostCells;  // of a datagram, kFewestCells to kMostCells
  std::uint32_t streams = 0xffff;   // bit per stream
  std::uint64_t rate = 0;           // bits a second, for the whole session
  std::uint64_t budget = 0;         // bytes of chunks; 0: no limit
  std::string path;                 // empty: nothing more in this slot
};
struct StreamGrant {
  bool records = false;
  std::uint32_t chunks = 0;
};
/// What the server will send.
struct GrantMessage {
  std::uint64_t session = 0;
  std::uint32_t number = 0;  // of the request
  std::uint8_t slot = 0;
  std::uint64_t rate = 0;  // bits a second
  std::uint32_t version = 0;
  std::uint32_t base_crc = 0;  // AAL5's, of the base
  bool delay_aware = false;    // only losses that come with a queue count (CongestionResponse)
  ErasureLayout base;
  std::vector<StreamGrant> streams;
};
enum class Refusal : std::uint8_t { full = 1, not_found = 2, bad_request = 3 };
struct RefuseMessage {
  std::uint64_t nonce = 0;
  std::uint32_t number = 0;
  std::uint8_t slot = 0;
  Refusal why = Refusal::bad_request;
  std::string text;
};
/// Of what a viewer sees: more of this first.
struct Region {
  CellBox box{};
  std::uint8_t weight = 1;  // highest first
  friend bool operator==(const Region&, const Region&) = default;
};
/// A chunk: stream, then number in it.
struct ChunkName {
  std::uint8_t stream = 0;
  std::uint32_t chunk = 0;
  friend auto operator<=>(const ChunkName&, const ChunkName&) = default;
};
struct SlotReport {
  std::uint8_t slot = 0;
  std::uint32_t number = 0;  // of the request that was granted
  bool base_done = false;
  std::vector<Region> regions;    // at most kMostRegions
  std::vector<ChunkName> wishes;  // at most kMostWishes: next, also those that were sent already
};
/// What arrived: keeps the session alive, and the rate right.
struct ReportMessage {
  std::uint64_t session = 0;
  std::uint32_t number = 0;
  std::uint64_t next = 0;  // running number behind the highest datagram that came
  std::uint64_t received = 0, lost = 0;
  std::uint32_t loss_rate = 0;     // of loss events (RFC 5348 5.4), in 1/2^32
  std::uint64_t receive_rate = 0;  // bytes a second since the last report
  std::uint32_t echo = 0,
                held = 0;  // the newest time stamp, and microseconds since it came
  std::uint64_t rate = 0;  // wanted now, bits a second
  std::vector<SlotReport> slots;
};
struct SlotSync {
  std::uint8_t slot = 0;
  std::uint32_t number = 0;
  bool ended = false;       // all was sent
  std::uint64_t bytes = 0;  // of chunks, sent
};
/// Where the server is; several a second.
struct SyncMessage {
  std::uint64_t session = 0;
  std::uint32_t time = 0;               // microseconds, the low 32 bits
  std::uint64_t next = 0;               // running number of the next datagram
  std::uint64_t granted = 0, rate = 0;  // bits a second
  std::uint32_t round_trip = 0;         // microseconds
  std::vector<SlotSync> slots;
};
/// The end, from either side.
struct ByeMessage {
  std::uint64_t session = 0;
  std::string text;
};

using ContractMessage = std::variant<HelloMessage, CookieMessage, RequestMessage, GrantMessage, RefuseMessage,
                                     ReportMessage, SyncMessage, ByeMessage>;

/// A datagram; hellos are filled up to kHelloBytes, reports to what a goodbye
/// needs. Lists and texts that are too long are cut.
[[nodiscard]] std::vector<std::byte> encode_contract(const ContractMessage& message);
/// Nothing when the datagram is none of our messages, or has values that they
/// cannot have. Safe for untrusted bytes.
[[nodiscard]] std::optional<ContractMessage> decode_contract(std::span<const std::byte> bytes);

/// Makes and checks cookies without remembering clients.
class CookieMaker {
 public:
  explicit CookieMaker(const SipKey& secret) : secret_(secret) {}
  [[nodiscard]] CookieMessage make(const Endpoint& client, std::uint64_t nonce, Instant now) const;
  /// Whether we made it for this client, and how old it is (at most the 49 days
  /// after which its clock begins again).
  [[nodiscard]] std::optional<Instant> age(const CookieMessage& cookie, const Endpoint& client, Instant now) const;
  /// A number that others cannot guess.
  [[nodiscard]] std::uint64_t session(const Endpoint& client, std::uint64_t nonce) const;

 private:
  [[nodiscard]] std::uint64_t tag(const Endpoint& client, std::uint64_t nonce, std::uint32_t time, char use) const;
  SipKey secret_;
};

}  // namespace gs::net
