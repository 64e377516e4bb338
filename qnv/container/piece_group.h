#pragma once

#include "qnv/container/container.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <vector>

namespace gs::qnv {

/// Maximum number of pieces of a group, maximum bytes of a piece, and maximum bytes of a group.
inline constexpr std::size_t kMaxPieces = 128, kMaxPieceBytes = 4096, kMaxGroupBytes = kMaxPieces * kMaxPieceBytes;

/// Group of chunk payloads that depend on each other, such as a base mesh and the clusters that it needs. The group is
/// cut into pieces that fit into a datagram. Any `data.size()` pieces out of `data` and `parity` restore the group.
struct CutGroup {
  std::vector<std::vector<std::byte>> data, parity;  // payloads of chunks of type `piece`
};
/// Target size of a piece, in bytes.
inline constexpr std::size_t kAimedPieceBytes = 1150;
[[nodiscard]] CutGroup cut_group(int number, std::span<const std::vector<std::byte>> payloads, double parity,
                                 std::size_t besides, std::size_t aimed = kAimedPieceBytes);

/// First numbers of the groups with pieces of exact tails, splits, low bits, pictures and normals. Groups with smaller
/// numbers contain chunks of type `displaced`.
inline constexpr int kGroupsOfTails = 16, kGroupsOfSplits = 32, kGroupsOfLowBits = 48, kGroupsOfPictures = 64,
                     kGroupsOfNormals = 80, kMaxGroup = 95;
[[nodiscard]] constexpr ChunkType type_of_group(int number) {
  return number < kGroupsOfTails      ? ChunkType::displaced
         : number < kGroupsOfSplits   ? ChunkType::exact
         : number < kGroupsOfLowBits  ? ChunkType::splits
         : number < kGroupsOfPictures ? ChunkType::low_bits
         : number < kGroupsOfNormals  ? ChunkType::picture
                                      : ChunkType::normals;
}

/// Header of a piece.
struct PieceHeader {
  int group = 0;
  std::size_t length = 0;  // size of the group, in bytes
  std::size_t needed = 1;  // number of data pieces; any such number of pieces restores the group
  std::size_t number = 0;  // index of this piece; `needed` and above are parity pieces
  [[nodiscard]] std::size_t size() const { return (length + needed - 1) / needed; }  // size of each piece, in bytes
};
/// Reads the header of a piece. Returns nullopt if a field is out of range or the payload is too short. Safe for
/// untrusted bytes.
[[nodiscard]] std::optional<PieceHeader> read_piece_header(std::span<const std::byte> payload);

/// Received pieces of one group. They may be received in any order and repeatedly. Safe for untrusted bytes; holds no
/// more than the received bytes.
class PieceGroup {
 public:
  /// Adds a piece. Returns false if it does not match the first piece of the group.
  bool add(const PieceHeader& header, std::span<const std::byte> payload);
  /// Returns the payloads that became complete since the last call: those at the front of the group, or all if enough
  /// pieces are received.
  [[nodiscard]] std::vector<std::vector<std::byte>> take();

 private:
  void restore();

  std::size_t length_ = 0, needed_ = 0, joined_ = 0;  // joined_: number of pieces already in front_
  std::size_t read_ = 0;  // number of bytes of front_ that take() has returned
  std::vector<std::byte> front_;
  std::map<std::size_t, std::vector<std::byte>> pieces_;  // pieces by index, except those in front_
};

/// Received pieces of all groups of a stream. Safe for untrusted bytes; holds no more than the received bytes.
class PieceGroups {
 public:
  using Take = std::function<void(ChunkType type, std::span<const std::byte> payload)>;
  /// Adds the payload of a `piece` chunk. Passes each chunk payload that is now complete to `take`. Returns false if
  /// the piece is invalid or does not match its group.
  bool add(std::span<const std::byte> payload, const Take& take);

 private:
  std::map<int, PieceGroup> groups_;
};

}  // namespace gs::qnv
