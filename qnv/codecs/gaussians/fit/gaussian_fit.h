#pragma once

#include "base/parallel.h"
#include "qnv/codecs/gaussians/fit/fit_painter.h"
#include "qnv/codecs/gaussians/fit/fit_views.h"

#include <cstdint>
#include <span>
#include <vector>

namespace gs::qnv::gaussians {

/// Changes Gaussians so that their pictures become more like those of the leaves: gradient descent (Adam) on the
/// squared error, as 3DGS optimises. `free` has the indices of the Gaussians that may change; the others are visible,
/// too. `detail` is the least standard deviation. Returns false if it is cancelled. Gives equal results for any number
/// of threads.
bool fit_gaussians(std::vector<FitGaussian>& gaussians, std::span<const std::uint32_t> free, const FitViews& views,
                   float detail, unsigned threads, Progress* progress);

}  // namespace gs::qnv::gaussians
