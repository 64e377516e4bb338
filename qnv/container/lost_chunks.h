#pragma once

#include "qnv/container/container.h"

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <vector>

namespace gs::qnv {

// Parity over whole chunks of a stream. FORMAT.md, "Parity", defines the bytes.

/// Maximum number of chunks that one parity chunk protects.
inline constexpr std::size_t kMaxParityMembers = 128;
/// Maximum bytes of the stream between the start of a group and its first parity chunk. Readers remember more.
inline constexpr std::size_t kParityReach = std::size_t{8} << 20;

/// Chunk of a group: its checksum, and its type, length and payload as one piece of the code.
struct ParityMember {
  std::uint32_t checksum = 0;
  std::vector<std::byte> piece;
};
[[nodiscard]] ParityMember parity_member(ChunkType type, std::span<const std::byte> payload);

/// Returns the size of a parity payload for a number of chunks, of which the longest payload has `longest` bytes.
[[nodiscard]] std::size_t parity_bytes(std::size_t members, std::size_t longest);
/// Encodes the payload of parity chunk `number` of a group. The group has 1 to kMaxParityMembers members. `number` is
/// at least their number, and below kMaxCodedPieces.
[[nodiscard]] std::vector<std::byte> encode_parity(std::span<const ParityMember> members, std::size_t number);

/// Payload of a parity chunk.
struct ParityPayload {
  std::size_t number = 0;
  std::vector<std::uint32_t> members;  // checksums
  std::span<const std::byte> symbol;
};
/// Returns nullopt if a field is out of range or the payload is too short. Safe for untrusted bytes.
[[nodiscard]] std::optional<ParityPayload> read_parity(std::span<const std::byte> payload);

/// Restores lost chunks. Chunks and parity may be received in any order, repeatedly and in any subset. Safe for
/// untrusted bytes. Memory is bounded: it forgets the oldest chunks and groups. One thread at a time.
class LostChunks {
 public:
  using Take = std::function<void(ChunkType type, std::span<const std::byte> payload)>;

  /// Remembers a received chunk, and passes on the chunks that it helps to restore.
  void keep(ChunkType type, std::span<const std::byte> payload, const Take& take);
  /// Adds the payload of a parity chunk, and passes on the chunks that it restores. Returns false if it is invalid.
  bool add(std::span<const std::byte> payload, const Take& take);
  /// Returns the number of restored chunks.
  [[nodiscard]] std::size_t restored() const { return restored_; }
  /// Returns the bytes in memory: of remembered chunks and of groups.
  [[nodiscard]] std::size_t bytes() const { return recent_bytes_ + group_bytes_; }

  /// Maximum of bytes() for chunks, and for groups.
  static constexpr std::size_t kMostRecent = std::size_t{16} << 20, kMostOfGroups = std::size_t{32} << 20;

 private:
  using Piece = std::shared_ptr<const std::vector<std::byte>>;
  using Key = std::uint64_t;  // hash of the checksums of a group
  /// Group with lost chunks.
  struct Group {
    std::vector<std::uint32_t> members;  // checksums
    std::vector<Piece> pieces;           // received ones; null for missing ones
    std::size_t missing = 0, symbol = 0, bytes = 0;
    std::map<std::size_t, std::vector<std::byte>> parity;  // by number
    std::uint64_t age = 0;
  };
  void remember(std::uint32_t checksum, Piece piece);
  void arrive(std::uint32_t checksum, const Piece& piece, std::vector<Key>& ready);
  void restore(Key key, std::vector<Piece>& found, std::vector<std::uint32_t>& checksums);
  void solve(std::vector<Key> ready, const Take& take);
  void end(Key key);

  std::map<std::uint32_t, Piece> recent_;  // by checksum
  std::deque<std::uint32_t> order_;        // of recent_, the oldest first
  std::map<Key, Group> groups_;
  std::map<std::uint64_t, Key> ages_;
  std::set<std::pair<std::uint32_t, Key>> awaited_;  // missing members of groups
  std::set<Key> ended_;                              // groups that need no further parity
  std::deque<Key> ended_order_;
  std::size_t recent_bytes_ = 0, group_bytes_ = 0, restored_ = 0;
  std::uint64_t next_age_ = 0;
};

}  // namespace gs::qnv
