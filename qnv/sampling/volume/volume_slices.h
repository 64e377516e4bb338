#pragma once

#include "qnv/sampling/volume/volume.h"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace gs::qnv {

/// Reason why a volume gives no vectors or triangles, with the expected value.
struct VolumeError {
  std::string message;
};

/// Marks a missing value; test with value != value.
inline constexpr float kMissing = std::numeric_limits<float>::quiet_NaN();

/// Return the number of voxels of a slice and of the volume. Call only for layouts that pass check().
[[nodiscard]] inline std::size_t slice_voxels(const VolumeLayout& layout) {
  return std::size_t{layout.dimensions[0]} * layout.dimensions[1];
}
[[nodiscard]] inline std::uint64_t voxel_count(const VolumeLayout& layout) {
  return std::uint64_t{slice_voxels(layout)} * layout.dimensions[2];
}

/// Returns nullopt if a layout is usable: at least one voxel, at most 2^48 voxels and 2^34 per slice, finite axes that
/// span space, and finite origin, slope and intercept.
[[nodiscard]] std::optional<VolumeError> check(const VolumeLayout& layout);

/// Reports whether voxels may be missing: the type has NaNs, a missing value is defined, or the slope may overflow
/// float.
[[nodiscard]] bool may_miss(const VolumeLayout& layout);

/// Converts stored voxels: stored * slope + intercept, rounded to float. NaNs, infinities, overflows and
/// `layout.missing` become kMissing. `stored` may be unaligned and should hold values.size() voxels; absent ones become
/// kMissing. Safe from any thread.
void values_of(const VolumeLayout& layout, std::span<const std::byte> stored, std::span<float> values);

/// Reads slice z of a valid layout into slice_voxels() values. Returns false if the source fails or z is out of range.
/// `scratch` is a reusable buffer.
[[nodiscard]] bool read_slice(const VolumeSource& source, std::uint32_t z, std::vector<std::byte>& scratch,
                              std::span<float> values);

}  // namespace gs::qnv
