#include "app/commands/common/value_sample.h"

#include "qnv/sampling/volume/volume_slices.h"

#include <algorithm>
#include <bit>
#include <cstddef>

namespace gs::app {

std::vector<std::uint32_t> spread_slices(std::uint32_t slices, std::uint32_t chunk) {
  std::vector<std::uint32_t> order;
  if (slices == 0) return order;
  order.reserve(slices);
  chunk = std::clamp(chunk, 1u, slices);
  const std::uint32_t rows = (slices - 1) / chunk + 1;
  const int bits = std::bit_width(rows - 1);
  for (std::uint64_t i = 0; i < std::uint64_t{1} << bits; ++i) {
    std::uint32_t row = 0;
    for (int bit = 0; bit < bits; ++bit) row |= static_cast<std::uint32_t>(i >> bit & 1) << (bits - 1 - bit);
    if (row >= rows) continue;
    const std::uint32_t first = row * chunk;
    for (std::uint32_t z = first; z < first + std::min(chunk, slices - first); ++z) order.push_back(z);
  }
  return order;
}

ValueSample sample_values(const qnv::VolumeSource& volume, const ReadingTime& time) {
  constexpr std::uint64_t kManyVoxels = std::uint64_t{1} << 28;
  constexpr std::chrono::seconds kSampleTime{2};
  using Clock = std::chrono::steady_clock;
  ValueSample sample;
  const qnv::VolumeLayout& layout = volume.layout;
  if (qnv::check(layout)) return sample;
  const bool is_large = qnv::voxel_count(layout) > kManyVoxels;
  const Clock::time_point deadline =
      is_large && !time.is_given ? std::min(time.deadline, Clock::now() + kSampleTime) : time.deadline;
  std::vector<std::byte> scratch;
  std::vector<float> values(qnv::slice_voxels(layout));
  const std::uint32_t slices = layout.dimensions[2];
  for (const std::uint32_t z : spread_slices(slices, is_large ? volume.chunk[2] : slices)) {
    if (Clock::now() >= deadline || !qnv::read_slice(volume, z, scratch, values)) break;
    for (const float v : values) {
      sample.missing += v != v ? 1 : 0;
      sample.least = v < sample.least ? v : sample.least;
      sample.most = v > sample.most ? v : sample.most;
    }
    sample.voxels += values.size();
  }
  return sample;
}

}  // namespace gs::app
