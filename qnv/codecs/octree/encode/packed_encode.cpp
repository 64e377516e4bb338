#include "qnv/codecs/octree/encode/cluster_order.h"
#include "qnv/codecs/octree/encode/cluster_tree.h"
#include "qnv/codecs/octree/encode/packed_quantize.h"
#include "qnv/codecs/octree/packed_layout.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

namespace gs::qnv {
namespace {

// Target size of the first cluster, in bytes. With the stream's header, the cluster fills the first kilobyte.
constexpr std::size_t kBaseBytes = 870;
// Maximum number of voxels of the first cluster. Every view must draw them, even of a distant object.
constexpr std::size_t kMaxBaseVoxels = 600;
// Coarser quantisation steps for the first cluster, as log2. They are used if they allow one more level. Twice as many
// voxels along an edge improve the first picture more than fine steps. The next level corrects the errors.
struct BaseSteps {
  int normal, offset;
};
constexpr std::array<BaseSteps, 4> kBaseSteps{{{0, 0}, {1, 0}, {1, 1}, {2, 1}}};
// Minimum area of the surface inside a voxel, relative to a voxel face. Voxels that the surface barely touches are
// dropped.
constexpr float kMinArea = 0.03f;
// First levels with smaller quantisation steps. There, voxels are small relative to pixels and residuals are small, so
// that small steps pay.
constexpr int kFineOffsetLevel = 6, kFineNormalLevel = 8;
constexpr int kMaxNormalShift = 10, kMaxOffsetShift = 6;

void leave_out_touched(std::vector<Voxel>& finest) {
  double all = 0, kept = 0;
  for (const Voxel& voxel : finest) {
    all += voxel.moments.area;
    if (voxel.moments.area >= kMinArea) kept += voxel.moments.area;
  }
  // Keeps tiny voxels if they hold over 5 % of the area, as in wires and dust.
  const float least = kept > 0.95 * all ? kMinArea : std::numeric_limits<float>::min();
  std::erase_if(finest, [least](const Voxel& voxel) { return !(voxel.moments.area >= least); });
}

using Node = ClusterNode<PackedVoxels>;

// Selects the values that neighbours help to predict. Smooth surfaces use normals and offsets, coarse levels only
// normals, leaves and dust neither.
struct Prediction {
  bool normals, offsets;
};
constexpr std::array<Prediction, 3> kPredictions{{{true, true}, {true, false}, {false, false}}};

class PackedEncoder {
 public:
  PackedEncoder(VoxelPyramid<Voxel> pyramid, const Cube& cube, const PackedOptions& options)
      : pyramid_(std::move(pyramid)), cube_(cube), options_(options) {}

  [[nodiscard]] int deepest() const { return pyramid_.deepest(); }

  // Returns the first cluster, with the maximum number of levels that fits.
  [[nodiscard]] std::unique_ptr<Node> base() const {
    std::unique_ptr<Node> best;
    for (const BaseSteps& steps : kBaseSteps) {
      std::unique_ptr<Node> cheapest;
      for (const Prediction& prediction : kPredictions) {
        std::unique_ptr<Node> node = base(base_parameters(steps, prediction));
        const auto better = [](const EncodedCluster& a, const EncodedCluster& b) {
          return a.header.levels != b.header.levels ? a.header.levels > b.header.levels
                                                    : a.payload.size() < b.payload.size();
        };
        if (!cheapest || better(node->encoded, cheapest->encoded)) cheapest = std::move(node);
      }
      // In a stream of a few hundred bytes, coarser steps do not pay, because no later level corrects their errors.
      const bool coarser = steps.normal + steps.offset > 0;
      if (coarser && options_.max_bytes != 0 && options_.max_bytes < 2 * kBaseBytes) break;
      if (!best || cheapest->level > best->level) best = std::move(cheapest);
    }
    return best;
  }

  // Divides all voxels of a node once, and encodes them in clusters that fit into a datagram.
  void divide(Node& node) const {
    LevelSymbols all;
    ClusterParameters chosen;
    std::uint64_t least = std::numeric_limits<std::uint64_t>::max();
    for (const Prediction& prediction : kPredictions) {
      const ClusterParameters p = parameters(node.level, prediction);
      LevelSymbols symbols = quantize(node.voxels, node.truth, node.level, p);
      const std::uint64_t cost = plane_cost({&symbols, 1});
      if (cost >= least) continue;
      least = cost;
      all = std::move(symbols);
      chosen = p;
    }
    divide_in_runs(node, all.parents.size(),
                   [&](std::size_t first, std::size_t count) { return divide_run(node, all, chosen, first, count); });
    node.voxels = {};
    node.truth = {};
  }

 private:
  [[nodiscard]] ClusterParameters base_parameters(const BaseSteps& steps, const Prediction& prediction) const {
    ClusterParameters p = parameters(0, prediction);
    p.normal_shift = static_cast<std::uint8_t>(std::min(kMaxNormalShift, p.normal_shift + steps.normal));
    p.offset_shift = static_cast<std::uint8_t>(std::min(kMaxOffsetShift, p.offset_shift + steps.offset));
    return p;
  }

  [[nodiscard]] std::unique_ptr<Node> base(const ClusterParameters& p) const {
    const std::size_t most = options_.max_bytes != 0 ? std::min(kBaseBytes, options_.max_bytes) : kBaseBytes;
    std::vector<LevelSymbols> symbols;
    std::unique_ptr<Node> best;
    PackedVoxels from = root_voxel(options_.colored);
    std::vector<std::uint32_t> truth{0};
    for (int level = 0; level < deepest(); ++level) {
      symbols.push_back(quantize(from, truth, level, p));
      truth = pyramid_.children_of(symbols.back(), truth, level);
      from = symbols.back().voxels;
      ClusterHeader header;
      header.levels = static_cast<std::uint8_t>(level + 1);
      auto node = finish(symbols, header, p, truth);
      if (best && (node->encoded.payload.size() > most || node->voxels.size() > kMaxBaseVoxels)) break;
      best = std::move(node);
    }
    best->encoded.divided = 0;
    return best;
  }

  [[nodiscard]] bool fine(int level, int from) const { return !options_.compact && level + 1 >= from; }

  // Returns the coding parameters of clusters that divide voxels of `level`.
  [[nodiscard]] ClusterParameters parameters(int level, const Prediction& prediction) const {
    ClusterParameters p;
    p.normals_around = prediction.normals;
    p.offsets_around = prediction.offsets;
    p.normal_shift =
        static_cast<std::uint8_t>(std::max(1, options_.normal_shift - (fine(level, kFineNormalLevel) ? 1 : 0)));
    p.offset_shift =
        static_cast<std::uint8_t>(std::max(0, options_.offset_shift - (fine(level, kFineOffsetLevel) ? 1 : 0)));
    p.color_shift = static_cast<std::uint8_t>(options_.color_shift);
    p.colored = options_.colored;
    return p;
  }

  [[nodiscard]] LevelSymbols quantize(const PackedVoxels& from, std::span<const std::uint32_t> truth, int level,
                                      const ClusterParameters& p) const {
    return quantize_level(from, pyramid_.below(truth, level), 1.0 / static_cast<double>(std::uint64_t{2} << level), p);
  }

  // Returns one cluster that divides a run of the voxels of `node`.
  [[nodiscard]] std::unique_ptr<Node> divide_run(const Node& node, const LevelSymbols& all, const ClusterParameters& p,
                                                 std::size_t first, std::size_t count) const {
    const std::vector<LevelSymbols> symbols{chosen_symbols(all, first, count)};
    return finish(symbols, header_of_run(node, first, count), p,
                  pyramid_.children_of(symbols.front(), node.truth, node.level));
  }

  [[nodiscard]] std::unique_ptr<Node> finish(std::span<const LevelSymbols> symbols, const ClusterHeader& header,
                                             const ClusterParameters& p, std::vector<std::uint32_t> truth) const {
    auto node = encoded_node<Node>(symbols, header, p, std::move(truth), write_cluster_header);
    EncodedCluster& out = node->encoded;
    out.level_edge = cube_.edge / static_cast<float>(std::uint64_t{1} << node->level);
    for (std::size_t i = 0; i < node->voxels.size(); ++i) {
      const glm::vec3 cell(node->voxels.x[i], node->voxels.y[i], node->voxels.z[i]);
      out.box.add(cube_.lower + cell * out.level_edge);
      out.box.add(cube_.lower + (cell + 1.0f) * out.level_edge);
    }
    return node;
  }

  VoxelPyramid<Voxel> pyramid_;
  Cube cube_;
  PackedOptions options_;
};

}  // namespace

std::vector<EncodedCluster> encode_packed(std::vector<Voxel> finest, int level, const Cube& cube,
                                          const PackedOptions& options, Progress* progress) {
  leave_out_touched(finest);
  if (finest.empty() || level < 1) return {};
  const PackedEncoder encoder({std::move(finest), level, [](const auto& fine, std::size_t) { return coarsen(fine); }},
                              cube, options);
  std::unique_ptr<Node> base = encoder.base();
  if (!divide_all(encoder, *base, options.threads, progress)) return {};
  return in_order(std::move(base), options.vectors, options.max_bytes);
}

}  // namespace gs::qnv
