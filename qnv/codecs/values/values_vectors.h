#pragma once

namespace gs::qnv {

/// Share of the voxels of a values stream that are drawn as vectors, by default (paper, section 2.1).
inline constexpr double kShownFraction = 0.09;

}  // namespace gs::qnv
