#pragma once

#include "qnv/exact/mesh_growth.h"

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace gs::qnv::exact {

// What a tail begins with: FORMAT.md, "Exact tail".
inline constexpr std::size_t kTailHeaderBytes = 11 + 2 * kNear * kSituations;
/// A tail has at most so many triangles a byte; an encoder that needs fewer bytes adds zeros.
inline constexpr std::size_t kMostTrianglesAByte = 64;

[[nodiscard]] std::vector<std::byte> encode_tail_header(const TailHeader& header);
/// Nothing where a field is out of its range, or promises more than the bytes can hold. Safe for untrusted bytes.
[[nodiscard]] std::optional<TailHeader> decode_tail_header(std::span<const std::byte> tail);

}  // namespace gs::qnv::exact
