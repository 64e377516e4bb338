#include "qnv/sampling/volume/component_values.h"

#include "qnv/sampling/volume/volume_slices.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>
#include <vector>

namespace gs::qnv {

std::uint32_t step_number(const ShownStep& step, std::span<const double> times) {
  if (times.empty()) return 0;
  if (!step.time) return std::min(step.number, static_cast<std::uint32_t>(times.size() - 1));
  const double wished = std::clamp(*step.time, times.front(), times.back());
  const auto nearest = std::ranges::min_element(times, {}, [&](double time) { return std::abs(time - wished); });
  return static_cast<std::uint32_t>(nearest - times.begin());
}

std::shared_ptr<const VolumeValues> magnitude_of(std::span<const std::shared_ptr<const VolumeValues>> all) {
  auto made = std::make_shared<VolumeValues>(*all.front());
  made->components.clear();
  const std::size_t slice = slice_voxels(made->source.layout);
  auto lengths = std::make_shared<std::vector<float>>(voxel_count(made->source.layout));
  std::vector<double> sums(slice);
  std::vector<float> values(slice);
  std::vector<std::byte> scratch;
  float least = std::numeric_limits<float>::infinity(), most = -least;
  for (std::uint32_t z = 0; z < made->source.layout.dimensions[2]; ++z) {
    std::ranges::fill(sums, 0.0);
    for (const auto& one : all) {
      if (!read_slice(one->source, z, scratch, values)) std::ranges::fill(values, kMissing);
      for (std::size_t i = 0; i < slice; ++i) {
        const auto value = static_cast<double>(values[i]);
        sums[i] += value * value;
      }
    }
    for (std::size_t i = 0; i < slice; ++i) {
      const auto length = static_cast<float>(std::sqrt(sums[i]));
      (*lengths)[z * slice + i] = length;
      least = length < least ? length : least;
      most = length > most ? length : most;
    }
  }
  made->range = least <= most ? std::pair(least, most) : std::pair(0.0f, 1.0f);
  made->stored = VoxelType::f32;
  made->slope = 1;
  made->intercept = 0;
  made->missing.reset();
  made->bytes = 4 * lengths->size();
  // The length is in error by at most the length of all errors.
  double error = 0, rms = 0;
  made->exact = true;
  for (const auto& one : all) {
    made->exact = made->exact && one->exact;
    error += one->error ? std::pow(static_cast<double>(*one->error), 2) : std::numeric_limits<double>::infinity();
    rms += one->rms ? std::pow(static_cast<double>(*one->rms), 2) : std::numeric_limits<double>::infinity();
  }
  made->error = std::isfinite(error) ? std::optional(static_cast<float>(std::sqrt(error))) : std::nullopt;
  made->rms = std::isfinite(rms) ? std::optional(static_cast<float>(std::sqrt(rms))) : std::nullopt;
  VolumeLayout& layout = made->source.layout;
  layout.type = VoxelType::f32;
  layout.big_endian = std::endian::native == std::endian::big;
  layout.slope = 1;
  layout.intercept = 0;
  layout.missing.reset();
  made->source.read = [lengths, slice](std::uint32_t z, std::span<std::byte> to) {
    if ((z + std::size_t{1}) * slice > lengths->size() || to.size() != slice * sizeof(float)) return false;
    std::memcpy(to.data(), lengths->data() + z * slice, to.size());
    return true;
  };
  return made;
}

}  // namespace gs::qnv
