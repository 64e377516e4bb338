#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace gs::app {

/// What is shown of a volume's three planes of voxels.
struct VolumeSlices {
  std::array<bool, 3> shown{};
  std::array<float, 3> places{0.5f, 0.5f, 0.5f};  // along the volume's own x, y, z: 0 the first voxel, 1 the last
  bool alone = false;                             // without the volume
  std::optional<std::pair<float, float>> window;  // values of the first and the last colour; none: the volume's range
  std::string map = "grey";                       // of color_maps()
  [[nodiscard]] bool any() const { return shown[0] || shown[1] || shown[2]; }
  friend bool operator==(const VolumeSlices&, const VolumeSlices&) = default;
};

/// A plane as the command line has it: "x=50%" or "z=12", a voxel from 0 on.
struct SliceWish {
  std::size_t axis = 0;
  double place = 0;
  bool percent = false;
};
[[nodiscard]] std::optional<SliceWish> read_slice_wish(std::string_view text);
/// Shows the plane in a volume of so many voxels; what lies outside of it is its first or last plane.
void apply(const SliceWish& wish, const std::array<std::uint32_t, 3>& dimensions, VolumeSlices& slices);

}  // namespace gs::app
