#pragma once

#include "base/parallel.h"
#include "qnv/codecs/octree/packed.h"
#include "qnv/entropy/rans.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace gs::qnv {

// Parts of the encoders of surfaces and of volumes: exact voxels level by level, and the tree of their clusters.

/// Exact voxels of every level, and the index of each voxel's first child in the next level.
template <class Voxel>
class VoxelPyramid {
 public:
  /// `coarsen(fine, level)` makes the voxels of `level` from those of the next level.
  template <class Coarsen>
  VoxelPyramid(std::vector<Voxel> finest, int deepest, const Coarsen& coarsen) {
    levels_.resize(static_cast<std::size_t>(deepest) + 1);
    levels_.back() = std::move(finest);
    for (std::size_t i = levels_.size() - 1; i > 0; --i) levels_[i - 1] = coarsen(levels_[i], i - 1);
    for (std::size_t i = 0; i + 1 < levels_.size(); ++i) {
      auto& first = first_child_.emplace_back();
      first.reserve(levels_[i].size() + 1);
      std::uint32_t next = 0;
      for (const Voxel& voxel : levels_[i]) {
        first.push_back(next);
        while (next < levels_[i + 1].size() && levels_[i + 1][next].key >> 3 == voxel.key) ++next;
      }
      first.push_back(next);
    }
  }

  [[nodiscard]] int deepest() const { return static_cast<int>(levels_.size()) - 1; }
  /// Returns the children of each of these voxels of a level.
  [[nodiscard]] std::vector<std::span<const Voxel>> below(std::span<const std::uint32_t> voxels, int level) const {
    const auto at = static_cast<std::size_t>(level);
    std::vector<std::span<const Voxel>> out;
    out.reserve(voxels.size());
    for (const std::uint32_t voxel : voxels) {
      const std::uint32_t first = first_child_[at][voxel];
      out.push_back(std::span(levels_[at + 1]).subspan(first, first_child_[at][voxel + 1] - first));
    }
    return out;
  }
  /// Returns the indices of the children that symbols encode, below these voxels of a level.
  template <class Symbols>
  [[nodiscard]] std::vector<std::uint32_t> children_of(const Symbols& symbols, std::span<const std::uint32_t> voxels,
                                                       int level) const {
    std::vector<std::uint32_t> out;
    out.reserve(symbols.children.size());
    const auto& first = first_child_[static_cast<std::size_t>(level)];
    for (const auto& parent : symbols.parents)
      for (std::uint32_t i = first[voxels[parent.index]]; i < first[voxels[parent.index] + 1]; ++i) out.push_back(i);
    return out;
  }

 private:
  std::vector<std::vector<Voxel>> levels_;
  std::vector<std::vector<std::uint32_t>> first_child_;
};

/// Cluster while it is encoded. `Voxels` holds the voxels of a level as decoded.
template <class Voxels>
struct ClusterNode {
  EncodedCluster encoded;
  Voxels voxels;  // voxels as a decoder obtains them
  std::vector<std::uint32_t> truth;  // indices of the same voxels in their level of the pyramid
  int level = 0;  // level of the voxels
  double gain = 0;
  std::vector<std::unique_ptr<ClusterNode>> children;
};

/// Returns the header of the cluster that divides a run of a node's voxels.
template <class Node>
[[nodiscard]] ClusterHeader header_of_run(const Node& node, std::size_t first, std::size_t count) {
  ClusterHeader header;
  header.first = static_cast<std::uint16_t>(first);
  header.count = static_cast<std::uint16_t>(count);
  header.level = static_cast<std::uint8_t>(node.level);
  return header;
}

/// Encodes the symbols of a cluster's levels. `write_header(header, parameters, payload)` begins the payload. The
/// caller sets the box and the level's edge.
template <class Node, class Symbols, class Parameters, class WriteHeader>
[[nodiscard]] std::unique_ptr<Node> encoded_node(std::span<const Symbols> symbols, const ClusterHeader& header,
                                                 Parameters p, std::vector<std::uint32_t> truth,
                                                 const WriteHeader& write_header) {
  auto node = std::make_unique<Node>();
  choose_models(symbols, p);
  RansEncoder rans;
  for (const Symbols& level : symbols) {
    put_level(level, p, rans);
    for (const auto& parent : level.parents) node->gain += parent.gain;
  }
  node->truth = std::move(truth);
  node->level = header.level + header.levels;
  node->voxels = symbols.back().voxels;
  EncodedCluster& out = node->encoded;
  out.header = header;
  write_header(header, p, out.payload);
  const std::vector<std::byte> bits = rans.finish();
  out.payload.insert(out.payload.end(), bits.begin(), bits.end());
  out.voxels = static_cast<std::uint32_t>(node->voxels.size());
  out.divided = static_cast<std::uint32_t>(symbols.front().parents.size());
  return node;
}

/// Divides the nodes level by level with `encoder.divide(node)`. Returns false if `progress` cancels.
template <class Encoder, class Node>
[[nodiscard]] bool divide_all(const Encoder& encoder, Node& base, unsigned threads, Progress* progress) {
  std::vector<Node*> generation{&base};
  while (!generation.empty() && generation.front()->level < encoder.deepest()) {
    if (!parallel_for(
            generation.size(), [&](std::size_t i) { encoder.divide(*generation[i]); }, threads, progress))
      return false;
    std::vector<Node*> next;
    for (Node* node : generation)
      for (const auto& child : node->children) next.push_back(child.get());
    generation = std::move(next);
  }
  return true;
}

/// Copies a run of the parents of `all` to `out`. Returns the run of their children.
template <class Symbols>
[[nodiscard]] std::pair<std::uint32_t, std::size_t> choose_parents(const Symbols& all, std::size_t first,
                                                                   std::size_t count, Symbols& out) {
  const std::uint32_t begin = all.parents[first].first_child;
  for (std::size_t i = first; i < first + count; ++i) {
    out.parents.push_back(all.parents[i]);
    out.parents.back().first_child -= begin;
  }
  return {begin, first + count < all.parents.size() ? all.parents[first + count].first_child : all.children.size()};
}

}  // namespace gs::qnv
