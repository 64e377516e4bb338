#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace gs::qnv::exact {

/// Table of covered patches. For each patch of a stage, states how many of the tail's triangles must be received before
/// they cover the patch.
struct Cover {
  int stage = 0;                      // 0 to 15
  int parts = 1;  // 1 to 255; the triangles are divided into this number of equal parts
  std::uint32_t triangles = 0;  // number in the whole tail
  std::vector<std::uint8_t> patches;  // for each patch: the parts to receive, 0 to `parts`

  /// Reports whether the first `come` triangles of the tail cover a patch.
  [[nodiscard]] bool covered(std::size_t patch, std::size_t come) const {
    return std::uint64_t{come} * static_cast<std::uint64_t>(parts) >= std::uint64_t{triangles} * patches[patch];
  }
};

/// Returns the payload of a cover chunk.
[[nodiscard]] std::vector<std::byte> encode_cover(const Cover& cover);
/// Decodes the payload of a cover chunk. Returns nullopt if it is invalid. Safe for untrusted bytes.
[[nodiscard]] std::optional<Cover> decode_cover(std::span<const std::byte> payload);

}  // namespace gs::qnv::exact
