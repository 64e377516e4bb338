#pragma once

#include "qnv/base/geometry.h"

#include <cstddef>

namespace gs::qnv {

/// Sets the weights of the vertices from number `start` on to a third of the area of their triangles. Uses the
/// triangles from index `first` of `mesh.triangles` on.
void weigh_by_triangles(IndexedMesh& mesh, std::size_t start, std::size_t first);

}  // namespace gs::qnv
