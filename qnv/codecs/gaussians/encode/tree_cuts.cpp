#include "qnv/codecs/gaussians/encode/tree_cuts.h"

#include "qnv/codecs/gaussians/cluster_code.h"

#include <algorithm>

namespace gs::qnv::gaussians {
namespace {

// If a Gaussian has at most this many leaves, all of them replace it.
constexpr std::uint32_t kFewLeaves = 6;

}  // namespace

std::vector<std::uint32_t> parts_of(const MergeTree& tree, std::uint32_t place, float least, std::size_t most) {
  if (tree[place].leaves <= kFewLeaves && tree[place].error > least) {
    least = -1;
    most = kMostChildren;
  }
  std::vector<std::uint32_t> parts{place};
  const auto error = [&](std::uint32_t i) { return tree[i].leaf() || tree[i].outside() ? -2.0f : tree[i].error; };
  while (parts.size() < most) {
    const auto worst = std::ranges::max_element(parts, {}, error);
    if (!(error(*worst) > least)) break;
    const MergedNode& node = tree[*worst];
    *worst = node.left;
    parts.insert(worst + 1, node.right);
  }
  return parts;
}

}  // namespace gs::qnv::gaussians
