#pragma once

#include "base/budget.h"
#include "base/parallel.h"
#include "qnv/sampling/volume/volume_values.h"

#include <memory>

namespace gs::app {

/// Reads all voxels of a volume into memory, with all components, for later display of their values. Returns null if
/// the budget does not suffice, the source cannot be read, or `progress` is cancelled.
[[nodiscard]] std::shared_ptr<const qnv::VolumeValues> hold_values(const qnv::VolumeSource& source,
                                                                   const WorldBudget& budget, const Progress& progress);

}  // namespace gs::app
