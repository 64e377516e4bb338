#pragma once

#include "qnv/sampling/volume/volume.h"

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace gs::qnv {

/// Values of a part of a volume, finer than those of the whole volume.
struct ValueBrick {
  int level = 0;                                           // samples are 2^level voxels of the whole volume apart
  std::array<std::uint32_t, 3> first{}, size{};            // samples of the level that the part has, with a margin
  std::array<std::uint32_t, 3> core_first{}, core_size{};  // without the margin
  std::array<double, 3> steps{1, 1, 1};  // distances of samples in voxels of the values of the whole volume
  double slope = 1, intercept = 0;       // value = sample * slope + intercept
  VoxelType type = VoxelType::i32;       // of the samples: i32, u32, or f32 (a NaN is missing)
  std::optional<std::int32_t> missing;   // sample that means "no data"
  std::shared_ptr<const std::vector<std::int32_t>> samples;
  std::optional<float> error;  // maximum error of the voxels with flags
  /// Flags of the cubes of kErrorEdge samples per axis, x first, from `first` on.
  std::shared_ptr<const std::vector<std::uint8_t>> bounded;
  static constexpr std::uint32_t kErrorEdge = 4;

  /// Returns the maximum error of a sample of the level, which the part must have; nullopt if it is unknown.
  [[nodiscard]] std::optional<float> error_of(std::uint32_t x, std::uint32_t y, std::uint32_t z) const {
    if (!error || !bounded) return std::nullopt;
    const auto count = [this](std::size_t a) { return std::size_t{(size[a] - 1) / kErrorEdge + 1}; };
    const std::size_t cube = ((z - first[2]) / kErrorEdge * count(1) + (y - first[1]) / kErrorEdge) * count(0) +
                             (x - first[0]) / kErrorEdge;
    return cube < bounded->size() && (*bounded)[cube] != 0 ? error : std::nullopt;
  }
  /// Returns the value of a sample of the level, which the part must have; a NaN if it is missing.
  [[nodiscard]] float value(std::uint32_t x, std::uint32_t y, std::uint32_t z) const {
    const std::int32_t sample =
        (*samples)[((z - first[2]) * std::size_t{size[1]} + (y - first[1])) * size[0] + (x - first[0])];
    if (sample == missing) return std::numeric_limits<float>::quiet_NaN();
    const double number = type == VoxelType::f32   ? static_cast<double>(std::bit_cast<float>(sample))
                          : type == VoxelType::u32 ? static_cast<double>(std::bit_cast<std::uint32_t>(sample))
                                                   : static_cast<double>(sample);
    return static_cast<float>(number * slope + intercept);
  }
};

/// Choice of a step of a time series: by its number from 0, or the one with the nearest time.
struct ShownStep {
  std::uint32_t number = 0;  // the last one if it is too large
  std::optional<double> time{};
  friend bool operator==(const ShownStep&, const ShownStep&) = default;
};
/// Returns the number of the chosen step. `times` ascend; without times, returns 0.
[[nodiscard]] std::uint32_t step_number(const ShownStep& step, std::span<const double> times);

/// Choice of the number to show of voxels that have several, and of the step of a time series.
struct ShownComponent {
  std::uint32_t index = 0;  // from 0; the last one if it is too large
  bool magnitude = false;   // the length of the vector of all numbers instead
  bool chosen = false;      // show one number even if the voxels are colours
  ShownStep step{};
  friend bool operator==(const ShownComponent&, const ShownComponent&) = default;
};

/// Decoded values of a volume, from which its vectors come. Any thread may read them at any time.
struct VolumeValues {
  VolumeSource source;                  // owns its data
  std::pair<float, float> range{0, 1};  // of the whole volume, which a prefix may exceed
  int level = 0;                        // voxels are 2^level voxels of the whole volume apart
  std::array<std::uint32_t, 3> whole{};  // voxels of the whole volume; 0 if they are those of `source`
  std::optional<float> error;           // maximum for every voxel, in the unit of the values; nullopt if it is unknown
  std::optional<float> wrong;           // labels: share of voxels with a wrong one, instead of `error`
  std::optional<float> rms;             // root mean square of the errors
  VoxelType stored = VoxelType::f32;    // of the original volume: value = stored * slope + intercept
  double slope = 1, intercept = 0;
  std::optional<double> missing;                                  // stored number that marks missing voxels
  bool exact = false;                                             // the stored voxels are restored bit for bit
  std::uint64_t bytes = 0;                                        // of memory
  std::vector<ValueBrick> bricks{};                               // finer parts, the finest first
  std::vector<std::shared_ptr<const VolumeValues>> components{};  // all numbers of a voxel, if it has several
  std::uint32_t step = 0;                                         // of a time series
  std::vector<double> times{};                                    // of the steps of a time series
  std::vector<std::shared_ptr<const VolumeValues>> steps{};       // all steps, for exports
};

}  // namespace gs::qnv
