#pragma once

#include "base/parallel.h"
#include "qnv/base/geometry.h"

#include <vector>

namespace gs::qnv::gaussians {

/// Returns the visibility of each Gaussian, from kLeastVisibility to 1: the root mean square of the light that reaches
/// it. Views are around the scene and at free positions inside; the larger of both means counts. Errors of pictures by
/// changes of a Gaussian are proportional to its visibility. Expects finite numbers. Returns an empty list if it is
/// cancelled. Gives equal results for any number of threads.
[[nodiscard]] std::vector<float> visibility_of(const Gaussians& source, unsigned threads, Progress* progress);

/// Least visibility, because other views may show hidden Gaussians.
inline constexpr float kLeastVisibility = 0.05f;

}  // namespace gs::qnv::gaussians
