#include "qnv/codecs/shared/parity_writer.h"

#include "qnv/container/cauchy_code.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace gs::qnv {
namespace {

// First and maximum number of chunks in a group. Each group has twice as many as the previous one, up to the maximum.
// Larger groups of equal protection need less parity, but each parity chunk states the checksums of all members.
constexpr std::size_t kFirstUnequal = 4, kMostUnequal = 32, kFirstEqual = 8, kMostEqual = 64;
// Probability that a group of equal protection is not restored. A coarse group matters to the whole volume.
constexpr double kFailure = 0.001;
// Loss at which unequal protection minimises the error, and weight of this loss relative to no loss. Parity is written
// if its use, multiplied by the weight, exceeds the gain of the next chunks.
constexpr double kLikelyLoss = 0.1, kWeightOfLoss = 0.02;
// Parity that unequal protection may always have, in bytes.
constexpr double kFreeParity = 1500;
constexpr std::size_t kMostAtOnce = 40;
// Parity bytes per byte of protected chunks exceed the ratio of their numbers by this factor: a parity chunk has the
// size of the longest member, and a head.
constexpr double kParityFactor = 1.4;
// Longer payloads are not protected: with the head of a parity chunk they could exceed a chunk.
constexpr std::size_t kMostProtected = 60'000;

// Calls `each` with the probabilities of 0, 1, ... losses of `count` chunks, until it returns false.
template <class Each>
void binomial(std::size_t count, double loss, Each&& each) {
  double probability = std::pow(1 - loss, static_cast<double>(count));
  for (std::size_t lost = 0; lost <= count; ++lost) {
    if (!each(lost, probability)) return;
    probability *= static_cast<double>(count - lost) / static_cast<double>(lost + 1) * loss / (1 - loss);
  }
}

// Returns the probability that a member of a group is lost and not restored: it and at least `parity` others are lost.
double lost_share(std::size_t members, std::size_t parity) {
  double restored = 0;
  binomial(members + parity - 1, kLikelyLoss, [&](std::size_t lost, double probability) {
    if (lost >= parity) return false;
    restored += probability;
    return true;
  });
  return kLikelyLoss * std::max(0.0, 1 - restored);
}

std::size_t most_parity(std::size_t members) { return kMaxCodedPieces - members; }

}  // namespace

std::size_t parity_for(std::size_t members, double loss) {
  if (!(loss > 0)) return 0;
  loss = std::min(loss, kMostLoss);
  for (std::size_t parity = 0; parity < most_parity(members); ++parity) {
    double restored = 0;
    binomial(members + parity, loss, [&](std::size_t lost, double probability) {
      if (lost > parity) return false;
      restored += probability;
      return true;
    });
    if (1 - restored < kFailure) return parity;
  }
  return most_parity(members);
}

double parity_share(const Protection& protection) {
  switch (protection.kind) {
    case Protection::Kind::none:
      return 0;
    case Protection::Kind::unequal:
      return kUnequalShare;
    case Protection::Kind::equal:
      return kParityFactor * static_cast<double>(parity_for(kMostEqual, protection.loss)) /
             static_cast<double>(kMostEqual);
  }
  return 0;
}

void ParityWriter::send(Group& group, std::size_t count, std::vector<std::vector<std::byte>>& out) {
  for (std::size_t i = 0; i < count; ++i) {
    out.push_back(encode_parity(group.members, group.members.size() + group.sent++));
    const std::size_t bytes = kChunkHeaderBytes + out.back().size();
    offset_ += bytes;
    parity_ += bytes;
  }
}

// Finds the number of further parity chunks with the largest use per byte. Too few chunks rarely restore anything, so
// that a larger number can be more useful per byte.
void ParityWriter::find_use(Group& group) const {
  const std::size_t members = group.members.size(), room = most_parity(members) - group.sent;
  const double before = lost_share(members, group.sent);
  group.use = 0;
  group.next = 0;
  for (std::size_t more = 1; more <= std::min(room, kMostAtOnce); ++more) {
    const double use = (before - lost_share(members, group.sent + more)) / static_cast<double>(more * group.bytes);
    if (use <= group.use) continue;
    group.use = use;
    group.next = more;
  }
}

// Writes the most useful parity of all groups within reach, as long as it is worth more than further chunks.
void ParityWriter::protect_best(double slope, std::vector<std::vector<std::byte>>& out) {
  while (!groups_.empty()) {
    Group& best = *std::ranges::max_element(groups_, {}, [](const Group& group) { return group.use * group.gain; });
    if (best.next == 0 || kWeightOfLoss * best.use * best.gain <= slope) return;
    const auto bytes = static_cast<double>(best.next * best.bytes);
    if (static_cast<double>(parity_) + bytes > kFreeParity + kUnequalShare * static_cast<double>(offset_)) return;
    send(best, best.next, out);
    find_use(best);
  }
}

void ParityWriter::close_group(std::vector<std::vector<std::byte>>& out) {
  if (open_.members.empty()) return;
  Group group = std::exchange(open_, {});
  std::size_t longest = 0;
  for (const ParityMember& member : group.members) longest = std::max(longest, member.piece.size());
  group.bytes = kChunkHeaderBytes + parity_bytes(group.members.size(), longest);
  if (protection_.kind == Protection::Kind::equal) {
    send(group, parity_for(group.members.size(), protection_.loss), out);
    ++first_;
    return;
  }
  find_use(group);
  group.gain = open_gain_;
  groups_.push_back(std::move(group));
  const std::uint64_t number = first_ + groups_.size() - 1;
  for (const std::uint32_t chain : open_chains_) chains_[chain].push_back(number);
  open_chains_.clear();
  protect_best(open_gain_ / static_cast<double>(std::max<std::uint64_t>(open_bytes_, 1)), out);
  open_gain_ = 0;
  open_bytes_ = 0;
}

std::vector<std::vector<std::byte>> ParityWriter::add(const OutgoingChunk& chunk) {
  std::vector<std::vector<std::byte>> out;
  if (protection_.kind == Protection::Kind::none) return out;
  if (protection_.kind == Protection::Kind::equal && !(protection_.loss > 0)) return out;
  const std::size_t bytes = kChunkHeaderBytes + chunk.payload.size();
  if (chunk.payload.size() > kMostProtected) {
    offset_ += bytes;
    return out;
  }
  if (open_.members.empty()) open_.start = offset_;
  open_.members.push_back(parity_member(chunk.type, chunk.payload));
  offset_ += bytes;
  if (protection_.kind == Protection::Kind::unequal) {
    while (!groups_.empty() && offset_ - groups_.front().start > kParityReach) {
      groups_.pop_front();
      ++first_;
    }
    open_gain_ += chunk.gain;
    open_bytes_ += bytes;
    if (chunk.chain != OutgoingChunk::kNoChain) {
      std::vector<std::uint64_t>& before = chains_[chunk.chain];
      std::erase_if(before, [&](std::uint64_t number) { return number < first_; });
      for (const std::uint64_t number : before) groups_[static_cast<std::size_t>(number - first_)].gain += chunk.gain;
      if (!std::ranges::count(open_chains_, chunk.chain)) open_chains_.push_back(chunk.chain);
    }
  }
  const std::size_t closed = static_cast<std::size_t>(first_) + groups_.size();
  const bool equal = protection_.kind == Protection::Kind::equal;
  const std::size_t first = equal ? kFirstEqual : kFirstUnequal, most = equal ? kMostEqual : kMostUnequal;
  if (open_.members.size() >= (closed < 8 ? std::min(most, first << closed) : most)) close_group(out);
  return out;
}

std::vector<std::vector<std::byte>> ParityWriter::finish() {
  std::vector<std::vector<std::byte>> out;
  close_group(out);
  if (protection_.kind == Protection::Kind::unequal) protect_best(0, out);
  return out;
}

}  // namespace gs::qnv
