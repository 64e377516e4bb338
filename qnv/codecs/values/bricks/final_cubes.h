#pragma once

#include "qnv/codecs/values/bricks/brick_places.h"
#include "qnv/codecs/values/bricks/received/cube_flags.h"
#include "qnv/container/value_grid.h"
#include "qnv/sampling/volume/voxel_type.h"

#include <cstdint>
#include <functional>
#include <limits>
#include <span>

namespace gs::qnv::values {

/// Sample of a missing voxel in a brick of level 0.
inline constexpr std::int32_t kMissingInBrick = std::numeric_limits<std::int32_t>::min();

/// Returns the cubes of a brick, with its margin, that no further chunk of the stream changes. `coarser` are those of
/// the samples that the brick comes from; null means all. `whole`(block) reports whether the brick uses all clusters of
/// a block.
[[nodiscard]] CubeFlags final_cubes(const BrickLayout& layout, const BrickName& name, const CubeFlags* coarser,
                                    const std::function<bool(std::uint64_t block)>& whole);

/// Applies remainders to the samples of a brick of level 0, in the cubes with flags. If they restore stored voxels, the
/// samples become stored numbers of stored_type(). `raw` are the samples without limits.
void apply_remainders(const ValueGrid& grid, const CubeFlags& cubes, std::span<const std::int32_t> raw,
                      std::span<const std::uint32_t> remainders, std::span<std::int32_t> samples);
/// Returns the type of stored numbers in a brick, which have 4 bytes.
[[nodiscard]] VoxelType stored_type(const ValueGrid& grid);

}  // namespace gs::qnv::values
