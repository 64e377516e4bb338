#pragma once

#include "qnv/base/geometry.h"
#include "qnv/codecs/values/bricks/brick_cache.h"

#include <functional>
#include <span>

namespace gs::qnv::values {

/// Function that returns a brick, or null.
using FindBrick = std::function<const Brick*(const BrickName&)>;

/// Returns the vectors of a volume with the finest bricks in place of coarser vectors. `base` are the vectors of the
/// whole volume at the level of BrickLayout::base(). `chosen` are bricks that `find` knows, each after the one that
/// contains it. All bricks of a level share one minimum length, which keeps the same share of voxels as the coarser
/// vectors there. Coarse lengths are scaled to those of the finest level. The longest vectors come first, as in
/// CellVectors.
[[nodiscard]] Volume merge_bricks(const Volume& base, const BrickLayout& layout, std::span<const VolumeLayout> levels,
                                  std::span<const BrickName> chosen, const FindBrick& find);

}  // namespace gs::qnv::values
