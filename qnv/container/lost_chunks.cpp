#include "qnv/container/lost_chunks.h"

#include "base/bytes.h"
#include "qnv/container/cauchy_code.h"

#include <algorithm>
#include <utility>

namespace gs::qnv {
namespace {

constexpr std::size_t kPieceHead = 3;  // type and length
// Assumed memory of an entry in a container, and of a member of a group.
constexpr std::size_t kEntryBytes = 96, kMemberBytes = 72;
constexpr std::size_t kMostEnded = std::size_t{1} << 16;

std::size_t parity_head(std::size_t members) { return 2 + 4 * members; }

// FNV-1a over the checksums.
std::uint64_t hash_of(std::span<const std::uint32_t> checksums) {
  std::uint64_t hash = 0xcbf29ce484222325;
  for (const std::uint32_t one : checksums) hash = (hash ^ one) * 0x100000001b3;
  return hash;
}

// Returns the payload in a piece, if it is the chunk with this checksum.
std::optional<std::span<const std::byte>> payload_of(std::span<const std::byte> piece, std::uint32_t checksum) {
  ByteReader in(piece);
  const auto type = static_cast<ChunkType>(in.integer<std::uint8_t>());
  const std::size_t length = in.integer<std::uint16_t>();
  const auto payload = in.bytes(length);
  if (!in.good() || type == ChunkType::parity || is_listing(type) ||
      !is_known(static_cast<std::uint8_t>(type)) || chunk_checksum(type, payload) != checksum)
    return {};
  return payload;
}

}  // namespace

ParityMember parity_member(ChunkType type, std::span<const std::byte> payload) {
  ParityMember member;
  member.checksum = chunk_checksum(type, payload);
  member.piece.reserve(kPieceHead + payload.size());
  ByteWriter out(member.piece);
  out.integer(static_cast<std::uint8_t>(type));
  out.integer(static_cast<std::uint16_t>(payload.size()));
  member.piece.insert(member.piece.end(), payload.begin(), payload.end());
  return member;
}

std::size_t parity_bytes(std::size_t members, std::size_t longest) {
  return parity_head(members) + kPieceHead + longest;
}

std::vector<std::byte> encode_parity(std::span<const ParityMember> members, std::size_t number) {
  std::vector<std::byte> payload;
  ByteWriter out(payload);
  out.integer(static_cast<std::uint8_t>(members.size()));
  out.integer(static_cast<std::uint8_t>(number));
  std::size_t longest = 0;
  for (const ParityMember& member : members) {
    out.integer(member.checksum);
    longest = std::max(longest, member.piece.size());
  }
  const std::size_t head = payload.size();
  payload.resize(head + longest);
  for (std::size_t i = 0; i < members.size(); ++i)
    add_weighted(std::span(payload).subspan(head), cauchy_weight(number, i), members[i].piece);
  return payload;
}

std::optional<ParityPayload> read_parity(std::span<const std::byte> payload) {
  ByteReader in(payload);
  const std::size_t count = in.integer<std::uint8_t>();
  ParityPayload parity;
  parity.number = in.integer<std::uint8_t>();
  if (count < 1 || count > kMaxParityMembers || parity.number < count || in.left() < 4 * count + kPieceHead) return {};
  for (std::size_t i = 0; i < count; ++i) parity.members.push_back(in.integer<std::uint32_t>());
  parity.symbol = in.bytes(in.left());
  return parity;
}

void LostChunks::remember(std::uint32_t checksum, Piece piece) {
  if (!recent_.try_emplace(checksum, piece).second) return;
  order_.push_back(checksum);
  recent_bytes_ += piece->size() + kEntryBytes;
  while (recent_bytes_ > kMostRecent) {
    const auto oldest = recent_.find(order_.front());
    recent_bytes_ -= oldest->second->size() + kEntryBytes;
    recent_.erase(oldest);
    order_.pop_front();
  }
}

// Gives a received chunk to the groups that lack it. Adds groups that can be restored to `ready`.
void LostChunks::arrive(std::uint32_t checksum, const Piece& piece, std::vector<Key>& ready) {
  for (auto next = awaited_.lower_bound({checksum, 0}); next != awaited_.end() && next->first == checksum;) {
    const Key key = next->second;
    next = awaited_.erase(next);
    Group& group = groups_.at(key);
    if (piece->size() > group.symbol) continue;  // another chunk with this checksum
    for (std::size_t i = 0; i < group.members.size(); ++i)
      if (group.members[i] == checksum && !group.pieces[i]) {
        group.pieces[i] = piece;
        --group.missing;
        group.bytes += piece->size();
        group_bytes_ += piece->size();
      }
    if (group.missing <= group.parity.size()) ready.push_back(key);
  }
}

void LostChunks::end(Key key) {
  const auto found = groups_.find(key);
  if (found == groups_.end()) return;
  const Group& group = found->second;
  for (std::size_t i = 0; i < group.members.size(); ++i)
    if (!group.pieces[i]) awaited_.erase({group.members[i], key});
  group_bytes_ -= group.bytes;
  ages_.erase(group.age);
  groups_.erase(found);
  if (!ended_.insert(key).second) return;
  ended_order_.push_back(key);
  if (ended_order_.size() <= kMostEnded) return;
  ended_.erase(ended_order_.front());
  ended_order_.pop_front();
}

// Solves a group, if it is still there, and ends it. Appends the restored chunks.
void LostChunks::restore(Key key, std::vector<Piece>& found, std::vector<std::uint32_t>& checksums) {
  const auto at = groups_.find(key);
  if (at == groups_.end()) return;
  const Group& group = at->second;
  std::vector<std::size_t> missing;
  for (std::size_t i = 0; i < group.members.size(); ++i)
    if (!group.pieces[i]) missing.push_back(i);
  std::vector<CodeEquation> equations;
  for (auto parity = group.parity.begin(); equations.size() < missing.size(); ++parity) {
    CodeEquation& equation = equations.emplace_back();
    for (const std::size_t i : missing) equation.weights.push_back(cauchy_weight(parity->first, i));
    equation.sum = parity->second;
    for (std::size_t i = 0; i < group.members.size(); ++i)
      if (group.pieces[i]) add_weighted(equation.sum, cauchy_weight(parity->first, i), *group.pieces[i]);
  }
  solve_pieces(equations);
  for (std::size_t i = 0; i < missing.size(); ++i) {
    const std::uint32_t checksum = group.members[missing[i]];
    const auto payload = payload_of(equations[i].sum, checksum);
    if (!payload) continue;  // a wrong piece or wrong parity
    equations[i].sum.resize(kPieceHead + payload->size());
    found.push_back(std::make_shared<const std::vector<std::byte>>(std::move(equations[i].sum)));
    checksums.push_back(checksum);
  }
  end(key);
}

// Restores groups. Restored chunks may help other groups.
void LostChunks::solve(std::vector<Key> ready, const Take& take) {
  while (!ready.empty()) {
    const Key key = ready.back();
    ready.pop_back();
    std::vector<Piece> found;
    std::vector<std::uint32_t> checksums;
    restore(key, found, checksums);
    for (std::size_t i = 0; i < found.size(); ++i) {
      ++restored_;
      remember(checksums[i], found[i]);
      arrive(checksums[i], found[i], ready);
      take(static_cast<ChunkType>(found[i]->front()), std::span(*found[i]).subspan(kPieceHead));
    }
  }
}

void LostChunks::keep(ChunkType type, std::span<const std::byte> payload, const Take& take) {
  ParityMember member = parity_member(type, payload);
  if (recent_.contains(member.checksum)) return;
  const auto piece = std::make_shared<const std::vector<std::byte>>(std::move(member.piece));
  remember(member.checksum, piece);
  std::vector<Key> ready;
  arrive(member.checksum, piece, ready);
  solve(std::move(ready), take);
}

bool LostChunks::add(std::span<const std::byte> payload, const Take& take) {
  std::optional<ParityPayload> parity = read_parity(payload);
  if (!parity) return false;
  const Key key = hash_of(parity->members);
  if (ended_.contains(key)) return true;
  const auto [at, fresh] = groups_.try_emplace(key);
  Group& group = at->second;
  if (!fresh && (group.members != parity->members || group.symbol != parity->symbol.size())) return false;
  if (fresh) {
    group.age = next_age_++;
    ages_[group.age] = key;
    group.members = std::move(parity->members);
    group.symbol = parity->symbol.size();
    group.pieces.resize(group.members.size());
    group.bytes = kEntryBytes + kMemberBytes * group.members.size();
    for (std::size_t i = 0; i < group.members.size(); ++i) {
      const auto there = recent_.find(group.members[i]);
      if (there != recent_.end() && there->second->size() <= group.symbol) {
        group.pieces[i] = there->second;
        group.bytes += there->second->size();
      } else {
        ++group.missing;
        awaited_.insert({group.members[i], key});
      }
    }
    group_bytes_ += group.bytes;
  }
  if (group.missing > 0 &&
      group.parity.try_emplace(parity->number, parity->symbol.begin(), parity->symbol.end()).second) {
    group.bytes += group.symbol + kEntryBytes;
    group_bytes_ += group.symbol + kEntryBytes;
  }
  if (group.missing <= group.parity.size())
    solve({key}, take);
  else
    while (group_bytes_ > kMostOfGroups) end(ages_.begin()->second);
  return true;
}

}  // namespace gs::qnv
