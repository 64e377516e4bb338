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

// Parity datagrams. They restore data datagrams that were lost, without another request. They do not protect the base
// (CELLS.md).

/// Virtual channel of parity. It serves all slots of a client.
constexpr Vc kParityVc{0, 34};
/// Limits of a group: maximum data datagrams, and maximum span of their running numbers.
constexpr std::size_t kMaxMembers = 64, kParitySpan = 192;
/// Maximum distance, in running numbers, from a parity datagram to the start of its group.
constexpr std::uint32_t kMaxParityBack = 4096;
/// Bytes before the symbol in a parity PDU; bytes before the cells in a symbol.
constexpr std::size_t kParityHead = 12 + kParitySpan / 8, kSymbolHead = 6;

/// Returns the maximum cells of a data datagram with parity, for a client that requests `cells`. The symbol of that
/// datagram then fits into one datagram of the requested size. Returns at least kMinCells. For 4 or 5 requested cells,
/// parity datagrams have 6 cells.
[[nodiscard]] constexpr std::size_t protected_cells(std::size_t cells) {
  const std::size_t before = kAal5Trailer + kParityHead + kSymbolHead, all = cells * kCellPayload;
  return std::max<std::size_t>(kMinCells, all > before ? (all - before) / kPackedCell : 0);
}
static_assert(protected_cells(kMaxCells) == 23);
static_assert(cells_of_pdu(kParityHead + kSymbolHead + protected_cells(kMaxCells) * kPackedCell) <= kMaxCells);

/// Head of a parity PDU.
struct Parity {
  std::uint8_t symbol = 0;  // index of the symbol in the code: members.count() to 254
  std::uint32_t time = 0;  // send time: the server's clock in microseconds, the low 32 bits
  std::uint32_t back = 0;  // distance in running numbers to the first datagram of the group
  std::bitset<kParitySpan> members{};  // bit i means that the i-th datagram after the first is a member; bit 0 is set
};
/// Encodes the user data of a parity PDU.
[[nodiscard]] std::vector<std::byte> encode_parity(const Parity& parity, std::span<const std::byte> symbol);
/// Decodes the head of a parity PDU and sets `rest` to the symbol. Returns nullopt if the head is missing or invalid.
/// Safe for untrusted bytes.
[[nodiscard]] std::optional<Parity> decode_parity(std::span<const std::byte> bytes, std::span<const std::byte>& rest);

/// Makes the symbol of a datagram: the length and CRC of its cells, then the cells. `cells` are the encoded cells, the
/// bytes after the header of the datagram.
[[nodiscard]] std::vector<std::byte> symbol_of_cells(std::span<const std::byte> cells);
/// Returns the encoded cells of a symbol, which may be padded with zeros. Returns nullopt if length or CRC is wrong.
/// Safe for untrusted bytes.
[[nodiscard]] std::optional<std::span<const std::byte>> cells_of_symbol(std::span<const std::byte> symbol);

/// Measures loss and its burstiness from the reports of one client. Covers the last two seconds or kMin datagrams,
/// whichever is more.
class LossMeter {
 public:
  static constexpr double kMin = 128, kSample = 32, kMaxRuns = 8;

  /// Adds a report. Both counts are totals from the start of the session. Ignores impossible counts.
  void add(std::uint64_t received, std::uint64_t lost, Instant now);
  /// Returns the share of lost datagrams, 0 to 1.
  [[nodiscard]] double share() const { return total_ > 0 ? lost_ / total_ : 0; }
  /// Returns the share of losses that parity should withstand. With few counted datagrams, adds a larger margin.
  [[nodiscard]] double likely() const;
  [[nodiscard]] double datagrams() const { return total_; }
  /// Returns the index of dispersion of the losses, 1 to kMaxRuns. The value 1 means independent losses. Samples have
  /// kSample datagrams.
  [[nodiscard]] double runs() const { return std::clamp(spread_, 1.0, kMaxRuns); }

 private:
  std::uint64_t last_received_ = 0, last_lost_ = 0;
  double total_ = 0, lost_ = 0;
  double sample_total_ = 0, sample_lost_ = 0, spread_ = 1;
  Instant last_{};
};

/// Makes the parity of one client's data datagrams. Gives each group as many symbols as the losses require. Until the
/// first reports, holds groups without parity. Adds parity to groups if the loss increases.
///
/// Memory: kMaxHeld bytes of closed groups, and one open group of at most kMaxMembers datagrams. One thread. No clock.
class ParitySender {
 public:
  static constexpr std::size_t kMaxHeld = std::size_t{512} << 10, kMaxGroups = 32, kFewMembers = 8;
  static constexpr Instant kLongestGroup{500'000};
  /// Maximum probability that the data of a group cannot be restored.
  static constexpr double kFailure = 0.01;
  /// Share of lost datagrams below which no parity is sent.
  static constexpr double kMinLoss = 0.002;

  explicit ParitySender(bool enabled) : enabled_(enabled) {}

  /// Reports whether data datagrams must be passed to add(). If so, they have at most protected_cells() cells.
  [[nodiscard]] bool on() const { return enabled_ && (!known_ || lossy_); }
  /// Adds a sent data datagram: its running number and its encoded cells.
  void add(std::uint64_t number, std::span<const std::byte> cells, Instant now);
  /// Takes a report of the client. `quiet` means that no datagrams are in flight or waiting, so that these counts are
  /// final.
  void report(std::uint64_t received, std::uint64_t lost, bool quiet, Instant now);
  /// Closes the open group at the end of the data, even if the group is small. Returns the id of the last group.
  std::uint64_t flush(Instant now);
  /// Reports whether all parity for groups up to `group` is determined and sent.
  [[nodiscard]] bool settled(std::uint64_t group) const;
  /// Reports whether parity waits to be sent. Parity that is due() must be sent before more data.
  [[nodiscard]] bool pending() const { return pending_count() > 0; }
  [[nodiscard]] bool due() const { return credit_ >= 1 && pending(); }
  /// Returns the cells of the next parity datagram, which gets this running number and send time. Returns an empty list
  /// if no parity waits.
  [[nodiscard]] std::vector<Cell> next(std::uint64_t number, std::uint32_t time);

 private:
  struct Group {
    std::uint64_t id = 0, first = 0;
    std::bitset<kParitySpan> members;
    ErasureEncoder encoder;
    std::size_t sent = 0, wanted = 0;  // numbers of parity symbols
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
  std::vector<std::pair<std::uint64_t, std::vector<std::byte>>> open_;  // running number and symbol of each member
  Instant opened_{};
  std::uint64_t closed_ = 0;  // number of closed groups so far
  std::deque<Group> held_;
  double credit_ = 0, step_ = 0;  // parity datagrams that are due, and the increase per data datagram
};

}  // namespace gs::net
