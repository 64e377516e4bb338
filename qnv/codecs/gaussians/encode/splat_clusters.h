#pragma once

#include "qnv/codecs/gaussians/encode/merge_tree.h"
#include "qnv/codecs/gaussians/splat_cluster.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace gs::qnv::gaussians {

/// Encoded cluster with the numbers for its place in the stream.
struct EncodedCluster {
  ClusterHead head;
  std::vector<std::byte> bytes;        // without the head
  std::vector<SplatNode> nodes;        // as decoded
  std::vector<std::uint32_t> sources;  // indexes of the Gaussians of the leaves, in order
  double gain = 0;                     // reduction of the squared error
  std::uint32_t replaced = 0;          // number of Gaussians that it replaces
};

/// Encodes a tree as clusters of at most kMostClusterBytes with their heads, in order of their gain per byte; parents
/// come first. Ends early if `take` returns false. Returns false if it is cancelled.
bool encode_clusters(const Gaussians& source, const MergeTree& tree, const Precision& precision,
                     const std::function<bool(EncodedCluster&&)>& take, Progress* progress);

}  // namespace gs::qnv::gaussians
