#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace gs::qnv::exact {

/// Table of covered patches: for each patch of a stage, the part of the tail's triangles after which the patch is no
/// longer needed.
struct Cover {
  int stage = 0;                      // 0 to 15
  int parts = 1;                      // 1 to 255; number of equal parts of the triangles
  std::uint32_t triangles = 0;        // of the whole tail
  std::vector<std::uint8_t> patches;  // 0 to `parts`, for each patch

  /// Reports whether the first `come` triangles cover a patch.
  [[nodiscard]] bool covered(std::size_t patch, std::size_t come) const {
    return std::uint64_t{come} * static_cast<std::uint64_t>(parts) >= std::uint64_t{triangles} * patches[patch];
  }
};

/// Returns the payload of a chunk.
[[nodiscard]] std::vector<std::byte> encode_cover(const Cover& cover);
/// Returns nullopt if the payload is invalid. Safe for untrusted bytes.
[[nodiscard]] std::optional<Cover> decode_cover(std::span<const std::byte> payload);

}  // namespace gs::qnv::exact
