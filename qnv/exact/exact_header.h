#pragma once

#include "qnv/exact/mesh_growth.h"

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace gs::qnv::exact {

// What a tail begins with: FORMAT.md, "Exact tail".
inline constexpr std::size_t kTailFixedBytes = 11, kTailWeightsBytes = 2 * kNear * kSituations,
                             kTextureLatticeBytes = 17;
/// Parallelograms: beside the gate, and where two triangles are new, beside the one behind it as well.
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
/// A tail has at most so many triangles a byte; an encoder that needs fewer bytes adds zeros.
inline constexpr std::size_t kMostTrianglesAByte = 64;

[[nodiscard]] std::vector<std::byte> encode_tail_header(const TailHeader& header);
/// Nothing where a field is out of its range, or promises more than the bytes can hold. Safe for untrusted bytes.
/// `length`: of the whole tail, of which these bytes are the first.
[[nodiscard]] std::optional<TailHeader> decode_tail_header(std::span<const std::byte> tail, std::size_t length);
/// Bytes of the header that begins with these; 0: more are needed to tell.
[[nodiscard]] std::size_t tail_header_bytes(std::span<const std::byte> tail);

}  // namespace gs::qnv::exact
