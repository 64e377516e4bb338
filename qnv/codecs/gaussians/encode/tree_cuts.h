#pragma once

#include "qnv/codecs/gaussians/encode/merge_tree.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace gs::qnv::gaussians {

/// Errors of a level of a stream, relative to those of the next one.
inline constexpr float kErrorRatio = 6;
/// Number of Gaussians of the first cluster, and usual limit of the children of one Gaussian.
inline constexpr std::size_t kFirstNodes = 60, kUsualChildren = 16;

/// Returns the largest error of the Gaussians that follow on those of a level. `first` is the largest error of level 0.
[[nodiscard]] inline float error_below(float first, std::uint32_t level) {
  return first * std::pow(kErrorRatio, -static_cast<float>(level + 1));
}
/// Returns the nodes that replace a node: those with errors of at most `least`, or all leaves if they are few. The
/// order is that of the tree, so that neighbours stay together.
[[nodiscard]] std::vector<std::uint32_t> parts_of(const MergeTree& tree, std::uint32_t place, float least,
                                                  std::size_t most);

}  // namespace gs::qnv::gaussians
