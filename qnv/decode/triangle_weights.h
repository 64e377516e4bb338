#pragma once

#include "qnv/base/cloud.h"

#include <cstddef>

namespace gs::qnv {

/// Gives the vectors from number `start` on, which have no weights yet, a third of the area of the triangles round
/// them: those from index `first` of `cloud.triangles` on.
void weigh_by_triangles(Cloud& cloud, std::size_t start, std::size_t first);

}  // namespace gs::qnv
