#pragma once

#include "qnv/stream/container.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

namespace gs::qnv {

/// A group is cut into so many pieces at most, of so many bytes each.
inline constexpr std::size_t kMostPieces = 128, kMostPieceBytes = 4096, kMostGroupBytes = kMostPieces * kMostPieceBytes;

/// Payloads of chunks that are of little use one without the other (a base, and the clusters without which it is not
/// shown) as pieces, none larger than a datagram. As many as `data` bring all of them back, whichever they are.
struct CutGroup {
  std::vector<std::vector<std::byte>> data, parity;  // payloads of chunks
};
/// `number`: 0 to kMostGroup; the payloads with their lengths: at most kMostGroupBytes. `parity`: so many pieces more,
/// as a part of the others, and so many besides. `aimed`: bytes of a piece, about.
inline constexpr std::size_t kAimedPieceBytes = 1150;
[[nodiscard]] CutGroup cut_group(int number, std::span<const std::vector<std::byte>> payloads, double parity,
                                 std::size_t besides, std::size_t aimed = kAimedPieceBytes);

/// From these numbers on groups hold pieces of exact tails, splits, low bits, pictures, and normals; before them what
/// chunks of displaced streams hold.
inline constexpr int kGroupsOfTails = 16, kGroupsOfSplits = 32, kGroupsOfLowBits = 48, kGroupsOfPictures = 64,
                     kGroupsOfNormals = 80, kMostGroup = 95;
[[nodiscard]] constexpr ChunkType type_of_group(int number) {
  return number < kGroupsOfTails      ? ChunkType::displaced
         : number < kGroupsOfSplits   ? ChunkType::exact
         : number < kGroupsOfLowBits  ? ChunkType::splits
         : number < kGroupsOfPictures ? ChunkType::low_bits
         : number < kGroupsOfNormals  ? ChunkType::picture
                                      : ChunkType::normals;
}

/// What a piece says of itself.
struct PieceHeader {
  int group = 0;
  std::size_t length = 0;  // of the group, bytes
  std::size_t needed = 1;  // pieces that bring it back; as many are its own bytes
  std::size_t number = 0;  // of this one; from `needed` on: parity
  [[nodiscard]] std::size_t size() const { return (length + needed - 1) / needed; }  // of each piece
};
/// Nothing where a field is out of its range, or there are not so many bytes. Safe for untrusted bytes.
[[nodiscard]] std::optional<PieceHeader> read_piece_header(std::span<const std::byte> payload);

/// The pieces of one group as they come, in any order, also more than once. Safe for untrusted bytes; holds no more
/// than what came.
class PieceGroup {
 public:
  /// False where it is no piece of what came first.
  bool add(const PieceHeader& header, std::span<const std::byte> payload);
  /// The next payloads of which all has come, each once: those at the front, and as soon as there are enough pieces,
  /// all.
  [[nodiscard]] std::vector<std::vector<std::byte>> take();

 private:
  void restore();

  std::size_t length_ = 0, needed_ = 0, joined_ = 0;  // joined_: pieces that are in front_
  std::size_t read_ = 0;                              // bytes of front_ that were taken
  std::vector<std::byte> front_;
  std::map<std::size_t, std::vector<std::byte>> pieces_;  // by number, those that are not in front_
};

}  // namespace gs::qnv
