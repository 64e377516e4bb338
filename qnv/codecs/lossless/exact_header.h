#pragma once

#include "qnv/codecs/lossless/tail_header.h"

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace gs::qnv::exact {

// Header of a tail: FORMAT.md, "Exact tail".
inline constexpr std::size_t kTailFixedBytes = 11, kTailWeightsBytes = 2 * kNear * kSituations,
                             kTextureLatticeBytes = 17;
/// Default weights of parallelogram predictions: across the gate. With two new triangles, also across the side after
/// the gate.
inline constexpr Weights kUsualWeights = [] {
  constexpr std::int16_t kOne = 1 << kWeightBits, kHalf = kOne / 2;
  Weights weights{};
  for (std::size_t s = 0; s < kSituations; ++s) {
    if (s < 2)
      weights[s] = {kHalf, -kHalf, kHalf, -kHalf};
    else
      weights[s] = {kOne, -kOne};
  }
  return weights;
}();
/// Maximum number of triangles per byte of a tail. Encoders add zero bytes if needed.
inline constexpr std::size_t kMaxTrianglesAByte = 64;

[[nodiscard]] std::vector<std::byte> encode_tail_header(const TailHeader& header);
/// Decodes the header of a tail. `tail` is a prefix of a tail with `length` bytes. Returns nullopt if a field is out of
/// range, or if `length` bytes cannot contain the promised mesh. Safe for untrusted bytes.
[[nodiscard]] std::optional<TailHeader> decode_tail_header(std::span<const std::byte> tail, std::size_t length);
/// Returns the length of the header at the start of `tail`; 0 if `tail` is too short to decide.
[[nodiscard]] std::size_t tail_header_bytes(std::span<const std::byte> tail);

}  // namespace gs::qnv::exact
