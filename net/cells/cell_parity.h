#pragma once

#include "net/atm/aal5.h"
#include "net/atm/cells.h"
#include "net/cells/cell_contract.h"
#include "net/cells/erasure.h"
#include "net/limits/token_bucket.h"

#include <algorithm>
#include <bitset>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace gs::net {

// Parity datagrams: they restore lost data datagrams after the base without another request (CELLS.md).

/// Channel of parity, which belongs to the client and not to a slot.
constexpr Vc kParityVc{0, 34};
/// Limits of a group: the number of data datagrams, and the span of their running numbers.
constexpr std::size_t kMaxMembers = 64, kParitySpan = 192;
/// Maximum distance from a parity datagram back to the start of its group.
constexpr std::uint32_t kMaxParityBack = 4096;
/// Bytes before the symbol in a parity PDU, and bytes before the cells in a symbol.
constexpr std::size_t kParityHead = 12 + kParitySpan / 8, kSymbolHead = 6;

/// Returns the maximum cells of data datagrams with parity, for a client that requests `cells`. A symbol of them then
/// fits into one datagram of the requested size. Returns at least kMinCells: for 4 or 5 requested cells, parity
/// datagrams have 6.
[[nodiscard]] constexpr std::size_t protected_cells(std::size_t cells) {
  const std::size_t before = kAal5Trailer + kParityHead + kSymbolHead, all = cells * kCellPayload;
  return std::max<std::size_t>(kMinCells, all > before ? (all - before) / kPackedCell : 0);
}
static_assert(protected_cells(kMaxCells) == 23);
static_assert(cells_of_pdu(kParityHead + kSymbolHead + protected_cells(kMaxCells) * kPackedCell) <= kMaxCells);

/// Head of a parity PDU.
struct Parity {
  std::uint8_t symbol = 0;             // number of the symbol: members.count() to 254
  std::uint32_t time = 0;              // send time: microseconds, the low 32 bits
  std::uint32_t back = 0;              // distance from this datagram back to the first datagram of the group
  std::bitset<kParitySpan> members{};  // bit i: datagram i of the group's span; bit 0 is set
};
/// Encodes the user data of a parity PDU.
[[nodiscard]] std::vector<std::byte> encode_parity(const Parity& parity, std::span<const std::byte> symbol);
/// Decodes the head and sets `rest` to the symbol. Returns nullopt if the head is missing or invalid. Safe for
/// untrusted bytes.
[[nodiscard]] std::optional<Parity> decode_parity(std::span<const std::byte> bytes, std::span<const std::byte>& rest);

/// Makes the symbol of a datagram: the length and the CRC of its cells, then the cells as on the wire. `cells` may be
/// the bytes after a datagram's header.
[[nodiscard]] std::vector<std::byte> symbol_of_cells(std::span<const std::byte> cells);
/// Returns the cells of a symbol, which may be padded with zeros. Returns nullopt if length or CRC is wrong. Safe for
/// untrusted bytes.
[[nodiscard]] std::optional<std::span<const std::byte>> cells_of_symbol(std::span<const std::byte> symbol);

/// Measures a client's loss and its burstiness from its reports, over the last two seconds or kMin datagrams,
/// whichever is more.
class LossMeter {
 public:
  static constexpr double kMin = 128, kSample = 32, kMaxRuns = 8;

  /// Adds a report. Both counts are totals since the start of the session. Ignores impossible counts.
  void add(std::uint64_t received, std::uint64_t lost, Instant now);
  /// Returns the share of lost datagrams, 0 to 1.
  [[nodiscard]] double share() const { return total_ > 0 ? lost_ / total_ : 0; }
  /// Returns the share that parity should withstand. It is higher if few datagrams were counted.
  [[nodiscard]] double likely() const;
  [[nodiscard]] double datagrams() const { return total_; }
  /// Returns the index of dispersion of losses in samples of kSample datagrams, 1 to kMaxRuns. 1 means independent
  /// losses.
  [[nodiscard]] double runs() const { return std::clamp(spread_, 1.0, kMaxRuns); }

 private:
  std::uint64_t last_received_ = 0, last_lost_ = 0;
  double total_ = 0, lost_ = 0;
  double sample_total_ = 0, sample_lost_ = 0, spread_ = 1;
  Instant last_{};
};

/// Makes the parity of one client's data datagrams: groups with as many symbols as the losses require. Keeps groups
/// without parity until the first reports show the loss. Adds parity to a group if the loss increases. Memory:
/// kMaxHeld bytes of closed groups, and one open group of at most kMaxMembers datagrams. One thread. No clock.
class ParitySender {
 public:
  static constexpr std::size_t kMaxHeld = std::size_t{512} << 10, kMaxGroups = 32, kFewMembers = 8;
  static constexpr Instant kLongestGroup{500'000};
  /// Maximum probability that a group of data is lost.
  static constexpr double kFailure = 0.01;
  /// Share of lost datagrams below which no parity is sent.
  static constexpr double kMinLoss = 0.002;

  explicit ParitySender(bool enabled) : enabled_(enabled) {}

  /// Reports whether data must be protected, that is, sent in datagrams of protected_cells() and passed to `add`.
  [[nodiscard]] bool on() const { return enabled_ && (!known_ || lossy_); }
  /// Adds a sent data datagram: its running number and its cells on the wire.
  void add(std::uint64_t number, std::span<const std::byte> cells, Instant now);
  /// Takes a report. `quiet` means that nothing is in flight or waiting, so later reports will not have more counts.
  void report(std::uint64_t received, std::uint64_t lost, bool quiet, Instant now);
  /// Closes the open group at the end of the data, even if it is small. Returns the number of the last group.
  std::uint64_t flush(Instant now);
  /// Reports whether the parity of all groups up to `group` is known and sent.
  [[nodiscard]] bool settled(std::uint64_t group) const;
  /// Report whether parity is waiting, and whether it must be sent before more data.
  [[nodiscard]] bool pending() const { return pending_count() > 0; }
  [[nodiscard]] bool due() const { return credit_ >= 1 && pending(); }
  /// Returns the cells of the next parity datagram, with this running number and send time; empty if there is none.
  [[nodiscard]] std::vector<Cell> next(std::uint64_t number, std::uint32_t time);

 private:
  struct Group {
    std::uint64_t id = 0, first = 0;
    std::bitset<kParitySpan> members;
    ErasureEncoder encoder;
    std::size_t sent = 0, wanted = 0;  // parity symbols
    Instant closed{};
    [[nodiscard]] std::size_t source() const { return encoder.layout().source; }
    [[nodiscard]] std::size_t bytes() const { return encoder.layout().bytes; }
  };
  void close(Instant now);
  void spread(std::size_t over);
  [[nodiscard]] std::size_t wanted(std::size_t source) const;
  [[nodiscard]] std::size_t pending_count() const;

  bool enabled_, known_ = false, lossy_ = false;
  LossMeter meter_;
  std::vector<std::pair<std::uint64_t, std::vector<std::byte>>> open_;  // running numbers and symbols
  Instant opened_{};
  std::uint64_t closed_ = 0;  // total of closed groups
  std::deque<Group> held_;
  double credit_ = 0, step_ = 0;  // parity datagrams, and parity datagrams per data datagram
};

}  // namespace gs::net
