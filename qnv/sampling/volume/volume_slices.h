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

/// Reason why a volume gives no vectors or triangles, and the expected value.
struct VolumeError {
  std::string message;
};

/// Value that marks a missing voxel. Test with value != value.
inline constexpr float kMissing = std::numeric_limits<float>::quiet_NaN();

/// Returns the number of voxels of a slice; the next function returns that of the volume. The layout must pass check().
[[nodiscard]] inline std::size_t slice_voxels(const VolumeLayout& layout) {
  return std::size_t{layout.dimensions[0]} * layout.dimensions[1];
}
[[nodiscard]] inline std::uint64_t voxel_count(const VolumeLayout& layout) {
  return std::uint64_t{slice_voxels(layout)} * layout.dimensions[2];
}

/// Checks a layout. Returns nullopt if it is usable. A usable layout has 1 to 2^48 voxels, at most 2^34 per slice. Its
/// axes are finite and span space; its origin, slope and intercept are finite.
[[nodiscard]] std::optional<VolumeError> check(const VolumeLayout& layout);

/// Reports whether voxels may be missing: the voxel type has NaNs, the layout defines a missing value, or the slope may
/// overflow float.
[[nodiscard]] bool may_miss(const VolumeLayout& layout);

/// Converts stored voxels to values: stored * slope + intercept, rounded to float. NaNs, infinities, overflows and
/// `layout.missing` become kMissing. `stored` may be unaligned. It should have values.size() voxels; values without a
/// stored voxel become kMissing. Any thread.
void values_of(const VolumeLayout& layout, std::span<const std::byte> stored, std::span<float> values);

/// Converts stored voxels to numbers without slope and intercept. NaNs, and voxels that values_of() makes missing,
/// become NaN. Otherwise like values_of().
void stored_numbers(const VolumeLayout& layout, std::span<const std::byte> stored, std::span<double> numbers);

/// Reads slice z into slice_voxels() values. The layout must be valid. Returns false if the source fails or z is out of
/// range. `scratch` is a reusable buffer.
[[nodiscard]] bool read_slice(const VolumeSource& source, std::uint32_t z, std::vector<std::byte>& scratch,
                              std::span<float> values);

/// Reports whether a box is not empty and lies in a volume of these dimensions.
[[nodiscard]] bool lies_in(const VoxelBox& box, const std::array<std::uint32_t, 3>& dimensions);
/// Returns the number of voxels of a box.
[[nodiscard]] inline std::uint64_t voxel_count(const VoxelBox& box) {
  return std::uint64_t{box.size[0]} * box.size[1] * box.size[2];
}
/// Reads the stored bytes of the voxels of a box, x first. Sources without read_box() read the slices of the box.
/// Returns false if the source fails, or if the box leaves the volume.
[[nodiscard]] bool read_voxels(const VolumeSource& source, const VoxelBox& box, std::span<std::byte> to);

}  // namespace gs::qnv
