#pragma once

#include "net/cells/cell_contract.h"
#include "net/cells/cell_source.h"
#include "qnv/base/cloud.h"
#include "qnv/lod/lod.h"

#include <span>
#include <vector>

namespace gs::app {

/// A box as a server of cells names it: in 1/65535 of the stream's own box `all`, rounded outwards.
[[nodiscard]] net::CellBox cell_box(const qnv::Box& box, const qnv::Box& all);

/// What of a stream with the box `all` these views see, each as one region that may be an eighth too large on each
/// side, at most net::kMostRegions of them. Views that see nothing or nearly everything of it have none. Node space, as
/// the views are.
[[nodiscard]] std::vector<net::Region> regions_of(std::span<const qnv::LodView> views, const qnv::Box& all);

}  // namespace gs::app
