#include "qnv/codecs/values/arrays/array_levels.h"

#include "qnv/sampling/volume/volume_slices.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <optional>
#include <span>
#include <utility>

namespace gs::qnv::values {

namespace {

/// Returns the halvings of each axis until `level`. An axis of one sample stays as it is.
std::array<int, 3> halvings(const Extent& extent, int level) {
  std::array<int, 3> counts{};
  for (std::size_t a = 0; a < 3; ++a)
    while (counts[a] < level && low_extent(extent, counts[a])[a] > 1) ++counts[a];
  return counts;
}

/// Returns how often the axes of a version of a volume were halved; nullopt if its voxels are no halves.
std::optional<std::array<int, 3>> halvings_of_version(const VolumeLayout& fine, const VolumeLayout& coarse) {
  constexpr float kTolerance = 0.02f;
  constexpr int kMost = 31;
  std::array<int, 3> counts{};
  for (std::size_t a = 0; a < 3; ++a) {
    const float ratio = glm::length(coarse.axes[a]) / glm::length(fine.axes[a]);
    if (!(ratio >= 1 - kTolerance)) return std::nullopt;
    counts[a] = static_cast<int>(std::lround(std::log2(std::min(ratio, 2e9f))));
    if (counts[a] > kMost || std::abs(ratio / std::ldexp(1.0f, counts[a]) - 1) > kTolerance) return std::nullopt;
    // Writers round the number of voxels up or down.
    const std::uint64_t all = fine.dimensions[a], up = ((all - 1) >> counts[a]) + 1, down = all >> counts[a];
    if (coarse.dimensions[a] != up && coarse.dimensions[a] != down) return std::nullopt;
  }
  return counts;
}

}  // namespace

ArrayLevels::ArrayLevels(VolumeSource source, int base) : source_(std::move(source)) {
  std::vector<std::pair<const VolumeSource*, std::array<int, 3>>> versions{{&source_, {}}};
  for (const VolumeSource& one : source_.coarser)
    if (const auto counts = halvings_of_version(source_.layout, one.layout)) versions.emplace_back(&one, *counts);
  for (int level = 0; level <= base; ++level) {
    const std::array<int, 3> wanted = halvings(extent(), level);
    Level made{&source_, {}};
    int most = -1;
    for (const auto& [version, counts] : versions) {
      bool suits = true;
      for (std::size_t a = 0; a < 3; ++a) suits = suits && counts[a] <= wanted[a];
      if (const int sum = counts[0] + counts[1] + counts[2]; suits && sum > most) {
        most = sum;
        made.from = version;
        for (std::size_t a = 0; a < 3; ++a) made.step[a] = std::uint32_t{1} << (wanted[a] - counts[a]);
      }
    }
    VolumeLayout layout = made.from->layout;
    layout.dimensions = low_extent(extent(), level);
    for (std::size_t a = 0; a < 3; ++a) layout.axes[a] *= static_cast<float>(made.step[a]);
    // Means of several voxels lie between them.
    layout.origin += made.from->layout.base - source_.layout.base;
    layout.base = source_.layout.base;
    layout.metadata = source_.layout.metadata;
    layout.type = VoxelType::f32;
    layout.big_endian = std::endian::native == std::endian::big;
    layout.slope = 1;
    layout.intercept = 0;
    layout.missing.reset();
    levels_.push_back(made);
    layouts_.push_back(std::move(layout));
  }
}

Extent ArrayLevels::chunk(int level) const {
  const Level& one = levels_[static_cast<std::size_t>(level)];
  if (one.from->chunk == std::array<std::uint32_t, 3>{}) return {};
  Extent samples{};
  for (std::size_t a = 0; a < 3; ++a) samples[a] = std::max(one.from->chunk[a] / one.step[a], 1u);
  return samples;
}

bool ArrayLevels::decodes_all(int level) const {
  const Level& one = levels_[static_cast<std::size_t>(level)];
  if (has_version(level)) return false;
  for (std::size_t a = 0; a < 3; ++a)
    if (one.from->chunk[a] < one.step[a] && one.step[a] > 1) return false;
  return true;
}

bool ArrayLevels::read(int level, const SampleBox& box, std::vector<float>& values) const {
  const Level& one = levels_[static_cast<std::size_t>(level)];
  const VolumeLayout& layout = one.from->layout;
  VoxelBox voxels;
  voxels.step = one.step;
  for (std::size_t a = 0; a < 3; ++a) {
    // Versions with rounded numbers of voxels may lack the last sample, which repeats the one before.
    const std::uint32_t count = (layout.dimensions[a] - 1) / one.step[a] + 1;
    const std::uint32_t first = std::min(box.first[a], count - 1);
    voxels.first[a] = first * one.step[a];
    voxels.size[a] = std::max(std::min(box.first[a] + box.size[a], count) - first, 1u);
  }
  std::vector<std::byte> stored(static_cast<std::size_t>(voxel_count(voxels)) * size_of(layout.type));
  {
    const std::lock_guard lock(mutex_);
    if (!read_voxels(*one.from, voxels, stored)) return false;
  }
  values.resize(voxel_count(voxels));
  values_of(layout, stored, values);
  if (voxels.size == box.size) return true;
  std::vector<float> all;
  all.reserve(sample_count(box.size));
  for (std::uint32_t z = 0; z < box.size[2]; ++z)
    for (std::uint32_t y = 0; y < box.size[1]; ++y)
      for (std::uint32_t x = 0; x < box.size[0]; ++x)
        all.push_back(values[(std::min(z, voxels.size[2] - 1) * std::size_t{voxels.size[1]} +
                              std::min(y, voxels.size[1] - 1)) * voxels.size[0] + std::min(x, voxels.size[0] - 1)]);
  values = std::move(all);
  return true;
}

}  // namespace gs::qnv::values
