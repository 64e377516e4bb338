#pragma once

#include "qnv/displaced/manifold.h"

#include <cstddef>
#include <functional>

namespace gs::qnv::displaced {

/// A mesh of about `triangles` triangles that lies close to another: edges are collapsed, the least quadric error first
/// (Garland and Heckbert 1997), and short ones among equals, so that triangles stay compact. No part is cut off,
/// and every component keeps at least a tetrahedron or a triangle, so that more triangles may be left than were asked
/// for. The topology stays, but for holes and tunnels too small to be seen in what was asked for: they are closed.
/// `mesh` is as `MeshBuilder::finish` gives it, and so is what comes back.
/// `threads`: that work on it, 0: one a core; what comes out does not depend on them. `beside`: something else to be
/// done by the time that this returns, which has a thread while the last part of the work is one for a single thread.
[[nodiscard]] SurfaceMesh simplify(const SurfaceMesh& mesh, std::size_t triangles, unsigned threads = 0,
                                   const std::function<void()>& beside = {});

}  // namespace gs::qnv::displaced
