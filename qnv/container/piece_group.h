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

/// Maximum number of pieces of a group, and bytes of each.
inline constexpr std::size_t kMaxPieces = 128, kMaxPieceBytes = 4096, kMaxGroupBytes = kMaxPieces * kMaxPieceBytes;

/// Chunk payloads that depend on each other (a base, and the clusters needed to show it), cut into pieces of at most a
/// datagram. Any `data.size()` of all the pieces restore the group.
struct CutGroup {
  std::vector<std::vector<std::byte>> data, parity;  // chunk payloads
};
/// Cuts payloads into a group. `number` is 0 to kMaxGroup. The payloads with their lengths have at most
/// kMaxGroupBytes bytes. `parity` is the number of parity pieces relative to the data pieces; `besides` are added to
/// it. `aimed` is the approximate size of a piece.
inline constexpr std::size_t kAimedPieceBytes = 1150;
[[nodiscard]] CutGroup cut_group(int number, std::span<const std::vector<std::byte>> payloads, double parity,
                                 std::size_t besides, std::size_t aimed = kAimedPieceBytes);

/// First numbers of the groups that hold pieces of exact tails, splits, low bits, pictures and normals. Smaller numbers
/// hold chunks of type `displaced`.
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
  std::size_t length = 0;  // of the group, in bytes
  std::size_t needed = 1;  // number of pieces that restore the group; as many hold its own bytes
  std::size_t number = 0;  // number of this piece; parity from `needed` on
  [[nodiscard]] std::size_t size() const { return (length + needed - 1) / needed; }  // of each piece
};
/// Returns nullopt if a field is out of range or the payload is too short. Safe for untrusted bytes.
[[nodiscard]] std::optional<PieceHeader> read_piece_header(std::span<const std::byte> payload);

/// Received pieces of one group, in any order; duplicates are allowed. Safe for untrusted bytes; holds no more than was
/// received.
class PieceGroup {
 public:
  /// Adds a piece. Returns false if it does not match the first piece.
  bool add(const PieceHeader& header, std::span<const std::byte> payload);
  /// Returns the next complete payloads, each once: those at the front, and all of them once enough pieces are
  /// received.
  [[nodiscard]] std::vector<std::vector<std::byte>> take();

 private:
  void restore();

  std::size_t length_ = 0, needed_ = 0, joined_ = 0;  // joined_: pieces already in front_
  std::size_t read_ = 0;                              // bytes of front_ already taken
  std::vector<std::byte> front_;
  std::map<std::size_t, std::vector<std::byte>> pieces_;  // by number; those not in front_
};

/// All groups of a stream. Safe for untrusted bytes; holds no more than was received.
class PieceGroups {
 public:
  using Take = std::function<void(ChunkType type, std::span<const std::byte> payload)>;
  /// Adds the payload of a chunk of pieces, and passes each chunk payload that is now complete to `take`. Returns false
  /// if the piece is invalid or does not match its group.
  bool add(std::span<const std::byte> payload, const Take& take);

 private:
  std::map<int, PieceGroup> groups_;
};

}  // namespace gs::qnv
