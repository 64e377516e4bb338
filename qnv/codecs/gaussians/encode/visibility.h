#pragma once

#include "base/parallel.h"
#include "qnv/base/geometry.h"

#include <vector>

namespace gs::qnv::gaussians {

/// Returns how visible each Gaussian is: the root mean square of the light that passes what is in front of it, from
/// kLeastVisibility to 1. The views are around the scene and at free places inside it; those that show more of a
/// Gaussian count. Errors of pictures by changes of a Gaussian are proportional to this number. Expects finite numbers.
/// Returns an empty list if it is cancelled. Gives equal results for any number of threads.
[[nodiscard]] std::vector<float> visibility_of(const Gaussians& source, unsigned threads, Progress* progress);

/// Least visibility, because other views may show hidden Gaussians.
inline constexpr float kLeastVisibility = 0.05f;

}  // namespace gs::qnv::gaussians
