#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace gs::app {

/// Display options of the three slices of a volume.
struct VolumeSlices {
  std::array<bool, 3> shown{};
  std::array<float, 3> places{0.5f, 0.5f, 0.5f};  // positions along the volume's axes: 0 is the first voxel, 1 the last
  bool alone = false;                             // show the slices without the volume
  std::optional<std::pair<float, float>> window;  // values of the first and last colour; nullopt means the full range
  std::string map = "grey";                       // name of the colour map, see color_maps()
  [[nodiscard]] bool any() const { return shown[0] || shown[1] || shown[2]; }
  friend bool operator==(const VolumeSlices&, const VolumeSlices&) = default;
};

/// Slice that an option of the command line requests: "x=50%", or "z=12" with a voxel index from 0.
struct SliceWish {
  std::size_t axis = 0;
  double place = 0;
  bool percent = false;
};
[[nodiscard]] std::optional<SliceWish> read_slice_wish(std::string_view text);
/// Shows the requested slice of a volume with these dimensions. Limits its position to the volume.
void apply(const SliceWish& wish, const std::array<std::uint32_t, 3>& dimensions, VolumeSlices& slices);

/// Preset of VolumeSlices::window for computed tomography.
struct WindowPreset {
  const char* label;
  const char* help;
  std::pair<float, float> window;
};
/// Returns the presets for values over `range`. Returns none if neither the unit nor the range suggests Hounsfield
/// units, or numbers 1000 above them.
[[nodiscard]] std::vector<WindowPreset> window_presets(std::pair<float, float> range, std::string_view unit);

}  // namespace gs::app
