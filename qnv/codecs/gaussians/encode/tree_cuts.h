#pragma once

#include "qnv/codecs/gaussians/encode/merge_tree.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace gs::qnv::gaussians {

/// Ratio of the errors of a level of a stream to the errors of the next level.
inline constexpr float kErrorRatio = 6;
/// Maximum number of Gaussians of the first cluster, and usual maximum number of children of one Gaussian.
inline constexpr std::size_t kFirstNodes = 60, kUsualChildren = 16;

/// Returns the maximum error of the Gaussians that replace those of a level. `first` is the maximum error of level 0.
[[nodiscard]] inline float error_below(float first, std::uint32_t level) {
  return first * std::pow(kErrorRatio, -static_cast<float>(level + 1));
}
/// Returns up to `most` nodes that replace a node: divides the worst one while its error exceeds `least`. If a node has
/// few leaves, returns all of them. Keeps the order of the tree, so that neighbours stay together.
[[nodiscard]] std::vector<std::uint32_t> parts_of(const MergeTree& tree, std::uint32_t place, float least,
                                                  std::size_t most);

}  // namespace gs::qnv::gaussians
