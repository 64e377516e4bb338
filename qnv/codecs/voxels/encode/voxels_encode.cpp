#include "qnv/base/morton.h"
#include "qnv/codecs/octree/encode/cluster_order.h"
#include "qnv/codecs/octree/encode/cluster_tree.h"
#include "qnv/codecs/voxels/encode/visibility.h"
#include "qnv/codecs/voxels/encode/voxels_quantize.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

namespace gs::qnv {
namespace {

// Maximum size of the first cluster, in bytes. With the stream's header, it fits into the first kilobyte.
constexpr std::size_t kFirstClusterBytes = 640;
constexpr std::uint8_t kTrust = 3;
// Number of the finest levels in which means are not weighted by visibility.
constexpr std::size_t kPlainLevels = 2;

// Returns the weight of a voxel in a mean: the number of vectors, in the finest levels. In coarser levels, inside and
// outside merge, so only the visible fraction counts.
float share_of(const TrueVoxel& voxel, bool plain) { return plain ? voxel.vectors : voxel.vectors * voxel.seen; }

// Returns the mean gradient of voxels. Opposite gradients count as equal: the mean is along the axis that is closest to
// most gradients.
glm::vec3 mean_gradient(std::span<const TrueVoxel> voxels, bool plain) {
  glm::vec3 axis(0);
  for (const TrueVoxel& voxel : voxels) {
    const glm::vec3 part = voxel.gradient * share_of(voxel, plain);
    axis += glm::dot(axis, part) < 0 ? -part : part;
  }
  glm::vec3 straight(0), turned(0);
  float shares = 0;
  for (const TrueVoxel& voxel : voxels) {
    const glm::vec3 part = voxel.gradient * share_of(voxel, plain);
    straight += part;
    turned += glm::dot(axis, part) < 0 ? -part : part;
    shares += share_of(voxel, plain);
  }
  return (glm::dot(turned, straight) < 0 ? -turned : turned) / shares;
}

std::vector<TrueVoxel> coarser_voxels(std::span<const TrueVoxel> fine, bool plain) {
  std::vector<TrueVoxel> out;
  for (std::size_t i = 0, end = 0; i < fine.size(); i = end) {
    while (end < fine.size() && fine[end].key >> 3 == fine[i].key >> 3) ++end;
    TrueVoxel voxel;
    voxel.key = fine[i].key >> 3;
    float vectors = 0, shares = 0, value = 0, magnitude = 0, seen = 0;
    for (const TrueVoxel& child : fine.subspan(i, end - i)) {
      const float share = share_of(child, plain);
      vectors += child.vectors;
      seen += child.vectors * child.seen;
      shares += share;
      value += child.value * share;
      magnitude += child.magnitude * share;
    }
    voxel.vectors = vectors;
    voxel.value = value / shares;
    voxel.magnitude = magnitude / shares;
    voxel.seen = seen / vectors;
    voxel.gradient = mean_gradient(fine.subspan(i, end - i), plain);
    out.push_back(voxel);
  }
  return out;
}

using VolumeNode = ClusterNode<VolumeVoxels>;

class VoxelsEncoder {
 public:
  VoxelsEncoder(VoxelPyramid<TrueVoxel> pyramid, const VoxelLattice& lattice, const VoxelsOptions& options)
      : pyramid_(std::move(pyramid)), lattice_(lattice), options_(options) {}

  [[nodiscard]] int deepest() const { return lattice_.depth; }

  // Returns the first cluster, with the maximum number of levels that fits.
  [[nodiscard]] std::unique_ptr<VolumeNode> base() const {
    const std::size_t most =
        options_.max_bytes != 0 ? std::min(kFirstClusterBytes, options_.max_bytes) : kFirstClusterBytes;
    std::vector<VolumeSymbols> symbols;
    std::unique_ptr<VolumeNode> best;
    VolumeVoxels from = root_volume_voxel();
    std::vector<std::uint32_t> truth{0};
    VolumeParameters p = parameters();
    for (int level = 0; level < deepest(); ++level) {
      symbols.push_back(quantize_volume(from, pyramid_.below(truth, level), edge_below(level), lattice_, p));
      VolumeVoxels next = symbols.back().voxels;
      link_neighbours(from, 0, symbols.back(), next);
      truth = pyramid_.children_of(symbols.back(), truth, level);
      ClusterHeader header;
      header.levels = static_cast<std::uint8_t>(level + 1);
      auto node = finish(symbols, header, p, truth);
      node->voxels.neighbours = next.neighbours;
      if (best && node->encoded.payload.size() > most) break;
      best = std::move(node);
      from = std::move(next);
    }
    best->encoded.divided = 0;
    return best;
  }

  // Divides all voxels of a node once, and encodes them in clusters that fit into a datagram.
  void divide(VolumeNode& node) const {
    const auto children = pyramid_.below(node.truth, node.level);
    VolumeParameters p = parameters();
    const auto left = static_cast<std::size_t>(deepest() - 1 - node.level);
    if (left < options_.steps.last_directions.size())
      p.direction_step = static_cast<std::uint8_t>(options_.steps.last_directions[left]);
    p.trust = kTrust;
    fit_slopes(node.voxels, children, lattice_, p);
    const VolumeSymbols all = quantize_volume(node.voxels, children, edge_below(node.level), lattice_, p);
    divide_in_runs(node, all.parents.size(),
                   [&](std::size_t first, std::size_t count) { return divide_run(node, all, p, first, count); });
    node.voxels = {};
    node.truth = {};
  }

 private:
  [[nodiscard]] VolumeParameters parameters() const {
    VolumeParameters p;
    p.value_step = static_cast<std::uint8_t>(options_.steps.value);
    p.direction_step = static_cast<std::uint8_t>(options_.steps.direction);
    p.magnitude_step = static_cast<std::uint8_t>(options_.steps.magnitude);
    return p;
  }

  static double edge_below(int level) { return 1.0 / static_cast<double>(std::uint64_t{2} << level); }

  // Returns one cluster that divides a run of the voxels of `node`.
  [[nodiscard]] std::unique_ptr<VolumeNode> divide_run(const VolumeNode& node, const VolumeSymbols& all,
                                                       const VolumeParameters& p, std::size_t first,
                                                       std::size_t count) const {
    const std::vector<VolumeSymbols> symbols{chosen_symbols(all, first, count)};
    auto child = finish(symbols, header_of_run(node, first, count), p,
                        pyramid_.children_of(symbols.front(), node.truth, node.level));
    if (child->level < deepest()) link_neighbours(node.voxels, first, symbols.front(), child->voxels);
    return child;
  }

  [[nodiscard]] std::unique_ptr<VolumeNode> finish(std::span<const VolumeSymbols> symbols, const ClusterHeader& header,
                                                   const VolumeParameters& p, std::vector<std::uint32_t> truth) const {
    auto node = encoded_node<VolumeNode>(symbols, header, p, std::move(truth), write_volume_cluster_header);
    EncodedCluster& out = node->encoded;
    const auto edge = static_cast<float>(std::uint32_t{1} << (lattice_.depth - node->level));
    out.level_edge = edge;
    for (std::size_t i = 0; i < node->voxels.size(); ++i)
      out.box.add(lattice_.position(node->level, node->voxels.x[i], node->voxels.y[i], node->voxels.z[i]));
    return node;
  }

  VoxelPyramid<TrueVoxel> pyramid_;
  VoxelLattice lattice_;
  VoxelsOptions options_;
};

std::vector<TrueVoxel> true_voxels(std::span<const LatticeVector> vectors, const VoxelLattice& lattice) {
  std::vector<TrueVoxel> out;
  out.reserve(vectors.size());
  for (const LatticeVector& vector : vectors) {
    TrueVoxel voxel;
    voxel.key = vector.key;
    voxel.gradient = vector.gradient;
    voxel.value = std::clamp(vector.value, 0.0f, 255.0f);
    const float octaves =
        vector.magnitude > 0 ? std::log2(vector.magnitude / lattice.unit) : -static_cast<float>(kMagnitudeOne);
    voxel.magnitude =
        std::clamp(octaves * kMagnitudesAnOctave + kMagnitudeOne, 0.0f, static_cast<float>(kMaxMagnitude));
    out.push_back(voxel);
  }
  return out;
}

}  // namespace

std::vector<EncodedCluster> encode_voxels(std::vector<LatticeVector> finest, const VoxelLattice& lattice,
                                          const VoxelsOptions& options, Progress* progress) {
  if (finest.empty()) return {};
  std::vector<TrueVoxel> voxels = true_voxels(finest, lattice);
  std::vector<LatticeVector>().swap(finest);
  if (!options.depth_of_class.empty()) find_seen(voxels, lattice, options.depth_of_class, options.threads);
  const auto depth = static_cast<std::size_t>(lattice.depth);
  VoxelPyramid<TrueVoxel> pyramid(std::move(voxels), lattice.depth, [depth](const auto& fine, std::size_t level) {
    return coarser_voxels(fine, level + kPlainLevels >= depth);
  });
  const VoxelsEncoder encoder(std::move(pyramid), lattice, options);
  std::unique_ptr<VolumeNode> base = encoder.base();
  if (!divide_all(encoder, *base, options.threads, progress)) return {};
  return in_order(std::move(base), 0, options.max_bytes);
}

}  // namespace gs::qnv
