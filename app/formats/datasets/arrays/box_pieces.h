#pragma once

#include "qnv/sampling/volume/volume.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>

namespace gs::app {

/// Part of a box that one request reads.
struct BoxPiece {
  std::array<std::uint32_t, 3> at{}, samples{};  // index of its first sample in the box, and samples per axis
  qnv::VoxelBox voxels{};                        // all voxels from its first sample to its last one
};

/// Divides a box into pieces along the borders of chunks, so that no chunk is decoded twice and no piece reads chunks
/// without samples. Without chunks (edges of 0), the rows of voxels are chunks. Pieces of many small chunks are joined.
/// Calls `read` for each one until it returns false. `number` are the bytes of a voxel. Returns the last result.
bool for_each_piece(const qnv::VoxelBox& box, const std::array<std::uint32_t, 3>& chunk, std::size_t number,
                    const std::function<bool(const BoxPiece&)>& read);

}  // namespace gs::app
