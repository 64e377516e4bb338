#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

namespace gs::qnv::exact {

/// Maximum length of a tail.
inline constexpr std::size_t kMaxTailBytes = std::size_t{1} << 28;

/// Bytes per piece. pieces_of() cuts a tail into chunk payloads.
inline constexpr std::size_t kTailPieceBytes = 16384;
[[nodiscard]] std::vector<std::vector<std::byte>> pieces_of(std::span<const std::byte> tail,
                                                            std::size_t bytes = kTailPieceBytes);

/// Received pieces of a tail, in any order; duplicates are allowed. Safe for untrusted bytes; holds no more than was
/// received.
class TailPieces {
 public:
  /// Adds the payload of a chunk. Returns false if it is invalid, belongs to another tail or overlaps other pieces.
  bool add(std::span<const std::byte> payload);
  /// Returns the bytes received; length() returns the total, or 0 if unknown.
  [[nodiscard]] std::size_t come() const { return come_; }
  [[nodiscard]] std::size_t length() const { return length_; }
  /// Returns the bytes that now extend the prefix returned so far.
  [[nodiscard]] std::vector<std::byte> next();
  /// Returns the whole tail once it was received, and releases the memory.
  [[nodiscard]] std::optional<std::vector<std::byte>> take();

 private:
  std::size_t length_ = 0, come_ = 0, given_ = 0;
  std::map<std::size_t, std::vector<std::byte>> pieces_;  // by offset
};

}  // namespace gs::qnv::exact
