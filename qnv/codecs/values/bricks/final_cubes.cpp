#include "qnv/codecs/values/bricks/final_cubes.h"

#include "qnv/codecs/values/stored_code.h"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>

namespace gs::qnv::values {

namespace {

/// Indices from `first` to `last`.
struct IndexRange {
  std::uint32_t first = 0, last = 0;
};

// Returns the blocks of an axis that the samples from `first` on of a cube depend on. The inverse lifting reaches
// kBrickMargin samples.
IndexRange blocks_of_cube(std::uint32_t first, std::uint32_t blocks) {
  constexpr std::uint32_t kBlockSamples = 2 * kBlockEdge;
  return {(first - std::min(first, kBrickMargin)) / kBlockSamples,
          std::min((first + kCubeEdge - 1 + kBrickMargin) / kBlockSamples, blocks - 1)};
}

// Returns the coarser samples of an axis that a cube depends on.
IndexRange coarser_of_cube(std::uint32_t first, std::uint32_t coarser, bool halved) {
  if (!halved) return {first, std::min(first + kCubeEdge, coarser) - 1};
  return {first >= kCubeEdge ? (first - 2) / 2 : 0, std::min((first + 2 * kCubeEdge - 2) / 2, coarser - 1)};
}

template <class Test>
bool all_of_box(const std::array<IndexRange, 3>& box, std::uint32_t step, const Test& test) {
  for (std::uint32_t z = box[2].first; z <= box[2].last; z += step)
    for (std::uint32_t y = box[1].first; y <= box[1].last; y += step)
      for (std::uint32_t x = box[0].first; x <= box[0].last; x += step)
        if (!test(x, y, z)) return false;
  return true;
}

// Lets a range of samples begin at a cube, so that steps of a cube find all cubes of the range.
IndexRange from_cube(IndexRange range) { return {range.first / kCubeEdge * kCubeEdge, range.last}; }

}  // namespace

CubeFlags final_cubes(const BrickLayout& layout, const BrickName& name, const CubeFlags* coarser,
                      const std::function<bool(std::uint64_t block)>& whole) {
  const SampleBox box = layout.extended(name);
  CubeFlags cubes(box, true);
  const Extent count = layout.blocks().blocks_of(name.level + 1), own = layout.extent(name.level),
               low = layout.extent(name.level + 1);
  // Blocks around the brick, x first.
  Extent first{}, size{};
  for (std::size_t a = 0; a < 3; ++a) {
    first[a] = blocks_of_cube(box.first[a], count[a]).first;
    size[a] = blocks_of_cube(box.first[a] + (cubes.count[a] - 1) * kCubeEdge, count[a]).last + 1 - first[a];
  }
  std::vector<std::uint8_t> blocks;
  for (std::uint32_t z = 0; z < size[2]; ++z)
    for (std::uint32_t y = 0; y < size[1]; ++y)
      for (std::uint32_t x = 0; x < size[0]; ++x)
        blocks.push_back(
            whole(layout.blocks().number(name.level + 1, {first[0] + x, first[1] + y, first[2] + z})) ? 1 : 0);
  const auto block_whole = [&](std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    return blocks[(std::size_t{z - first[2]} * size[1] + (y - first[1])) * size[0] + (x - first[0])] != 0;
  };
  const auto coarser_final = [&](std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    return coarser->is_set(x, y, z);
  };
  const bool all_whole = std::ranges::all_of(blocks, [](std::uint8_t one) { return one != 0; });
  const bool all_coarser =
      !coarser || std::ranges::all_of(coarser->flags, [](std::uint8_t one) { return one != 0; });
  if (all_whole && all_coarser) return cubes;
  std::size_t i = 0;
  for (std::uint32_t z = 0; z < cubes.count[2]; ++z)
    for (std::uint32_t y = 0; y < cubes.count[1]; ++y)
      for (std::uint32_t x = 0; x < cubes.count[0]; ++x, ++i) {
        const Extent at{box.first[0] + x * kCubeEdge, box.first[1] + y * kCubeEdge, box.first[2] + z * kCubeEdge};
        std::array<IndexRange, 3> near{}, below{};
        for (std::size_t a = 0; a < 3; ++a) {
          near[a] = blocks_of_cube(at[a], count[a]);
          below[a] = from_cube(coarser_of_cube(at[a], low[a], own[a] > 1));
        }
        const bool final = (all_whole || all_of_box(near, 1, block_whole)) &&
                           (all_coarser || all_of_box(below, kCubeEdge, coarser_final));
        cubes.flags[i] = final ? 1 : 0;
      }
  return cubes;
}

VoxelType stored_type(const ValueGrid& grid) {
  if (!is_integer(grid.stored)) return VoxelType::f32;
  return grid.stored == VoxelType::u32 ? VoxelType::u32 : VoxelType::i32;
}

void apply_remainders(const ValueGrid& grid, const CubeFlags& cubes, std::span<const std::int32_t> raw,
                      std::span<const std::uint32_t> remainders, std::span<std::int32_t> samples) {
  const StoredCodes codes(grid);
  const bool floats = stored_type(grid) == VoxelType::f32;
  const SampleBox& box = cubes.box;
  std::size_t i = 0;
  for (std::uint32_t z = box.first[2]; z < box.first[2] + box.size[2]; ++z)
    for (std::uint32_t y = box.first[1]; y < box.first[1] + box.size[1]; ++y)
      for (std::uint32_t x = box.first[0]; x < box.first[0] + box.size[0]; ++x, ++i) {
        std::int32_t& sample = samples[i];
        const bool final = cubes.is_set(x, y, z);
        if (sample == kMissingInBrick) {
          if (grid.exact && floats) sample = std::bit_cast<std::int32_t>(std::numeric_limits<float>::quiet_NaN());
        } else if (grid.exact) {
          const std::uint32_t code = codes(final ? raw[i] : sample) + (final ? remainders[i] : 0);
          sample = floats ? std::bit_cast<std::int32_t>(number_of_code(code)) : static_cast<std::int32_t>(code);
        } else if (final) {
          sample = static_cast<std::int32_t>(static_cast<std::uint32_t>(raw[i]) + remainders[i] * grid.correction);
        }
      }
}

}  // namespace gs::qnv::values
