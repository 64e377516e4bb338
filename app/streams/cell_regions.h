#pragma once

#include "net/cells/cell_contract.h"
#include "net/cells/cell_source.h"
#include "qnv/base/description.h"
#include "qnv/codecs/octree/lod/lod.h"

#include <span>
#include <vector>

namespace gs::app {

/// Returns a box in the coordinates of a cell server: 1/65535 of the stream's box `all`, rounded outwards.
[[nodiscard]] net::CellBox cell_box(const Box& box, const Box& all);

/// Returns the regions of a stream with the box `all` that these views see, at most net::kMaxRegions. Each view has
/// one region, which may be an eighth too large on each side. Views that see nothing or nearly everything add none.
/// Node space, as the views are.
[[nodiscard]] std::vector<net::Region> regions_of(std::span<const qnv::LodView> views, const Box& all);

}  // namespace gs::app
