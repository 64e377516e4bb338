#pragma once

#include "net/cells/cell_contract.h"
#include "net/cells/cell_source.h"
#include "qnv/base/description.h"
#include "qnv/codecs/shared/lod_view.h"

#include <span>
#include <vector>

namespace gs::app {

/// Converts a box to the units of a cell server: 1/65535 of the box `all` of the stream. Rounds outwards.
[[nodiscard]] net::CellBox cell_box(const Box& box, const Box& all);

/// Returns the regions of a stream that are visible in `views`, at most net::kMaxRegions. `all` is the box of the
/// stream. Each view gives one region, which may be up to an eighth too large on each side. A view of nothing or of
/// nearly everything gives none. All boxes and views are in node space.
[[nodiscard]] std::vector<net::Region> regions_of(std::span<const qnv::LodView> views, const Box& all);

}  // namespace gs::app
