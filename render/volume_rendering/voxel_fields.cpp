#include "render/volume_rendering/voxel_fields.h"

#include "base/parallel.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace gs::render {
namespace {

using Size = std::array<std::uint32_t, 3>;

std::size_t voxels_of(const Size& size) { return std::size_t{size[0]} * size[1] * size[2]; }

/// Returns one number per voxel: the first component, or the mean of three colours.
std::vector<std::uint8_t> intensities_of(const std::vector<std::uint8_t>& voxels, std::uint32_t components) {
  if (components == 1) return voxels;
  std::vector<std::uint8_t> result(voxels.size() / components);
  for (std::size_t i = 0; i < result.size(); ++i) {
    const std::uint8_t* from = voxels.data() + i * components;
    result[i] = components == 2 ? from[0] : static_cast<std::uint8_t>((from[0] + from[1] + from[2] + 1) / 3);
  }
  return result;
}

/// Range of the values of a component in each block and the voxels beside it.
std::vector<std::array<std::uint8_t, 2>> ranges_of(const std::uint8_t* values, std::size_t stride, const Size& size,
                                                   const Size& blocks) {
  std::vector<std::array<std::uint8_t, 2>> ranges(voxels_of(blocks), {255, 0});
  constexpr auto kBlock = VoxelRanges::kBlock;
  // Voxels of a slice also belong to the blocks that begin or end beside it.
  const auto blocks_of = [](std::uint32_t i, std::uint32_t count) {
    return std::pair{i > 0 ? (i - 1) / kBlock : 0, std::min((i + 1) / kBlock, count - 1)};
  };
  (void)parallel_for(blocks[2], [&](std::size_t bz) {
    const std::uint32_t first = static_cast<std::uint32_t>(bz) * kBlock;
    const std::uint32_t from = first > 0 ? first - 1 : 0, to = std::min(first + kBlock + 1, size[2]);
    for (std::uint32_t z = from; z < to; ++z)
      for (std::uint32_t y = 0; y < size[1]; ++y) {
        const auto [y0, y1] = blocks_of(y, blocks[1]);
        const std::uint8_t* row = values + (std::size_t{z} * size[1] + y) * size[0] * stride;
        for (std::uint32_t bx = 0; bx < blocks[0]; ++bx) {
          const std::uint32_t x0 = bx > 0 ? bx * kBlock - 1 : 0, x1 = std::min((bx + 1) * kBlock + 1, size[0]);
          std::uint8_t low = 255, high = 0;
          for (std::uint32_t x = x0; x < x1; ++x) {
            low = std::min(low, row[x * stride]);
            high = std::max(high, row[x * stride]);
          }
          for (std::uint32_t by = y0; by <= y1; ++by) {
            auto& range = ranges[(bz * blocks[1] + by) * blocks[0] + bx];
            range = {std::min(range[0], low), std::max(range[1], high)};
          }
        }
      }
  });
  return ranges;
}

/// Opacity of each intensity before the styles that only scale it: that of a transfer function, or the default.
std::vector<bool> visible_intensities(const std::vector<VolumeStep>& steps) {
  std::vector<bool> visible(256, true);
  visible[0] = false;
  for (const VolumeStep& step : steps) {
    if (step.kind != VolumeStep::Kind::opacity_map) break;
    if (!step.tables[0]) continue;
    const Image& table = *step.tables[0];
    visible.assign(256, true);
    if (!table.has_alpha() || table.slices > 1 || table.height == 0 || voxel_counts(table)[0] == 0) continue;
    const std::uint8_t* row =
        table.pixels.data() + std::size_t{table.height - 1} * table.width * table.components;  // t = 0 is the bottom
    for (std::size_t v = 0; v < 256; ++v) {
      // Texels that intensities between the neighbours of v may use.
      const auto texel = [&](double intensity) {
        return static_cast<std::size_t>(std::clamp(intensity / 255 * table.width - 0.5, 0.0, table.width - 1.0));
      };
      const double number = static_cast<double>(v);
      bool any = false;
      for (std::size_t x = texel(number - 1); x <= std::min<std::size_t>(texel(number + 1) + 1, table.width - 1); ++x)
        any = any || row[x * table.components + table.components - 1] != 0;
      visible[v] = any;
    }
  }
  return visible;
}

bool has_blend(const std::vector<VolumeStep>& steps) {
  return std::any_of(steps.begin(), steps.end(),
                     [](const VolumeStep& step) { return step.kind == VolumeStep::Kind::blend; });
}

}  // namespace

std::vector<std::uint8_t> upright_voxels(const Image& image, std::uint32_t most_side, Size& size) {
  const Size whole = voxel_counts(image);
  for (std::size_t i = 0; i < 3; ++i) size[i] = std::min(whole[i], most_side);
  const std::size_t components = image.components;
  std::vector<std::uint8_t> voxels(voxels_of(size) * components);
  const auto scaled = [](std::uint32_t i, std::uint32_t from, std::uint32_t count) {
    return static_cast<std::size_t>(std::uint64_t{i} * from / count);
  };
  (void)parallel_for(size[2], [&](std::size_t z) {
    std::uint8_t* to = voxels.data() + z * size[1] * size[0] * components;
    const std::size_t slice = scaled(static_cast<std::uint32_t>(z), whole[2], size[2]) * whole[1];
    for (std::uint32_t y = 0; y < size[1]; ++y) {
      const std::size_t row = slice + whole[1] - 1 - scaled(y, whole[1], size[1]);
      const std::uint8_t* from = image.pixels.data() + row * whole[0] * components;
      if (size[0] == whole[0]) {
        to = std::copy(from, from + size[0] * components, to);
        continue;
      }
      for (std::uint32_t x = 0; x < size[0]; ++x)
        for (std::size_t c = 0; c < components; ++c) *to++ = from[scaled(x, whole[0], size[0]) * components + c];
    }
  });
  return voxels;
}

std::vector<std::uint8_t> voxel_gradients(const std::vector<std::uint8_t>& voxels, const Size& size,
                                          std::uint32_t components) {
  const std::vector<std::uint8_t> values = intensities_of(voxels, components);
  std::vector<std::uint8_t> gradients(values.size() * 4);
  const std::size_t row = size[0], slice = row * size[1];
  (void)parallel_for(size[2], [&](std::size_t z) {
    // Sums of the slices before, at and after z, weighted 1 2 1, and the difference of the outer two.
    std::vector<int> sum(slice), difference(slice);
    const std::uint8_t* before = values.data() + (z > 0 ? z - 1 : 0) * slice;
    const std::uint8_t* here = values.data() + z * slice;
    const std::uint8_t* after = values.data() + std::min<std::size_t>(z + 1, size[2] - 1) * slice;
    for (std::size_t i = 0; i < slice; ++i) {
      sum[i] = before[i] + 2 * here[i] + after[i];
      difference[i] = after[i] - before[i];
    }
    for (std::size_t y = 0; y < size[1]; ++y) {
      const std::size_t rows[3] = {(y > 0 ? y - 1 : 0) * row, y * row, std::min<std::size_t>(y + 1, size[1] - 1) * row};
      for (std::size_t x = 0; x < row; ++x) {
        const std::size_t columns[3] = {x > 0 ? x - 1 : 0, x, std::min(x + 1, row - 1)};
        constexpr int kWeights[3] = {1, 2, 1};
        int gx = 0, gy = 0, gz = 0;
        for (int k = 0; k < 3; ++k) {
          gx += kWeights[k] * (sum[rows[k] + columns[2]] - sum[rows[k] + columns[0]]);
          gy += kWeights[k] * (sum[rows[2] + columns[k]] - sum[rows[0] + columns[k]]);
          for (int j = 0; j < 3; ++j) gz += kWeights[k] * kWeights[j] * difference[rows[k] + columns[j]];
        }
        const float length =
            std::sqrt(static_cast<float>(gx) * gx + static_cast<float>(gy) * gy + static_cast<float>(gz) * gz);
        std::uint8_t* to = gradients.data() + (z * slice + y * row + x) * 4;
        const auto byte = [&](int g) {
          return static_cast<std::uint8_t>(127.5f + (length > 0 ? 127.5f * static_cast<float>(g) / length : 0.0f));
        };
        to[0] = byte(gx);
        to[1] = byte(gy);
        to[2] = byte(gz);
        // The weights add up to 16 on each side, over a distance of 2 voxels.
        constexpr float kLongest = 255 * 32 * 0.866025404f;
        to[3] = static_cast<std::uint8_t>(std::min(std::ceil(length / kLongest * 255), 255.0f));
      }
    }
  });
  return gradients;
}

VoxelRanges voxel_ranges(const std::vector<std::uint8_t>& voxels, const Size& size, std::uint32_t components) {
  VoxelRanges result;
  for (std::size_t i = 0; i < 3; ++i) result.blocks[i] = (size[i] + VoxelRanges::kBlock - 1) / VoxelRanges::kBlock;
  if (components == 1) {
    result.intensities = ranges_of(voxels.data(), 1, size, result.blocks);
    return result;
  }
  const std::vector<std::uint8_t> intensities = intensities_of(voxels, components);
  result.intensities = ranges_of(intensities.data(), 1, size, result.blocks);
  if (components == 2 || components == 4)
    result.alphas = ranges_of(voxels.data() + components - 1, components, size, result.blocks);
  return result;
}

std::vector<std::uint8_t> occupied_blocks(const VoxelRanges& ranges, const VolumeLook& look) {
  std::vector<std::uint8_t> occupied(ranges.intensities.size(), 0);
  if (look.iso_surfaces) {
    for (std::size_t i = 0; i < occupied.size(); ++i)
      for (const float value : look.surfaces) {
        const float low = static_cast<float>(ranges.intensities[i][0]) / 255,
                    high = static_cast<float>(ranges.intensities[i][1]) / 255;
        if (low < value && value <= high) occupied[i] = 255;
      }
    return occupied;
  }
  // Number of visible intensities up to each one, summed over the chains.
  std::vector<std::uint32_t> visible(257, 0);
  std::vector<VolumeChain> chains = look.chains;
  if (chains.empty() || look.segments) chains.emplace_back();  // segments without a chain have the default style
  bool by_alpha = !ranges.alphas.empty();
  for (const VolumeChain& chain : chains) {
    if (chain.projected || has_blend(chain.steps)) return {};
    for (const VolumeStep& step : chain.steps)
      if (step.kind == VolumeStep::Kind::opacity_map && step.tables[0] && (by_alpha || look.voxels->components > 1))
        return {};
    const std::vector<bool> seen = visible_intensities(chain.steps);
    for (std::size_t v = 0; v < 256; ++v) visible[v + 1] += seen[v] ? 1 : 0;
  }
  for (std::size_t v = 0; v < 256; ++v) visible[v + 1] += visible[v];
  for (std::size_t i = 0; i < occupied.size(); ++i) {
    const auto& range = by_alpha ? ranges.alphas[i] : ranges.intensities[i];
    // An interpolated intensity lies between two bytes.
    const std::size_t low = range[0], high = std::min<std::size_t>(range[1] + std::size_t{1}, 256);
    occupied[i] = by_alpha ? (range[1] > 0 ? 255 : 0) : visible[high] > visible[low] ? 255 : 0;
  }
  return occupied;
}

}  // namespace gs::render
