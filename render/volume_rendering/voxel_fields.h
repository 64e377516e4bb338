#pragma once

#include "render/image/image.h"
#include "render/scene/volume_look.h"

#include <array>
#include <cstdint>
#include <vector>

// Numbers derived from volumes, on the processor. Arrays begin at the bottom row of the first slice.
namespace gs::render {

/// Returns the components of an image bottom up, so that texture coordinates of X3D address them. Sides above
/// `most_side` are sampled coarser; `size` receives the result's sides.
[[nodiscard]] std::vector<std::uint8_t> upright_voxels(const Image& image, std::uint32_t most_side,
                                                       std::array<std::uint32_t, 3>& size);

/// Returns the gradients of the intensities (the mean of colours) as RGBA: the direction to larger values, from -1 to 1
/// as 0 to 255, and the length: 255 is half the diagonal of a unit cube. Lengths are per voxel. Smoothed by a Sobel
/// kernel. `voxels` are those of upright_voxels().
[[nodiscard]] std::vector<std::uint8_t> voxel_gradients(const std::vector<std::uint8_t>& voxels,
                                                        const std::array<std::uint32_t, 3>& size,
                                                        std::uint32_t components);

/// Smallest and largest values that interpolation can give in each block of kBlock voxels a side.
struct VoxelRanges {
  static constexpr std::uint32_t kBlock = 8;
  std::array<std::uint32_t, 3> blocks{};
  std::vector<std::array<std::uint8_t, 2>> intensities, alphas;  // `alphas` is empty if intensities are opacities
};
[[nodiscard]] VoxelRanges voxel_ranges(const std::vector<std::uint8_t>& voxels,
                                       const std::array<std::uint32_t, 3>& size, std::uint32_t components);

/// Returns 255 for each block in which a look may show anything, otherwise 0. Returns an empty list if the look cannot
/// skip blocks.
[[nodiscard]] std::vector<std::uint8_t> occupied_blocks(const VoxelRanges& ranges, const VolumeLook& look);

}  // namespace gs::render
