#pragma once

#include "qnv/base/geometry.h"
#include "tests/fuzz/fuzz_target.h"

namespace gs::fuzz {

/// Maximum number of vectors that the targets decode.
inline constexpr std::size_t kMaxVectors = 1 << 18;

/// Returns a stream with correct checksums, so that readers reach its chunks.
[[nodiscard]] std::vector<std::uint8_t> with_checksums(std::span<const std::byte> bytes);
/// Requires arrays of equal lengths, indices within their arrays, and finite numbers.
void check_sound(const qnv::Geometry& geometry);

[[nodiscard]] bool run_gaussians(std::span<const std::byte> bytes);

}  // namespace gs::fuzz
