#pragma once

#include "qnv/mesh/manifold.h"

#include <cstddef>
#include <functional>

namespace gs::qnv::displaced {

/// Returns a mesh of about `triangles` triangles close to another one. Collapses edges, least quadric error first
/// (Garland and Heckbert 1997), and short ones among equals, so that triangles stay compact. No part is cut off, and
/// every component keeps at least a tetrahedron or a triangle, so the result may have more triangles than requested.
/// The topology is kept, except that holes and tunnels too small to be visible at the requested size are closed. `mesh`
/// and the result are as MeshBuilder::finish() returns them. `threads`: number of threads, 0: one per core; the result
/// does not depend on it. `beside`: other work that is done when this returns; it gets a thread during the last,
/// single-threaded part.
[[nodiscard]] SurfaceMesh simplify(const SurfaceMesh& mesh, std::size_t triangles, unsigned threads = 0,
                                   const std::function<void()>& beside = {});

}  // namespace gs::qnv::displaced
