#include "qnv/codecs/octree/lod/lod_whole.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace gs::qnv {

std::size_t LodWhole::visit(const OnVoxels& on_voxels) {
  const std::uint32_t root = chunks_.tree().root();
  if (root == kNoNode || !chunks_.tree()[root].present || chunks_.tree()[root].broken) return discs_;
  DecodedCluster decoded = chunks_.decode(root, nullptr);
  if (decoded.cluster)
    visit_below(root, *decoded.cluster, on_voxels);
  else
    chunks_.reject(root, std::move(decoded.problem));
  return discs_;
}

// Visits the descendants of a cluster, then the cluster. The recursion is no deeper than the octree.
void LodWhole::visit_below(std::uint32_t index, const Cluster& cluster, const OnVoxels& on_voxels) {
  const LodTree& tree = std::as_const(chunks_).tree();
  std::vector<std::uint32_t> children;
  for (std::uint32_t child = tree[index].first_child; child != kNoNode; child = tree[child].next_sibling)
    if (tree[child].present && !tree[child].broken) children.push_back(child);
  std::reverse(children.begin(), children.end());  // in the order in which the chunks were received
  const PackedVoxels& voxels = cluster.voxels;
  std::vector<bool> divided(voxels.size());
  for (const std::uint32_t child : children) {
    DecodedCluster decoded = chunks_.decode(child, &cluster);
    if (!decoded.cluster) {
      chunks_.reject(child, std::move(decoded.problem));
      continue;
    }
    const auto first = divided.begin() + decoded.cluster->header.first, last = first + decoded.cluster->header.count;
    if (std::find(first, last, true) != last || decoded.discs > most_discs_ - std::min(most_discs_, discs_)) {
      cut_short_ = true;
      continue;
    }
    std::fill(first, last, true);
    visit_below(child, *decoded.cluster, on_voxels);
  }
  for (std::size_t i = 0, end = 0; i < voxels.size(); i = end) {
    while (end < voxels.size() && divided[end] == divided[i]) ++end;
    if (divided[i]) continue;
    discs_ += discs_of(voxels, i, end - i);
    on_voxels(cluster, i, end - i);
  }
}

}  // namespace gs::qnv
