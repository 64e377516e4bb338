#pragma once

#include "qnv/volume/volume.h"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace gs::qnv {

/// Why a volume gives no vectors or triangles: what is wrong, and what was expected.
struct VolumeError {
  std::string message;
};

/// Stands for a value that is missing; tell it by value != value.
inline constexpr float kMissing = std::numeric_limits<float>::quiet_NaN();

/// Voxels of one slice, and of all slices. Only for layouts that `check` finds sound.
[[nodiscard]] inline std::size_t slice_voxels(const VolumeLayout& layout) {
  return std::size_t{layout.dimensions[0]} * layout.dimensions[1];
}
[[nodiscard]] inline std::uint64_t voxel_count(const VolumeLayout& layout) {
  return std::uint64_t{slice_voxels(layout)} * layout.dimensions[2];
}

/// Nothing when a layout can be worked with: at least one voxel, at most 2^48 of them and 2^34 a slice,
/// finite axes that span space, a finite origin, slope and intercept.
[[nodiscard]] std::optional<VolumeError> check(const VolumeLayout& layout);

/// True when voxels of this layout may be missing: a type with NaNs, a missing value, or a slope that may
/// lead out of the floats.
[[nodiscard]] bool may_miss(const VolumeLayout& layout);

/// The values of stored voxels: stored * slope + intercept, rounded to float. NaNs, infinities, what is
/// beyond the floats, and `layout.missing` become kMissing. `stored` may lie at any address and must be of
/// values.size() voxels; what is missing of it becomes kMissing too. Any thread.
void values_of(const VolumeLayout& layout, std::span<const std::byte> stored, std::span<float> values);

/// Reads slice z of a sound layout into slice_voxels() values. False when the source cannot give it, or z
/// is not in the volume. `scratch` is only kept to save memory from call to call.
[[nodiscard]] bool read_slice(const VolumeSource& source, std::uint32_t z, std::vector<std::byte>& scratch,
                              std::span<float> values);

}  // namespace gs::qnv
