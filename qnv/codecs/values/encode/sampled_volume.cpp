#include "qnv/codecs/values/encode/sampled_volume.h"

#include "qnv/codecs/values/cluster.h"
#include "qnv/codecs/values/lifting.h"
#include "qnv/codecs/values/stored_code.h"
#include "qnv/sampling/volume/volume_slices.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>

namespace gs::qnv::values {

namespace {

// The default tolerance is half a step of a display with 12 bits.
constexpr double kDefaultShare = 1.0 / 8192;
// Bits of the samples of float volumes that are restored exactly. Remainders have the others.
constexpr int kExactBits = 22;

/// Range of the stored numbers that are not missing.
struct StoredRange {
  double least = std::numeric_limits<double>::infinity(), most = -std::numeric_limits<double>::infinity();
  bool gaps = false;
};

/// Calls take(z, numbers) for each slice. Returns an error if the source fails, or if cancelled.
std::optional<EncodeError> each_slice(const VolumeSource& source, const char* stage, Progress* progress,
                                      const std::function<void(std::uint32_t, std::span<const double>)>& take) {
  const VolumeLayout& layout = source.layout;
  if (progress) {
    progress->stage = stage;
    progress->done = 0;
    progress->total = layout.dimensions[2];
  }
  std::vector<std::byte> stored(slice_voxels(layout) * size_of(layout.type));
  std::vector<double> numbers(slice_voxels(layout));
  for (std::uint32_t z = 0; z < layout.dimensions[2]; ++z) {
    if (is_cancelled(progress)) return EncodeError{"cancelled"};
    if (!source.read(z, stored)) return EncodeError{"slice " + std::to_string(z) + " of the volume cannot be read"};
    stored_numbers(layout, stored, numbers);
    take(z, numbers);
    if (progress) progress->done = z + 1;
  }
  return std::nullopt;
}

double permitted_error(const ValueTolerance& tolerance, double range) {
  if (tolerance.lossless) return 0;
  if (tolerance.error) return tolerance.of_range ? *tolerance.error * range : *tolerance.error;
  return kDefaultShare * range;
}

// Sets grid and limits of an integer volume. A sample counts steps above the minimum. The step is 1, or a power of two
// if the range exceeds kMostSample.
void scale_integers(const StoredRange& range, double permitted, SampledVolume& volume) {
  ValueGrid& grid = volume.grid;
  double step = 1;
  while ((range.most - range.least) / step > kMostSample) step *= 2;
  grid.unit = grid.slope * step;
  grid.zero = grid.intercept + grid.slope * range.least;
  const double apart = std::abs(grid.slope);
  volume.rounding = static_cast<float>(step > 1 ? apart * step / 2 : 0);
  const double samples = (permitted - volume.rounding) / std::abs(grid.unit);
  grid.exact = step > 1 && samples < 0;
  volume.most_error = static_cast<std::uint32_t>(std::clamp(std::floor(samples + 1e-9), 0.0, double{kMostSample}));
}

// Sets grid and limits of a float volume. A sample counts steps of a power of two above the minimum.
void scale_floats(const StoredRange& range, double permitted, SampledVolume& volume) {
  ValueGrid& grid = volume.grid;
  // The step is a power of two in stored numbers, so that its multiples are exact.
  const double size = range.most - range.least;
  const double stored_error = permitted / std::abs(grid.slope);
  int exponent = std::ilogb(size > 0 ? size : 1) + 1 - kExactBits;
  const double least_step = std::ldexp(1.0, exponent - 3);
  if (stored_error > 4 * least_step) exponent = std::ilogb(stored_error / 4);
  exponent = std::clamp(exponent, -1000, 1000);
  const double step = std::ldexp(1.0, exponent);
  grid.unit = grid.slope * step;
  grid.zero = grid.intercept + grid.slope * range.least;
  volume.rounding = static_cast<float>(std::abs(grid.unit) / 2);
  const double number_rounding = std::max(std::abs(range.least), std::abs(range.most)) * 0x1p-23;
  const double samples = (stored_error - step / 2 - number_rounding) / step;
  grid.exact = samples < 0;
  volume.most_error = static_cast<std::uint32_t>(std::clamp(std::floor(samples), 0.0, double{kMostSample}));
}

}  // namespace

void fill_gaps(std::vector<std::int32_t>& samples, const std::vector<std::uint8_t>& missing,
               const std::array<std::uint32_t, 3>& n) {
  // Means of ever larger boxes, until each box has a value; then values go back from large boxes to small ones.
  struct Level {
    std::array<std::uint32_t, 3> n{};
    std::vector<float> sums, counts;
  };
  std::vector<Level> levels;
  const auto index = [](const std::array<std::uint32_t, 3>& size, std::size_t x, std::size_t y, std::size_t z) {
    return (z * size[1] + y) * size[0] + x;
  };
  bool gaps = true;
  for (std::array<std::uint32_t, 3> fine = n; gaps;) {
    Level level;
    for (std::size_t a = 0; a < 3; ++a) level.n[a] = (fine[a] + 1) / 2;
    const std::size_t count = sample_count(level.n);
    level.sums.assign(count, 0);
    level.counts.assign(count, 0);
    for (std::size_t z = 0; z < fine[2]; ++z)
      for (std::size_t y = 0; y < fine[1]; ++y)
        for (std::size_t x = 0; x < fine[0]; ++x) {
          const std::size_t from = index(fine, x, y, z), to = index(level.n, x / 2, y / 2, z / 2);
          if (levels.empty()) {
            if (missing[from] != 0) continue;
            level.sums[to] += static_cast<float>(samples[from]);
            level.counts[to] += 1;
          } else if (const Level& finer = levels.back(); finer.counts[from] > 0) {
            level.sums[to] += finer.sums[from] / finer.counts[from];
            level.counts[to] += 1;
          }
        }
    gaps = std::ranges::any_of(level.counts, [](float c) { return c == 0; }) && count > 1;
    fine = level.n;
    levels.push_back(std::move(level));
  }
  for (std::size_t i = levels.size(); i-- > 0;) {
    Level& level = levels[i];
    for (std::size_t z = 0; z < level.n[2]; ++z)
      for (std::size_t y = 0; y < level.n[1]; ++y)
        for (std::size_t x = 0; x < level.n[0]; ++x) {
          const std::size_t at = index(level.n, x, y, z);
          if (level.counts[at] > 0) {
            level.sums[at] /= level.counts[at];
          } else if (i + 1 < levels.size()) {
            level.sums[at] = levels[i + 1].sums[index(levels[i + 1].n, x / 2, y / 2, z / 2)];
          }
        }
  }
  const Level& first = levels.front();
  for (std::size_t z = 0; z < n[2]; ++z)
    for (std::size_t y = 0; y < n[1]; ++y)
      for (std::size_t x = 0; x < n[0]; ++x)
        if (const std::size_t at = index(n, x, y, z); missing[at] != 0)
          samples[at] = static_cast<std::int32_t>(first.sums[index(first.n, x / 2, y / 2, z / 2)]);
}

std::variant<SampledVolume, EncodeError> sample_volume(const VolumeSource& source, const ValueTolerance& tolerance,
                                                       Progress* progress) {
  if (const auto problem = check(source.layout)) return EncodeError{problem->message};
  const VolumeLayout& layout = source.layout;
  if (voxel_count(layout) > kMostSamples)
    return EncodeError{"the volume has " + std::to_string(voxel_count(layout)) + " voxels; expected at most " +
                       std::to_string(kMostSamples)};
  SampledVolume volume;
  ValueGrid& grid = volume.grid;
  grid.dimensions = layout.dimensions;
  grid.origin = layout.origin;
  grid.axes = layout.axes;
  grid.stored = layout.type == VoxelType::f64 ? VoxelType::f32 : layout.type;
  grid.slope = layout.slope != 0 ? layout.slope : 1;
  grid.intercept = layout.intercept;
  if (layout.missing && std::isfinite(*layout.missing)) grid.missing = layout.missing;
  StoredRange range;
  if (auto problem = each_slice(source, "measuring", progress, [&](std::uint32_t, std::span<const double> numbers) {
        for (const double number : numbers) {
          range.gaps = range.gaps || number != number;
          range.least = number < range.least ? number : range.least;
          range.most = number > range.most ? number : range.most;
        }
      }))
    return std::move(*problem);
  if (!(range.least <= range.most)) return EncodeError{"every voxel of the volume is missing; expected values"};
  if (layout.slope == 0) range.least = range.most = 0;
  const double permitted = permitted_error(tolerance, (range.most - range.least) * std::abs(grid.slope));
  if (is_integer(grid.stored))
    scale_integers(range, permitted, volume);
  else
    scale_floats(range, permitted, volume);
  if (grid.unit == 0 || !std::isfinite(grid.zero) || !std::isfinite(grid.unit))
    return EncodeError{"the values of the volume are too small or too large; expected those of float32"};
  const std::array<double, 2> ends{range.least * grid.slope + grid.intercept, range.most * grid.slope + grid.intercept};
  volume.value_range = {static_cast<float>(std::min(ends[0], ends[1])), static_cast<float>(std::max(ends[0], ends[1]))};
  const double step = grid.unit / grid.slope;
  const auto count = static_cast<std::size_t>(voxel_count(layout));
  volume.samples.resize(count);
  grid.gaps = range.gaps;
  if (range.gaps) volume.missing.resize(count);
  if (grid.exact) volume.codes.resize(count);
  if (auto problem = each_slice(source, "sampling", progress, [&](std::uint32_t z, std::span<const double> numbers) {
        const std::size_t first = z * slice_voxels(layout);
        for (std::size_t i = 0; i < numbers.size(); ++i) {
          const bool there = numbers[i] == numbers[i];
          const double number = there ? std::clamp(layout.slope != 0 ? numbers[i] : 0, range.least, range.most) : 0;
          volume.samples[first + i] = there ? static_cast<std::int32_t>(std::lround((number - range.least) / step)) : 0;
          if (range.gaps) volume.missing[first + i] = there ? 0 : 1;
          if (grid.exact) volume.codes[first + i] = code_of(grid.stored, number);
        }
      }))
    return std::move(*problem);
  if (range.gaps) fill_gaps(volume.samples, volume.missing, grid.dimensions);
  return volume;
}

}  // namespace gs::qnv::values
