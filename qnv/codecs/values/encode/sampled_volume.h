#pragma once

#include "qnv/codecs/shared/encode_options.h"
#include "qnv/container/value_grid.h"
#include "qnv/sampling/volume/volume.h"

#include <cstdint>
#include <utility>
#include <variant>
#include <vector>

namespace gs::qnv::values {

/// Volume as integers, for the transform.
struct SampledVolume {
  ValueGrid grid;                     // without errors
  std::vector<std::int32_t> samples;  // missing voxels are filled smoothly
  std::vector<std::uint8_t> missing;  // 1 for missing voxels; empty if there are none
  std::vector<std::uint32_t> codes;   // of the stored voxels, if `grid.exact`
  std::uint32_t most_error = 0;       // permitted for the samples of a stream
  float rounding = 0;                 // maximum error of the samples themselves, in the unit of the values
  std::pair<float, float> value_range{0, 0};
};

/// Reads a volume twice, slice by slice, and converts it. Float numbers become multiples of a power of two that suits
/// the permitted error. Returns an error if the source fails, for a volume without values or with too many voxels, or
/// if cancelled. Safe for untrusted values.
[[nodiscard]] std::variant<SampledVolume, EncodeError> sample_volume(const VolumeSource& source,
                                                                     const ValueTolerance& tolerance,
                                                                     Progress* progress);

/// Replaces the samples of missing voxels by means of their neighbours, from near to far.
void fill_gaps(std::vector<std::int32_t>& samples, const std::vector<std::uint8_t>& missing,
               const std::array<std::uint32_t, 3>& dimensions);

}  // namespace gs::qnv::values
