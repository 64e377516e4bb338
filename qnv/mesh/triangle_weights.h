#pragma once

#include "qnv/base/cloud.h"

#include <cstddef>

namespace gs::qnv {

/// Sets the weights of the vectors from number `start` on to a third of the area of their triangles. Uses the triangles
/// from index `first` of `cloud.triangles` on.
void weigh_by_triangles(Cloud& cloud, std::size_t start, std::size_t first);

}  // namespace gs::qnv
