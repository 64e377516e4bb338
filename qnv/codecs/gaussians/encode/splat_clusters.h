#pragma once

#include "qnv/codecs/gaussians/encode/fitted_nodes.h"
#include "qnv/codecs/gaussians/encode/merge_tree.h"
#include "qnv/codecs/gaussians/splat_cluster.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

namespace gs::qnv::gaussians {

/// Encoded cluster with the numbers for its place in the stream.
struct EncodedCluster {
  ClusterHead head;
  std::vector<std::byte> bytes;        // without the head
  std::vector<SplatNode> nodes;        // as decoded
  std::vector<std::uint32_t> places;   // indices of the nodes in the tree
  std::vector<std::uint32_t> parents;  // indices of the replaced nodes, or kNone; equal to `places` if unchanged
  double gain = 0;                     // reduction of the squared error
  std::uint32_t replaced = 0;          // number of Gaussians that it replaces
};

/// Returns the sort key of a chunk: its gain per byte. Adds 60 bytes for the overhead besides the payload.
[[nodiscard]] inline double use_of(double gain, std::size_t bytes) { return gain / (static_cast<double>(bytes) + 60); }

/// Cluster that may be divided further.
struct OpenCluster {
  ClusterHead head;
  std::vector<SplatNode> nodes;
  std::vector<std::uint32_t> places;  // indices of the nodes in the tree
  std::shared_ptr<const SplatModels> models;
};

/// Consecutive Gaussians of a cluster that is divided.
struct OpenRange {
  OpenCluster cluster;
  std::size_t from = 0, to = 0;
};

/// Tree to be encoded, and parameters that all trees of a stream share.
struct ClusterWork {
  const Gaussians& source;  // of the leaves
  const MergeTree& tree;
  const Precision& precision;
  std::uint32_t first_id = 0;  // identifier of the first cluster
  float first_error = 0;       // largest error of a Gaussian of the first cluster
  const FittedNodes* fitted = nullptr;  // null means that all nodes keep their moments
};

/// Encodes the parts of a tree below ranges of Gaussians as clusters of at most kMostClusterBytes with their heads, in
/// order of their gain per byte; parents come first. Without ranges, encodes the whole tree and sets `first_error`.
/// Ends early if `take` returns false. If `given` is not null, it gets the clusters with only leaves and nodes of the
/// initial forest (MergeTree::given). These clusters are not divided. Returns false if it is cancelled.
bool encode_clusters(ClusterWork& work, std::vector<OpenRange> ranges,
                     const std::function<bool(EncodedCluster&&)>& take, std::vector<OpenCluster>* given,
                     Progress* progress);

}  // namespace gs::qnv::gaussians
