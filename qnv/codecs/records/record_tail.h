#pragma once

// Handling of the last records of an array, for the SIMD paths of record_paths.h only.

#include "qnv/codecs/records/record_paths.h"

#include <cstddef>
#include <cstdint>
#include <cstring>

namespace gs::qnv::record_paths {

inline Outputs behind(const Outputs& out, std::size_t count) {
  return {out.positions + count, out.normals + count, out.weights + count, out.colors + count};
}

/// Unpacks fewer than kWhole records with `kernel(records, outputs)`, which processes kWhole records at once.
template <std::size_t kWhole, class Kernel>
[[gnu::always_inline]] inline void unpack_tail(const std::byte* records, std::size_t count, const Outputs& out,
                                               const Kernel& kernel) {
  if (count == 0) return;
  std::byte padded[kWhole * kRecordBytes] = {};
  std::memcpy(padded, records, count * kRecordBytes);
  float positions[3 * kWhole], normals[3 * kWhole], weights[kWhole];
  std::uint8_t colors[kWhole];
  kernel(padded, positions, normals, weights, colors);
  std::memcpy(out.positions, positions, count * sizeof(glm::vec3));
  std::memcpy(out.normals, normals, count * sizeof(glm::vec3));
  std::memcpy(out.weights, weights, count * sizeof(float));
  std::memcpy(out.colors, colors, count);
}

}  // namespace gs::qnv::record_paths
