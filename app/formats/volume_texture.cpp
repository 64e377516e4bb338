#include "app/formats/volume_texture.h"

#include "app/formats/volume/confined/confined_volume.h"
#include "app/formats/volume/volume_common.h"
#include "qnv/sampling/volume/volume_slices.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace gs::app {
namespace {

constexpr std::uint64_t kLongestSide = 4096;

/// Reader of the slices of a volume as bytes.
class ByteSlices {
 public:
  ByteSlices(const qnv::VolumeSource& source, const WorldBudget& budget) : source_(source), budget_(budget) {
    values_.resize(qnv::slice_voxels(source.layout));
  }

  /// Finds the range of the values. Returns false if a slice cannot be read, or after a cancellation.
  [[nodiscard]] bool find_range() {
    const qnv::VolumeLayout& layout = source_.layout;
    const bool plain = layout.type == qnv::VoxelType::u8 && layout.slope == 1 && layout.intercept == 0;
    if (plain) return true;
    float low = std::numeric_limits<float>::max(), high = -low;
    for (std::uint32_t z = 0; z < layout.dimensions[2]; ++z) {
      if (!read(z)) return false;
      for (const float value : values_)
        if (value == value) low = std::min(low, value), high = std::max(high, value);
    }
    low_ = low;
    factor_ = high > low ? 255 / (double{high} - low) : 0;
    return true;
  }
  [[nodiscard]] bool read(std::uint32_t z) {
    return !budget_->stopped() && qnv::read_slice(source_, z, scratch_, values_);
  }
  /// Returns a voxel of the slice that was read last; 0 if it is missing.
  [[nodiscard]] std::uint8_t at(std::size_t voxel) const {
    const double value = (values_[voxel] - low_) * factor_;
    return value == value ? static_cast<std::uint8_t>(std::clamp(value, 0.0, 255.0)) : 0;
  }

 private:
  const qnv::VolumeSource& source_;
  const WorldBudget& budget_;
  double low_ = 0, factor_ = 1;
  std::vector<std::byte> scratch_;
  std::vector<float> values_;
};

}  // namespace

bool is_volume_texture(std::span<const std::byte> bytes) {
  if (is_tiff(bytes)) return false;  // a picture
  return is_nrrd(bytes) ? is_detached_nrrd(bytes) : is_volume({}, bytes);
}

std::variant<Texture, render::ImageError> read_volume_texture(const std::string& path, const VolumeOrigin& origin,
                                                              const WorldBudget& budget) {
  using render::ImageError;
  auto opened = open_volume_confined(path, {}, origin, budget);
  if (auto* problem = std::get_if<std::string>(&opened)) return ImageError{std::move(*problem)};
  const qnv::VolumeSource& source = std::get<qnv::VolumeSource>(opened);
  if (const auto error = qnv::check(source.layout)) return ImageError{error->message};
  const std::array<std::uint32_t, 3>& whole = source.layout.dimensions;
  const render::ImageLimits limits = texture_limits(budget);
  for (const std::uint64_t side : whole)
    if (side > kLongestSide) return ImageError{"a volume with a side of " + std::to_string(side) + "; expected 1 to 4096"};
  if (qnv::voxel_count(source.layout) > limits.file_pixels)
    return ImageError{"a volume of " + std::to_string(qnv::voxel_count(source.layout)) + " voxels; expected at most " +
                      std::to_string(limits.file_pixels)};
  // Larger volumes are reduced by a whole number in each direction.
  std::uint32_t side = 1;
  const auto kept = [&](std::size_t axis) { return std::size_t{(whole[axis] + side - 1) / side}; };
  while (side < kLongestSide && kept(0) * kept(1) * kept(2) > std::max<std::size_t>(limits.kept_pixels, 1)) ++side;
  const std::size_t width = kept(0), rows = kept(1), slices = kept(2);
  render::Image image{static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(rows * slices), 1, {}};
  image.slices = static_cast<std::uint32_t>(slices);
  image.reduction = side;
  image.pixels.resize(width * rows * slices);
  ByteSlices bytes(source, budget);
  const auto unreadable = [&] { return ImageError{budget->stopped() ? "cancelled" : "a slice cannot be read"}; };
  if (!bytes.find_range()) return unreadable();
  std::vector<std::uint32_t> sums(width * rows), counts(width * rows);
  for (std::size_t slice = 0; slice < slices; ++slice) {
    std::fill(sums.begin(), sums.end(), 0);
    std::fill(counts.begin(), counts.end(), 0);
    const auto end = static_cast<std::uint32_t>(std::min<std::size_t>((slice + 1) * side, whole[2]));
    for (auto z = static_cast<std::uint32_t>(slice * side); z < end; ++z) {
      if (!bytes.read(z)) return unreadable();
      for (std::size_t y = 0; y < whole[1]; ++y)
        for (std::size_t x = 0; x < whole[0]; ++x) {
          const std::size_t to = y / side * width + x / side;
          sums[to] += bytes.at(y * whole[0] + x);
          ++counts[to];
        }
    }
    // The first row of a slice is at t = 0, the bottom.
    for (std::size_t row = 0; row < rows; ++row)
      for (std::size_t x = 0; x < width; ++x) {
        const std::size_t from = row * width + x;
        image.pixels[(slice * rows + rows - 1 - row) * width + x] =
            static_cast<std::uint8_t>(sums[from] / std::max<std::uint32_t>(counts[from], 1));
      }
  }
  return hold_texture(std::move(image), budget);
}

}  // namespace gs::app
