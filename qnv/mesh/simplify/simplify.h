#pragma once

#include "qnv/mesh/manifold.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace gs::qnv::displaced {

/// Processes that simplify the same mesh together.
struct SimplifyRanks {
  std::uint32_t rank = 0, count = 1;
  /// Returns the bytes of all processes, in the order of their ranks.
  std::function<std::vector<std::byte>(std::span<const std::byte>)> gather;
};

/// Returns a mesh with about `triangles` triangles that is close to `mesh`. Collapses the edge with the least quadric
/// error first (Garland and Heckbert 1997); prefers short edges among equals, so that triangles stay compact.
/// No part is cut off. Every component keeps at least a tetrahedron or a triangle, so that the result may have more
/// triangles than requested. The topology stays the same, except that holes and tunnels are closed if they are too
/// small to be visible at the requested size.
/// MeshBuilder::finish() defines the properties of `mesh` and of the result. `threads` is the number of threads (0
/// means one per core); the result does not depend on it. `beside` is other work that is complete on return; it gets a
/// thread during the last, single-threaded part. `ranks` share the parallel part. Rank 0 does the rest and `beside`;
/// other ranks return an empty mesh.
[[nodiscard]] SurfaceMesh simplify(const SurfaceMesh& mesh, std::size_t triangles, unsigned threads = 0,
                                   const std::function<void()>& beside = {}, const SimplifyRanks& ranks = {});

}  // namespace gs::qnv::displaced
