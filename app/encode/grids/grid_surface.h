#pragma once

#include "app/encode/grids/large_grid.h"
#include "app/encode/mesh_stream.h"
#include "qnv/codecs/shared/shared_records.h"

#include <cstdint>
#include <variant>

namespace gs::app {

/// Returns the surface of a grid that exceeds memory: outer faces of solid cells, polygons and strips, in the colours
/// of the shown array. Lines and vertices are left out. Ranks share the cells. All ranks return the same triangles,
/// which they read from their store; it must outlive the result. The triangles do not depend on the number of ranks or
/// on `memory`. Collective.
[[nodiscard]] std::variant<MeshStream, qnv::EncodeError> grid_surface(const LargeGrid& grid, qnv::EncodeRanks& shared,
                                                                      std::uint64_t memory, Progress* progress);

}  // namespace gs::app
