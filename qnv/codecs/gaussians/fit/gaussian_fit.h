#pragma once

#include "base/parallel.h"
#include "qnv/codecs/gaussians/fit/fit_painter.h"
#include "qnv/codecs/gaussians/fit/fit_views.h"

#include <cstdint>
#include <span>
#include <vector>

namespace gs::qnv::gaussians {

/// Fits Gaussians to the pictures of the leaves. Uses gradient descent (Adam) on the squared error, as 3DGS optimises.
/// Pictures show all Gaussians, but only those with indices in `free` change. `detail` is the minimum standard
/// deviation at the start. Returns false if it is cancelled. Gives equal results for any number of
/// threads.
bool fit_gaussians(std::vector<FitGaussian>& gaussians, std::span<const std::uint32_t> free, const FitViews& views,
                   float detail, unsigned threads, Progress* progress);

}  // namespace gs::qnv::gaussians
