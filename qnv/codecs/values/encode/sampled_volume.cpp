#include "qnv/codecs/values/encode/sampled_volume.h"

#include "base/nth_type.h"
#include "base/parallel.h"
#include "qnv/codecs/values/cluster.h"
#include "qnv/codecs/values/lifting.h"
#include "qnv/codecs/values/slices/level_slices.h"
#include "qnv/codecs/values/stored_code.h"
#include "qnv/sampling/volume/volume_slices.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <type_traits>

namespace gs::qnv::values {

namespace {

// The default tolerance is half a step of a display with 12 bits.
constexpr double kDefaultShare = 1.0 / 8192;
// Bits of the samples of float volumes that are restored exactly. Remainders have the others.
constexpr int kExactBits = 22;
// Number of voxels that are converted at once.
constexpr std::size_t kRun = 1024;

/// Range of the stored numbers that are not missing.
struct StoredRange {
  double least = std::numeric_limits<double>::infinity(), most = -std::numeric_limits<double>::infinity();
  bool gaps = false;

  void add(const StoredRange& other) {
    least = std::min(least, other.least);
    most = std::max(most, other.most);
    gaps = gaps || other.gaps;
  }
};

// Reports whether every stored integer of type T is there and has a value.
template <class T>
bool always_there(const VolumeLayout& layout) {
  if constexpr (std::is_floating_point_v<T>) return false;
  constexpr double kMost = std::numeric_limits<float>::max(), kLargest = 4294967296.0;
  return !layout.missing && std::abs(layout.slope) * kLargest + std::abs(layout.intercept) < kMost;
}

// Calls visit(i, number) for each stored integer.
template <class T, class Visit>
void each_integer(const VolumeLayout& layout, std::span<const std::byte> stored, const Visit& visit) {
  const std::size_t count = stored.size() / sizeof(T);
  const std::byte* const from = stored.data();
  const auto read = [&](auto order) {
    for (std::size_t i = 0; i < count; ++i) {
      T number;
      std::memcpy(&number, from + i * sizeof(T), sizeof(T));
      visit(i, order(number));
    }
  };
  if (layout.big_endian == (std::endian::native == std::endian::big) || sizeof(T) == 1)
    return read([](T n) { return n; });
  if constexpr (sizeof(T) == 2)
    read([](T n) { return static_cast<T>(__builtin_bswap16(static_cast<std::uint16_t>(n))); });
  else if constexpr (sizeof(T) == 4)
    read([](T n) { return static_cast<T>(__builtin_bswap32(static_cast<std::uint32_t>(n))); });
}

StoredRange range_of(const VolumeLayout& layout, std::span<const std::byte> stored) {
  StoredRange range;
  with_nth_type<std::uint8_t, std::int8_t, std::uint16_t, std::int16_t, std::uint32_t, std::int32_t, float, double>(
      static_cast<std::size_t>(layout.type), [&]<class T>(T) {
        const std::size_t count = stored.size() / sizeof(T);
        if (always_there<T>(layout)) {
          T least = std::numeric_limits<T>::max(), most = std::numeric_limits<T>::lowest();
          each_integer<T>(layout, stored, [&](std::size_t, T number) {
            least = std::min(least, number);
            most = std::max(most, number);
          });
          range.least = static_cast<double>(least);
          range.most = static_cast<double>(most);
          return;
        }
        std::array<double, kRun> numbers;
        for (std::size_t at = 0; at < count; at += kRun) {
          const std::size_t n = std::min(kRun, count - at);
          stored_numbers(layout, stored.subspan(at * sizeof(T), n * sizeof(T)), std::span(numbers).first(n));
          for (std::size_t i = 0; i < n; ++i) {
            range.gaps = range.gaps || numbers[i] != numbers[i];
            range.least = numbers[i] < range.least ? numbers[i] : range.least;
            range.most = numbers[i] > range.most ? numbers[i] : range.most;
          }
        }
      });
  return range;
}

// Returns the range of a whole volume, or an error if the source fails or if cancelled.
std::variant<StoredRange, EncodeError> measured_range(const VolumeSource& source, RankShare slices,
                                                      Progress* progress) {
  const VolumeLayout& layout = source.layout;
  if (progress) {
    progress->stage = "measuring";
    progress->done = 0;
    progress->total = slices.size();
  }
  std::vector<std::byte> stored(slice_voxels(layout) * size_of(layout.type));
  StoredRange whole;
  for (auto z = static_cast<std::uint32_t>(slices.first); z < slices.end; ++z) {
    if (is_cancelled(progress)) return EncodeError{"cancelled"};
    if (!source.read(z, stored)) return EncodeError{"slice " + std::to_string(z) + " of the volume cannot be read"};
    whole.add(range_of(layout, stored));
    if (progress) ++progress->done;
  }
  return whole;
}

double permitted_error(const ValueTolerance& tolerance, double range) {
  if (tolerance.lossless) return 0;
  if (tolerance.error) return tolerance.of_range ? *tolerance.error * range : *tolerance.error;
  return kDefaultShare * range;
}

// Sets grid and limits of an integer volume. A sample counts steps above the minimum. The step is 1, or a power of two
// if the range exceeds kMostSample.
void scale_integers(double permitted, SampledVolume& volume) {
  ValueGrid& grid = volume.grid;
  double step = 1;
  while ((volume.most - volume.least) / step > kMostSample) step *= 2;
  grid.unit = grid.slope * step;
  grid.zero = grid.intercept + grid.slope * volume.least;
  const double apart = std::abs(grid.slope);
  volume.rounding = static_cast<float>(step > 1 ? apart * step / 2 : 0);
  const double samples = (permitted - volume.rounding) / std::abs(grid.unit);
  grid.exact = step > 1 && samples < 0;
  volume.most_error = static_cast<std::uint32_t>(std::clamp(std::floor(samples + 1e-9), 0.0, double{kMostSample}));
}

// Sets grid and limits of a float volume. A sample counts steps of a power of two above the minimum.
void scale_floats(double permitted, SampledVolume& volume) {
  ValueGrid& grid = volume.grid;
  // The step is a power of two in stored numbers, so that its multiples are exact.
  const double size = volume.most - volume.least;
  const double stored_error = permitted / std::abs(grid.slope);
  int exponent = std::ilogb(size > 0 ? size : 1) + 1 - kExactBits;
  const double least_step = std::ldexp(1.0, exponent - 3);
  if (stored_error > 4 * least_step) exponent = std::ilogb(stored_error / 4);
  exponent = std::clamp(exponent, -1000, 1000);
  const double step = std::ldexp(1.0, exponent);
  grid.unit = grid.slope * step;
  grid.zero = grid.intercept + grid.slope * volume.least;
  volume.rounding = static_cast<float>(std::abs(grid.unit) / 2);
  const double number_rounding = std::max(std::abs(volume.least), std::abs(volume.most)) * 0x1p-23;
  const double samples = (stored_error - step / 2 - number_rounding) / step;
  grid.exact = samples < 0;
  volume.most_error = static_cast<std::uint32_t>(std::clamp(std::floor(samples), 0.0, double{kMostSample}));
}

// Part of a batch to convert: one slice.
struct SlicePart {
  std::int32_t* samples;
  std::uint8_t* missing;  // null if the volume has no gaps
  std::uint32_t* codes;   // null if they are not wanted
};

void convert_slice(const VolumeLayout& layout, const SampledVolume& volume, std::span<const std::byte> stored,
                   const SlicePart& to) {
  const double step = volume.grid.unit / volume.grid.slope;
  with_nth_type<std::uint8_t, std::int8_t, std::uint16_t, std::int16_t, std::uint32_t, std::int32_t, float, double>(
      static_cast<std::size_t>(layout.type), [&]<class T>(T) {
        const std::size_t count = stored.size() / sizeof(T);
        if (always_there<T>(layout) && step == 1 && !to.codes && layout.slope != 0) {
          const auto least = static_cast<std::int64_t>(volume.least);
          each_integer<T>(layout, stored, [&](std::size_t i, T number) {
            to.samples[i] =
                static_cast<std::int32_t>(static_cast<std::uint32_t>(number) - static_cast<std::uint32_t>(least));
          });
          if (to.missing) std::fill_n(to.missing, count, std::uint8_t{0});
          return;
        }
        std::array<double, kRun> numbers;
        const double per_step = 1 / step;  // exact for powers of two
        for (std::size_t at = 0; at < count; at += kRun) {
          const std::size_t n = std::min(kRun, count - at);
          stored_numbers(layout, stored.subspan(at * sizeof(T), n * sizeof(T)), std::span(numbers).first(n));
          for (std::size_t i = 0; i < n; ++i) {
            const bool there = numbers[i] == numbers[i];
            if (to.missing) to.missing[at + i] = there ? 0 : 1;
            const double number = there ? (layout.slope != 0 ? numbers[i] : 0.0) : volume.least;
            to.samples[at + i] = static_cast<std::int32_t>((number - volume.least) * per_step + 0.5);
            numbers[i] = there ? number : 0.0;
          }
          if (to.codes)
            for (std::size_t i = 0; i < n; ++i) to.codes[at + i] = code_of(volume.grid.stored, numbers[i]);
        }
      });
}

}  // namespace

std::variant<SampledVolume, EncodeError> sample_volume(std::span<const VolumeSource> steps,
                                                       const ValueTolerance& tolerance, Ranks& ranks,
                                                       Progress* progress) {
  const VolumeLayout& layout = steps.front().layout;
  if (const auto problem = check(layout)) return EncodeError{problem->message};
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
  for (const VolumeSource& step : steps) {
    const auto measured = measured_range(step, share_of(ranks, layout.dimensions[2]), progress);
    const auto* const problem = std::get_if<EncodeError>(&measured);
    if (auto failed = agree(ranks, problem ? std::optional(*problem) : std::nullopt)) return std::move(*failed);
    for (const StoredRange& part : gather_records(ranks, std::span(&std::get<StoredRange>(measured), 1)))
      range.add(part);
  }
  auto& [least, most, gaps] = range;
  if (!(least <= most)) return EncodeError{"every voxel of the volume is missing; expected values"};
  if (layout.slope == 0) least = most = 0;
  volume.least = least;
  volume.most = most;
  grid.gaps = gaps;
  const double permitted = permitted_error(tolerance, (most - least) * std::abs(grid.slope));
  if (is_integer(grid.stored))
    scale_integers(permitted, volume);
  else
    scale_floats(permitted, volume);
  if (grid.unit == 0 || !std::isfinite(grid.zero) || !std::isfinite(grid.unit))
    return EncodeError{"the values of the volume are too small or too large; expected those of float32"};
  const std::array<double, 2> ends{least * grid.slope + grid.intercept, most * grid.slope + grid.intercept};
  volume.value_range = {static_cast<float>(std::min(ends[0], ends[1])), static_cast<float>(std::max(ends[0], ends[1]))};
  return volume;
}

SampleReader::SampleReader(const VolumeSource& source, const SampledVolume& volume, unsigned threads)
    : source_(source), volume_(volume), threads_(threads), filling_(volume.grid.dimensions) {}

std::optional<EncodeError> SampleReader::read(std::uint32_t first, std::uint32_t count, bool codes,
                                              SampleBatch& batch) {
  const VolumeLayout& layout = source_.layout;
  const std::size_t slice = slice_voxels(layout), bytes = slice * size_of(layout.type);
  batch.first = first;
  batch.count = count;
  batch.samples.resize(slice * count);
  batch.missing.resize(volume_.grid.gaps ? slice * count : 0);
  batch.codes.resize(codes ? slice * count : 0);
  stored_.resize(bytes * count);
  for (std::uint32_t i = 0; i < count; ++i)
    if (!source_.read(first + i, std::span(stored_).subspan(i * bytes, bytes)))
      return EncodeError{"slice " + std::to_string(first + i) + " of the volume cannot be read"};
  (void)parallel_for(
      count,
      [&](std::size_t i) {
        const std::size_t at = i * slice;
        convert_slice(layout, volume_, std::span<const std::byte>(stored_).subspan(i * bytes, bytes),
                      {batch.samples.data() + at, batch.missing.empty() ? nullptr : batch.missing.data() + at,
                       codes ? batch.codes.data() + at : nullptr});
      },
      threads_for(slice * count, threads_));
  if (fills_) filling_.fill(batch);
  return std::nullopt;
}

void SampleReader::prepare_gaps(Ranks& ranks) {
  filling_.finish(ranks);
  fills_ = true;
}

}  // namespace gs::qnv::values
