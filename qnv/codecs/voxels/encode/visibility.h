#pragma once

#include "qnv/codecs/voxels/encode/voxels_quantize.h"

#include <span>
#include <vector>

namespace gs::qnv {

/// Sets TrueVoxel::seen of the finest voxels: the approximate fraction of the ambient light that reaches them.
/// `depth_of_class` is the optical depth of a vector of each class.
void find_seen(std::span<TrueVoxel> voxels, const VoxelLattice& lattice, std::span<const float> depth_of_class,
               unsigned threads);

}  // namespace gs::qnv
