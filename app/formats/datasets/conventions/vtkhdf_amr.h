#pragma once

#include "app/formats/datasets/arrays/dataset_tree.h"
#include "app/formats/datasets/conventions/dataset_file.h"

#include <string>
#include <vector>

// OverlappingAMR of VTKHDF: https://docs.vtk.org/en/latest/vtk_file_formats/vtkhdf_file_format/index.html
namespace gs::app {

/// Lists the arrays of the file. A cell array of level 0 represents all levels.
[[nodiscard]] std::vector<DatasetEntry> list_vtkhdf_amr(DatasetTree& tree);
/// Opens an array of cells as a volume with the voxels of the finest level that is not too large. The finest
/// level wins where levels overlap. Finer levels are sampled at the voxel centres. Returns a message on failure.
[[nodiscard]] VolumeResult vtkhdf_amr_volume(DatasetTree& tree, const DatasetEntry& entry,
                                             const VoxelComponent& choice);

}  // namespace gs::app
