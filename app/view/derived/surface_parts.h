#pragma once

#include "app/view/values/volume_grid.h"

#include <memory>
#include <vector>

namespace gs::app {

/// Returns the grid and its finer parts as volumes for isosurfaces. Each cell between voxels belongs to one part:
/// the other parts lack one of its voxels. A part begins and ends at voxels of the coarser one around it, so that the
/// surfaces meet where these have the same values. All share the ownership of the grid. Needs VolumeGrid::step() 1.
[[nodiscard]] std::vector<qnv::VolumeSource> surface_parts(const std::shared_ptr<const VolumeGrid>& grid);

}  // namespace gs::app
