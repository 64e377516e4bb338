#pragma once

#include "qnv/base/geometry.h"
#include "qnv/sampling/volume/volume.h"
#include "qnv/sampling/volume/volume_values.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <utility>
#include <vector>

namespace gs::qnv {

// Volumes with colours instead of values: red, green, blue and perhaps opacity, 8 bits each (sRGB).

/// Brightness Y and two colour differences (YCoCg-R), which restore red, green and blue exactly.
struct LumaColor {
  std::int32_t y = 0, orange = 0, green = 0;
};
[[nodiscard]] constexpr LumaColor luma_of(std::int32_t red, std::int32_t green, std::int32_t blue) {
  const std::int32_t orange = red - blue, half = blue + (orange >> 1), difference = green - half;
  return {half + (difference >> 1), orange, difference};
}
[[nodiscard]] constexpr std::array<std::int32_t, 3> rgb_of(const LumaColor& luma) {
  const std::int32_t half = luma.y - (luma.green >> 1), blue = half - (luma.orange >> 1);
  return {blue + luma.orange, luma.green + half, blue};
}

/// Range of colours.
inline constexpr std::pair<float, float> kColorRange{0.0f, 255.0f};
/// Returns the transfer function of colours, which has opacities for their brightness.
[[nodiscard]] std::vector<TransferPoint> color_transfer();

/// Reports whether a source has colours: three or four components of u8 that the layout calls colours.
[[nodiscard]] bool has_colors(const VolumeSource& source);

/// Slices of all components of a source, one at a time. Keeps the last one, because readers take the components of a
/// slice one after the other. Any thread.
class ColorSlices {
 public:
  explicit ColorSlices(std::vector<VolumeSource> components);
  virtual ~ColorSlices() = default;

  /// Copies component `c` of slice z. Returns false if the source fails.
  [[nodiscard]] bool read(std::size_t c, std::uint32_t z, std::span<std::byte> to);
  /// Copies the brightness of slice z.
  [[nodiscard]] bool read_luma(std::uint32_t z, std::span<std::byte> to);

 protected:
  /// Reads the colours of slice z into planes of slice_voxels() bytes.
  [[nodiscard]] virtual bool load(std::uint32_t z, std::span<std::vector<std::uint8_t>> planes);
  std::vector<VolumeSource> components_;

 private:
  [[nodiscard]] bool keep(std::uint32_t z);
  std::mutex mutex_;
  std::vector<std::vector<std::uint8_t>> planes_;
  std::uint32_t z_ = 0;
  bool kept_ = false;
};

/// Returns a source of colours: its own numbers are the brightness, its components are those of `slices`. `layout` is
/// that of the components.
[[nodiscard]] VolumeSource color_source(VolumeLayout layout, const std::shared_ptr<ColorSlices>& slices,
                                        std::size_t components);
/// Returns the source of colours with these components.
[[nodiscard]] VolumeSource color_source(std::vector<VolumeSource> components);

/// Returns the values of colours from those of the components of a stream. `luma` states that these are brightness and
/// differences. All have the same level and dimensions. The error is that of each colour.
[[nodiscard]] std::shared_ptr<const VolumeValues> color_values(
    std::span<const std::shared_ptr<const VolumeValues>> components, bool luma);

/// Gives each vector the brightest colour of three voxels: its own and the next two along the normal (one if `coarse`).
/// The reason is that voxels at the surface of an object are mixed with dark surroundings. Opacities reduce weights.
/// Vectors outside of the volume, or in unreadable slices, become white. `source` has colours.
void color_vectors(const VolumeSource& source, Volume& volume, bool coarse = false);

}  // namespace gs::qnv
