#pragma once

#include "qnv/base/geometry.h"

#include <cstddef>

namespace gs::app {

/// Appends all splats of `from` to `to`. If `to` is empty, it takes over the origin of `from`. The degree of the
/// harmonics becomes the larger of both; missing coefficients are 0. Updates box and total. Any thread.
void append_splats(qnv::Gaussians& to, const qnv::Gaussians& from);

/// Returns `count` splats from index `first` on, with origin and metadata. Any thread.
[[nodiscard]] qnv::Gaussians range_of_splats(const qnv::Gaussians& from, std::size_t first, std::size_t count);

/// Reserves memory for a number of splats with harmonics of `degree`, and sets the degree. `to` must be empty.
void reserve_splats(qnv::Gaussians& to, std::size_t count, int degree);

}  // namespace gs::app
