#pragma once

#include "net/atm/cells.h"
#include "net/base/address_space.h"
#include "net/base/siphash.h"
#include "net/cells/cell_source.h"
#include "net/cells/erasure.h"
#include "net/limits/token_bucket.h"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace gs::net {

// Messages between cell clients and cell servers. CELLS.md defines their bytes.

/// Label (MPLS) of GhostSpace's cells, and channel type of its messages on the associated channel.
constexpr std::uint32_t kCellLabel = 1000;
constexpr std::uint16_t kContractChannel = 0x7ff8;
/// Minimum length of the messages that a client sends before the server has verified its address.
constexpr std::size_t kHelloBytes = 256;
constexpr std::size_t kMaxPath = 900, kMaxText = 200, kMaxSlots = 8, kMaxRegions = 8, kMaxWishes = 128;
constexpr std::uint8_t kMinCells = 4;  // minimum that a client may request for `cells`

/// Address and port of UDP. IPv4 is mapped into IPv6 (RFC 4291 2.5.5.2).
struct Endpoint {
  IpAddress address{};
  std::uint16_t port = 0;
  friend auto operator<=>(const Endpoint&, const Endpoint&) = default;
};

/// First message of a client. `nonce` distinguishes sessions of the client.
struct HelloMessage {
  std::uint64_t nonce = 0;
};
/// Proof of the client's address. The server sends it, and the client returns it with each request.
struct CookieMessage {
  std::uint64_t nonce = 0;
  std::uint32_t time = 0;  // the server's clock in milliseconds
  std::uint64_t tag = 0;
  friend bool operator==(const CookieMessage&, const CookieMessage&) = default;
};
/// Request for one slot of a client. Replaces the earlier request of the slot. The client repeats it until the server
/// answers.
struct RequestMessage {
  CookieMessage cookie;
  std::uint32_t number = 0;  // increases with each new request of the client
  std::uint8_t slot = 0;           // 0 to 7
  std::uint8_t weight = 1;         // share of the rate, 1 to 255
  std::uint8_t cells = kMaxCells;  // maximum cells of a datagram, kMinCells to kMaxCells
  std::uint32_t streams = 0xffff;  // bit set of the wanted streams
  std::uint64_t rate = 0;  // requested bits per second, for the whole session
  std::uint64_t budget = 0;  // maximum bytes of chunks; 0 means unlimited
  std::string path;  // path of the source; empty clears the slot
};
struct StreamGrant {
  bool records = false;
  std::uint32_t chunks = 0;
};
/// Grant: describes the data that the server will send.
struct GrantMessage {
  std::uint64_t session = 0;
  std::uint32_t number = 0;  // number of the request that is granted
  std::uint8_t slot = 0;
  std::uint64_t rate = 0;  // bits per second
  std::uint32_t version = 0;
  std::uint32_t base_crc = 0;  // CRC (aal5_crc) of the base
  bool delay_aware = false;  // reduces the rate only after losses with a queue (CongestionResponse)
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
/// Part of the source that a viewer sees. The server sends its chunks first.
struct Region {
  CellBox box{};
  std::uint8_t weight = 1;  // regions with higher weight are sent first
  friend bool operator==(const Region&, const Region&) = default;
};
/// Name of a chunk: the stream, and the chunk's index in the stream.
struct ChunkName {
  std::uint8_t stream = 0;
  std::uint32_t chunk = 0;
  friend auto operator<=>(const ChunkName&, const ChunkName&) = default;
};
/// Successive chunks of a stream.
struct ChunkRun {
  static constexpr std::size_t kMost = 16;  // maximum chunks of a run
  ChunkName first;
  std::uint8_t count = 1;  // chunks
  friend bool operator==(const ChunkRun&, const ChunkRun&) = default;
};
struct SlotReport {
  std::uint8_t slot = 0;
  std::uint32_t number = 0;  // number of the granted request
  bool base_done = false;
  std::vector<Region> regions;   // at most kMaxRegions
  std::vector<ChunkRun> wishes;  // at most kMaxWishes; sent before other chunks, even if sent earlier
};
/// Report of a client. Keeps the session alive and controls the server's rate.
struct ReportMessage {
  std::uint64_t session = 0;
  std::uint32_t number = 0;
  std::uint64_t next = 0;  // highest received running number + 1
  std::uint64_t received = 0, lost = 0;
  std::uint32_t loss_rate = 0;  // loss events per datagram (RFC 5348 5.4), in units of 1/2^32
  std::uint64_t receive_rate = 0;  // received bytes per second since the previous report
  std::uint32_t echo = 0,
                held = 0;  // newest time stamp of the server, and microseconds since it was received
  std::uint64_t rate = 0;  // requested rate, bits per second
  std::vector<SlotReport> slots;
};
struct SlotSync {
  std::uint8_t slot = 0;
  std::uint32_t number = 0;
  bool ended = false;  // the server has sent all data of the slot
  std::uint64_t bytes = 0;  // sent bytes of chunks
};
/// State of the server's session. Sent several times per second.
struct SyncMessage {
  std::uint64_t session = 0;
  std::uint32_t time = 0;  // server's clock in microseconds, the low 32 bits
  std::uint64_t next = 0;               // running number of the next datagram
  std::uint64_t granted = 0, rate = 0;  // bits per second
  std::uint32_t round_trip = 0;         // microseconds
  std::vector<SlotSync> slots;
};
/// End of the session, from either side.
struct ByeMessage {
  std::uint64_t session = 0;
  std::string text;
};

using ContractMessage = std::variant<HelloMessage, CookieMessage, RequestMessage, GrantMessage, RefuseMessage,
                                     ReportMessage, SyncMessage, ByeMessage>;

/// Encodes a datagram. Pads a HelloMessage to kHelloBytes, and a ReportMessage to the length of a ByeMessage. Shortens
/// lists and texts that are too long.
[[nodiscard]] std::vector<std::byte> encode_contract(const ContractMessage& message);
/// Decodes a datagram. Returns nullopt if the datagram is not a message or has invalid values. Safe for untrusted
/// bytes.
[[nodiscard]] std::optional<ContractMessage> decode_contract(std::span<const std::byte> bytes);

/// Makes and checks cookies without storing clients.
class CookieMaker {
 public:
  explicit CookieMaker(const SipKey& secret) : secret_(secret) {}
  [[nodiscard]] CookieMessage make(const Endpoint& client, std::uint64_t nonce, Instant now) const;
  /// Returns the age of a cookie. Returns nullopt if this maker did not make it for `client`. Ages wrap after 49 days.
  [[nodiscard]] std::optional<Instant> age(const CookieMessage& cookie, const Endpoint& client, Instant now) const;
  /// Returns an unpredictable session number.
  [[nodiscard]] std::uint64_t session(const Endpoint& client, std::uint64_t nonce) const;

 private:
  [[nodiscard]] std::uint64_t tag(const Endpoint& client, std::uint64_t nonce, std::uint32_t time, char use) const;
  SipKey secret_;
};

}  // namespace gs::net
