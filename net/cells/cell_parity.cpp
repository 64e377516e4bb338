#include "net/cells/cell_parity.h"

#include "net/base/network_bytes.h"
#include "net/cells/cell_framing.h"

#include <cmath>

namespace gs::net {
namespace {

constexpr double kWindow = 2e6;  // time constant in microseconds for the weight of older reports
constexpr double kFewDatagrams = 8, kEnoughDatagrams = 64;
constexpr std::uint64_t kMaxOfReport = 1'000'000;
constexpr double kWorstLoss = 0.9;
constexpr double kSpreadSamples = 24, kWildest = 40;  // the mean covers about 24 samples; maximum of one sample
// Maximum parity datagrams of a group: kMaxTimes per data datagram, but at least kMaxOfFew.
constexpr std::size_t kMaxTimes = 2, kMaxOfFew = 8;
constexpr Instant kHeldFor{2'000'000};

std::byte bit_of(std::size_t number) { return static_cast<std::byte>(0x80 >> number % 8); }

/// Returns how far `count` exceeds the highest count so far, `most`, and updates `most`.
std::uint64_t more(std::uint64_t& most, std::uint64_t count) {
  const std::uint64_t before = most;
  most = std::max(most, count);
  return std::min(most - before, kMaxOfReport);
}

}  // namespace

std::vector<std::byte> encode_parity(const Parity& parity, std::span<const std::byte> symbol) {
  std::vector<std::byte> bytes;
  bytes.reserve(kParityHead + symbol.size());
  NetworkWriter out(bytes);
  out.integer(static_cast<std::uint8_t>(PlaceKind::parity));
  out.integer(static_cast<std::uint8_t>(parity.members.count()));
  out.integer(parity.symbol);
  out.integer(std::uint8_t{0});
  out.integer(parity.time);
  out.integer(parity.back);
  bytes.resize(kParityHead);
  for (std::size_t i = 0; i < kParitySpan; ++i)
    if (parity.members[i]) bytes[12 + i / 8] |= bit_of(i);
  out.bytes(symbol);
  return bytes;
}

std::optional<Parity> decode_parity(std::span<const std::byte> bytes, std::span<const std::byte>& rest) {
  NetworkReader in(bytes);
  const auto kind = static_cast<PlaceKind>(in.integer<std::uint8_t>());
  const auto count = in.integer<std::uint8_t>();
  Parity parity;
  parity.symbol = in.integer<std::uint8_t>();
  (void)in.integer<std::uint8_t>();
  parity.time = in.integer<std::uint32_t>();
  parity.back = in.integer<std::uint32_t>();
  const auto mask = in.bytes(kParitySpan / 8);
  if (!in.good() || kind != PlaceKind::parity) return std::nullopt;
  std::uint32_t last = 0;
  for (std::uint32_t i = 0; i < kParitySpan; ++i)
    if ((mask[i / 8] & bit_of(i)) != std::byte{0}) {
      parity.members.set(i);
      last = i;
    }
  if (count == 0 || count > kMaxMembers || parity.members.count() != count || !parity.members[0]) return std::nullopt;
  if (parity.symbol < count || parity.symbol >= ErasureLayout::kMaxSymbols) return std::nullopt;
  // Parity is sent after all members of its group, so the members precede this datagram.
  if (parity.back > kMaxParityBack || last >= parity.back) return std::nullopt;
  rest = in.rest();
  if (rest.size() < kSymbolHead + kPackedCell || rest.size() > kSymbolHead + kMaxCells * kPackedCell ||
      (rest.size() - kSymbolHead) % kPackedCell != 0)
    return std::nullopt;
  return parity;
}

std::vector<std::byte> symbol_of_cells(std::span<const std::byte> cells) {
  std::vector<std::byte> bytes;
  bytes.reserve(kSymbolHead + cells.size());
  NetworkWriter out(bytes);
  out.integer(static_cast<std::uint16_t>(cells.size()));
  out.integer(aal5_crc(cells));
  out.bytes(cells);
  return bytes;
}

std::optional<std::span<const std::byte>> cells_of_symbol(std::span<const std::byte> symbol) {
  NetworkReader in(symbol);
  const std::size_t length = in.integer<std::uint16_t>();
  const auto crc = in.integer<std::uint32_t>();
  const auto cells = in.bytes(length);
  if (!in.good() || length == 0 || length % kPackedCell != 0 || aal5_crc(cells) != crc) return std::nullopt;
  return cells;
}

void LossMeter::add(std::uint64_t received, std::uint64_t lost, Instant now) {
  const double past = static_cast<double>(std::max(now - last_, Instant{0}).count());
  last_ = now;
  if (total_ > 0) {
    const double kept = std::max(std::exp(-past / kWindow), std::min(1.0, kMin / total_));
    total_ *= kept;
    lost_ *= kept;
  }
  const auto new_lost = static_cast<double>(more(last_lost_, lost));
  const double new_total = static_cast<double>(more(last_received_, received)) + new_lost;
  lost_ += new_lost;
  total_ += new_total;
  sample_lost_ += new_lost;
  sample_total_ += new_total;
  if (sample_total_ < kSample) return;
  const double loss = share(), off = sample_lost_ - sample_total_ * loss;
  if (loss > 0 && loss < 1)
    spread_ += (std::min(off * off / (sample_total_ * loss * (1 - loss)), kWildest) - spread_) / kSpreadSamples;
  sample_lost_ = sample_total_ = 0;
}

double LossMeter::likely() const {
  if (total_ <= 0) return 0;
  const double loss = share();
  return std::min(1.1 * loss + ParitySender::kMinLoss + std::sqrt(loss * (1 - loss) / total_), kWorstLoss);
}

std::size_t ParitySender::wanted(std::size_t source) const {
  if (!known_ || !lossy_) return 0;
  const std::size_t most = std::min(ErasureLayout::kMaxSymbols, source + std::max(kMaxTimes * source, kMaxOfFew));
  // Losses occur in bursts of r = meter_.runs() datagrams. Count each burst as the loss of one longer symbol.
  const auto few = std::max<std::size_t>(std::lround(static_cast<double>(source) / meter_.runs()), 1);
  const std::size_t symbols = symbols_for(few, meter_.likely(), kFailure);
  return std::clamp((symbols * source + few - 1) / few, source, most) - source;
}

std::size_t ParitySender::pending_count() const {
  std::size_t count = 0;
  for (const Group& group : held_) count += group.wanted - group.sent;
  return count;
}

/// Spreads the pending parity evenly over the next `over` data datagrams, so that a burst of losses affects both
/// equally.
void ParitySender::spread(std::size_t over) {
  step_ = static_cast<double>(pending_count()) / static_cast<double>(std::max<std::size_t>(over, 1));
}

void ParitySender::add(std::uint64_t number, std::span<const std::byte> cells, Instant now) {
  if (!on()) return;
  if (!open_.empty() && number - open_.front().first >= kParitySpan) close(now);
  if (open_.empty()) opened_ = now;
  open_.emplace_back(number, symbol_of_cells(cells));
  credit_ = pending() ? credit_ + step_ : 0;
  if (open_.size() >= kMaxMembers || (open_.size() >= kFewMembers && now >= opened_ + kLongestGroup)) close(now);
}

void ParitySender::close(Instant now) {
  if (open_.empty()) return;
  std::size_t size = 0;
  std::bitset<kParitySpan> members;
  for (const auto& [number, symbol] : open_) {
    size = std::max(size, symbol.size());
    members.set(number - open_.front().first);
  }
  std::vector<std::byte> data(size * open_.size());
  for (std::size_t i = 0; i < open_.size(); ++i)
    std::copy(open_[i].second.begin(), open_[i].second.end(), data.begin() + static_cast<std::ptrdiff_t>(i * size));
  const ErasureLayout layout{static_cast<std::uint32_t>(data.size()), static_cast<std::uint16_t>(size),
                             static_cast<std::uint8_t>(open_.size())};
  std::size_t bytes = data.size();
  for (const Group& group : held_) bytes += group.bytes();
  for (; !held_.empty() && (bytes > kMaxHeld || held_.size() >= kMaxGroups); held_.pop_front())
    bytes -= held_.front().bytes();
  const std::uint64_t first = open_.front().first;
  held_.push_back({++closed_, first, members, ErasureEncoder(data, layout), 0, wanted(open_.size()), now});
  spread(open_.size());
  open_.clear();
}

std::uint64_t ParitySender::flush(Instant now) {
  close(now);
  return closed_;
}

void ParitySender::report(std::uint64_t received, std::uint64_t lost, bool quiet, Instant now) {
  if (!enabled_) return;
  meter_.add(received, lost, now);
  const double share = meter_.share();
  lossy_ = share >= (lossy_ ? kMinLoss / 2 : kMinLoss) && (meter_.datagrams() >= kFewDatagrams || quiet);
  known_ = known_ || lossy_ || meter_.datagrams() >= kEnoughDatagrams || quiet;
  if (!on()) {
    open_.clear();
    held_.clear();
    credit_ = step_ = 0;
    return;
  }
  std::erase_if(held_, [&](const Group& group) { return group.sent >= group.wanted && now > group.closed + kHeldFor; });
  bool grown = false;
  for (Group& group : held_) {
    // Ignore a small increase of the measured loss.
    const std::size_t now_wanted = wanted(group.source());
    if (now_wanted <= group.wanted + group.wanted / 4) continue;
    group.wanted = now_wanted;
    grown = true;
  }
  if (grown) spread(held_.back().source());
}

bool ParitySender::settled(std::uint64_t group) const {
  if (!enabled_) return true;
  if (!known_) return false;
  return std::none_of(held_.begin(), held_.end(),
                      [&](const Group& held) { return held.id <= group && held.sent < held.wanted; });
}

std::vector<Cell> ParitySender::next(std::uint64_t number, std::uint32_t time) {
  credit_ = std::max(credit_ - 1, 0.0);
  std::vector<Cell> cells;
  for (Group& group : held_) {
    if (number - group.first > kMaxParityBack) group.wanted = group.sent;  // clients have dropped the group
    if (group.sent >= group.wanted) continue;
    Parity parity;
    parity.symbol = static_cast<std::uint8_t>(group.source() + group.sent++);
    parity.time = time;
    parity.back = static_cast<std::uint32_t>(number - group.first);
    parity.members = group.members;
    (void)segment(encode_parity(parity, group.encoder.symbol(0, parity.symbol)), kParityVc, 0, true, cells);
    break;
  }
  return cells;
}

}  // namespace gs::net
