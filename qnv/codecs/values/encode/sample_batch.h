#pragma once

#include "qnv/codecs/shared/encode_options.h"
#include "qnv/codecs/shared/ranks.h"
#include "qnv/codecs/values/cube_runs.h"
#include "qnv/codecs/values/slices/level_slices.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

namespace gs::qnv::values {

/// Number of slices that encoders read at once: a multiple of kCubeEdge and of the cubes of GapFilling.
inline constexpr std::uint32_t kBatchSlices = 8;

/// Returns the range of slabs of a volume that a rank encodes.
[[nodiscard]] inline RankShare slabs_of(const Ranks& ranks, std::uint32_t depth) {
  return share_of(ranks, depth / kSlabSlices + (depth % kSlabSlices != 0 ? 1 : 0));
}
/// Returns the range of slices in a range of slabs.
[[nodiscard]] inline SliceWindow slices_of(RankShare slabs, std::uint32_t depth) {
  const auto slice = [&](std::uint64_t slab) {
    return static_cast<std::uint32_t>(std::min<std::uint64_t>(depth, slab * kSlabSlices));
  };
  return {slice(slabs.first), slice(slabs.end)};
}

/// Some consecutive slices of a volume.
struct SampleBatch {
  std::uint32_t first = 0, count = 0;
  std::vector<std::int32_t> samples;
  std::vector<std::uint8_t> missing;  // 1 for missing voxels; empty if the volume has none
  std::vector<std::uint32_t> codes;   // of stored voxels, if wanted
};

/// Function that reads the samples of slices `first` to `first + count - 1`. Each call gives the same samples. Returns
/// an error on failure.
using ReadSamples =
    std::function<std::optional<EncodeError>(std::uint32_t first, std::uint32_t count, SampleBatch& batch)>;

}  // namespace gs::qnv::values
