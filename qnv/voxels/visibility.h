#pragma once

#include "qnv/voxels/voxels_quantize.h"

#include <span>
#include <vector>

namespace gs::qnv {

/// Fills TrueVoxel::seen of the voxels of the finest level: which part of the light that comes from all around reaches
/// them, about. `depth_of_class`: the optical depth of a vector by its class.
void find_seen(std::span<TrueVoxel> voxels, const VoxelLattice& lattice, std::span<const float> depth_of_class,
               unsigned threads);

}  // namespace gs::qnv
