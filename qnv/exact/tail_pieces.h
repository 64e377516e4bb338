#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

namespace gs::qnv::exact {

/// More than this no tail has.
inline constexpr std::size_t kMostTailBytes = std::size_t{1} << 28;

/// A tail, cut into the payloads of chunks, of so many bytes of it each.
inline constexpr std::size_t kTailPieceBytes = 16384;
[[nodiscard]] std::vector<std::vector<std::byte>> pieces_of(std::span<const std::byte> tail,
                                                            std::size_t bytes = kTailPieceBytes);

/// The pieces of a tail as they come, in any order, also more than once. Safe for untrusted bytes; holds no more than
/// what came.
class TailPieces {
 public:
  /// The payload of a chunk. False where it is none, is no piece of the same tail, or overlaps others.
  bool add(std::span<const std::byte> payload);
  /// How many bytes of it have come, and how many there are; 0: that is not known yet.
  [[nodiscard]] std::size_t come() const { return come_; }
  [[nodiscard]] std::size_t length() const { return length_; }
  /// What has come in one piece with what was given before, from the front on.
  [[nodiscard]] std::vector<std::byte> next();
  /// All of it, once it has come; then nothing is held any more.
  [[nodiscard]] std::optional<std::vector<std::byte>> take();

 private:
  std::size_t length_ = 0, come_ = 0, given_ = 0;
  std::map<std::size_t, std::vector<std::byte>> pieces_;  // by where they begin
};

}  // namespace gs::qnv::exact
