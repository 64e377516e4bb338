#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

namespace gs::qnv::exact {

/// Maximum length of a tail, in bytes.
inline constexpr std::size_t kMaxTailBytes = std::size_t{1} << 28;

/// Maximum bytes of the tail in one chunk payload; pieces_of() cuts a tail into such pieces.
inline constexpr std::size_t kTailPieceBytes = 16384;
[[nodiscard]] std::vector<std::vector<std::byte>> pieces_of(std::span<const std::byte> tail,
                                                            std::size_t bytes = kTailPieceBytes);

/// Received pieces of a tail. They may be received in any order and repeatedly. Safe for untrusted bytes; holds no more
/// than the received bytes.
class TailPieces {
 public:
  /// Adds the payload of a tail chunk. Returns false if it is invalid, belongs to another tail or overlaps other
  /// pieces.
  bool add(std::span<const std::byte> payload);
  /// Returns the number of bytes received. length() returns the total, or 0 until a piece is received.
  [[nodiscard]] std::size_t come() const { return come_; }
  [[nodiscard]] std::size_t length() const { return length_; }
  /// Returns the bytes that follow the results of earlier calls; empty if the next byte is missing.
  [[nodiscard]] std::vector<std::byte> next();
  /// Returns the whole tail and releases its memory. Returns nullopt until all of it is received.
  [[nodiscard]] std::optional<std::vector<std::byte>> take();

 private:
  std::size_t length_ = 0, come_ = 0, given_ = 0;
  std::map<std::size_t, std::vector<std::byte>> pieces_;  // received bytes, by offset in the tail
};

}  // namespace gs::qnv::exact
