#pragma once

#include "app/encode/grids/large_grid.h"
#include "app/encode/mesh_stream.h"
#include "qnv/codecs/shared/shared_records.h"

#include <cstdint>
#include <variant>

namespace gs::app {

/// Returns the surface of a grid that exceeds memory: outer faces of solid cells, polygons and strips, in the colours
/// of the shown array. Leaves out lines and vertices. Ranks share the cells. All ranks return the same triangles, for
/// every number of ranks and every `memory`. The result reads them from the store of `shared`, which must outlive it.
/// Collective.
[[nodiscard]] std::variant<MeshStream, qnv::EncodeError> grid_surface(const LargeGrid& grid, qnv::EncodeRanks& shared,
                                                                      std::uint64_t memory, Progress* progress);

}  // namespace gs::app
