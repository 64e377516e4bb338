#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace gs::qnv::exact {

/// Behind which part of a tail's triangles each patch of a stage is no longer needed: what it stands for is there.
struct Cover {
  int stage = 0;                      // 0 to 15
  int parts = 1;                      // 1 to 255, into which the triangles are divided
  std::uint32_t triangles = 0;        // of the whole tail
  std::vector<std::uint8_t> patches;  // 0 to `parts`: so many of them

  /// Whether a patch is covered by the first triangles.
  [[nodiscard]] bool covered(std::size_t patch, std::size_t come) const {
    return std::uint64_t{come} * static_cast<std::uint64_t>(parts) >= std::uint64_t{triangles} * patches[patch];
  }
};

/// The payload of a chunk.
[[nodiscard]] std::vector<std::byte> encode_cover(const Cover& cover);
/// Nothing where it is none. Safe for untrusted bytes.
[[nodiscard]] std::optional<Cover> decode_cover(std::span<const std::byte> payload);

}  // namespace gs::qnv::exact
