#pragma once

#include "qnv/base/description.h"
#include "qnv/codecs/values/labels/decode/label_levels.h"
#include "qnv/container/value_grid.h"
#include "qnv/sampling/volume/volume.h"
#include "qnv/sampling/volume/volume_values.h"

#include <cstdint>
#include <memory>
#include <optional>

namespace gs::qnv::values {

/// Returns the labels of a level as values. `in_order` is the number of chunks from the start of the stream, or nullopt
/// if one of them was lost or refused.
[[nodiscard]] std::shared_ptr<VolumeValues> label_values(const ValueGrid& grid, const Description& about,
                                                         const LabelLevels& levels, int level,
                                                         std::optional<std::uint32_t> in_order);

/// Returns the labels of a level as a volume of stored numbers, 4 bytes each. Voxels without data get the background:
/// the number 0, or the first label. The centres of coarse voxels are those of the voxels that they stand for.
[[nodiscard]] VolumeSource label_source(const ValueGrid& grid, const Description& about, const LabelLevels& levels,
                                        int level);

}  // namespace gs::qnv::values
