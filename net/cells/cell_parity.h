#pragma once

#include "net/atm/aal5.h"
#include "net/atm/cells.h"
#include "net/base/token_bucket.h"
#include "net/cells/cell_contract.h"
#include "net/cells/erasure.h"

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

// Parity datagrams: what of the data behind the base is lost can be rebuilt
// from them, without asking. See CELLS.md.

/// Their channel: the client's, and so of none of its slots.
constexpr Vc kParityVc{0, 34};
/// Of a group of data datagrams: how many, and over how many running numbers.
constexpr std::size_t kMostMembers = 64, kParitySpan = 192;
/// How far behind a parity datagram its group may begin.
constexpr std::uint32_t kMostParityBack = 4096;
/// Bytes before a symbol in a parity PDU; before the cells in a symbol.
constexpr std::size_t kParityHead = 12 + kParitySpan / 8, kSymbolHead = 6;

/// With parity, the data datagrams of a client that wishes for so many cells
/// hold at most this many, so that a symbol of them fits into one datagram of
/// those wished. At least kFewestCells: with 4 or 5 wished cells, parity
/// datagrams have 6.
[[nodiscard]] constexpr std::size_t protected_cells(std::size_t cells) {
  const std::size_t before = kAal5Trailer + kParityHead + kSymbolHead, all = cells * kCellPayload;
  return std::max<std::size_t>(kFewestCells, all > before ? (all - before) / kPackedCell : 0);
}
static_assert(protected_cells(kMostCells) == 23);
static_assert(cells_of_pdu(kParityHead + kSymbolHead + protected_cells(kMostCells) * kPackedCell) <= kMostCells);

/// The head of a parity PDU.
struct Parity {
  std::uint8_t symbol = 0;             // number of the symbol: members.count() to 254
  std::uint32_t time = 0;              // when it was sent: microseconds, the low 32 bits
  std::uint32_t back = 0;              // how many numbers before this datagram's own the group begins
  std::bitset<kParitySpan> members{};  // bit i: datagram i of those from there on; bit 0 is set
};
/// A parity PDU's user data.
[[nodiscard]] std::vector<std::byte> encode_parity(const Parity& parity, std::span<const std::byte> symbol);
/// The head, and the symbol in `rest`. Nothing where there is none, or its
/// numbers are none that a sender gives. Safe for untrusted bytes.
[[nodiscard]] std::optional<Parity> decode_parity(std::span<const std::byte> bytes, std::span<const std::byte>& rest);

/// What parity protects of a datagram: the length and the CRC of its cells, and
/// they, as they stand on the wire. `cells` may be what follows a datagram's
/// header.
[[nodiscard]] std::vector<std::byte> symbol_of_cells(std::span<const std::byte> cells);
/// The cells of a symbol that may have grown by zeros; nothing if they are not
/// what was protected. Safe for untrusted bytes.
[[nodiscard]] std::optional<std::span<const std::byte>> cells_of_symbol(std::span<const std::byte> symbol);

/// The share of datagrams that a client loses, and how far they are lost in
/// runs, from its reports: over the last two seconds, or kLeast datagrams if
/// those are more.
class LossMeter {
 public:
  static constexpr double kLeast = 128, kSample = 32, kMostRuns = 8;

  /// Both from the begin of the session; what no client can say does no harm.
  void add(std::uint64_t received, std::uint64_t lost, Instant now);
  /// 0 to 1.
  [[nodiscard]] double share() const { return total_ > 0 ? lost_ / total_ : 0; }
  /// The share that parity should stand: more where little is known.
  [[nodiscard]] double likely() const;
  [[nodiscard]] double datagrams() const { return total_; }
  /// How much more the losses of kSample datagrams vary than those of single,
  /// independent ones would (the index of dispersion): 1 to kMostRuns.
  [[nodiscard]] double runs() const { return std::clamp(spread_, 1.0, kMostRuns); }

 private:
  std::uint64_t last_received_ = 0, last_lost_ = 0;
  double total_ = 0, lost_ = 0;
  double sample_total_ = 0, sample_lost_ = 0, spread_ = 1;
  Instant last_{};
};

/// Makes the parity of one client's data datagrams: in groups, as many symbols
/// as its losses ask for. Until the first reports tell of loss, or that there
/// is none, groups are kept without parity; a group gets more when the loss
/// turns out higher. Memory: kMostHeld bytes of closed groups, and one of at most
/// kMostMembers datagrams. One thread; no clock.
class ParitySender {
 public:
  static constexpr std::size_t kMostHeld = std::size_t{512} << 10, kMostGroups = 32, kFewMembers = 8;
  static constexpr Instant kLongestGroup{500'000};
  /// A group of data may be lost for good with this probability.
  static constexpr double kFailure = 0.01;
  /// Below this share lost, no parity.
  static constexpr double kLeastLoss = 0.002;

  explicit ParitySender(bool enabled) : enabled_(enabled) {}

  /// Whether data are to be protected: datagrams of protected_cells, given to
  /// `add`.
  [[nodiscard]] bool on() const { return enabled_ && (!known_ || lossy_); }
  /// A data datagram was sent: its running number and its cells on the wire.
  void add(std::uint64_t number, std::span<const std::byte> cells, Instant now);
  /// A report came. `quiet`: nothing is under way or to be sent, so that no
  /// later report will know more.
  void report(std::uint64_t received, std::uint64_t lost, bool quiet, Instant now);
  /// The data end here for now: what was sent is a group, though a small one.
  /// Gives the number of the last group.
  std::uint64_t flush(Instant now);
  /// Whether all parity of the groups up to this one was sent, and it is known
  /// how much that is.
  [[nodiscard]] bool settled(std::uint64_t group) const;
  /// Whether there is parity to send; whether it is due before more data.
  [[nodiscard]] bool pending() const { return pending_count() > 0; }
  [[nodiscard]] bool due() const { return credit_ >= 1 && pending(); }
  /// The cells of the parity datagram with this running number and time of
  /// sending; empty if there is none.
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
  std::vector<std::pair<std::uint64_t, std::vector<std::byte>>> open_;  // numbers and symbols
  Instant opened_{};
  std::uint64_t closed_ = 0;  // groups, ever
  std::deque<Group> held_;
  double credit_ = 0, step_ = 0;  // parity datagrams; for each of data
};

}  // namespace gs::net
