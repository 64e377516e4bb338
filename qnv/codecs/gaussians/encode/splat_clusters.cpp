#include "qnv/codecs/gaussians/encode/splat_clusters.h"

#include "qnv/codecs/gaussians/cluster_code.h"
#include "qnv/codecs/gaussians/ellipsoid.h"
#include "qnv/codecs/gaussians/encode/tree_cuts.h"
#include "qnv/codecs/gaussians/splat_steps.h"

#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>

namespace gs::qnv::gaussians {
namespace {

// Room for the bytes of a cluster without its head.
constexpr std::size_t kMostBytes = kMostClusterBytes - 20, kSpareBytes = 20;
// If a cluster has at most this many leaves, they replace all of its Gaussians.
constexpr std::uint32_t kFewLeavesOfCluster = 250;

/// Children of the Gaussians of a cluster, as places in the tree.
using Children = std::vector<std::vector<std::uint32_t>>;

/// Cluster and what its children need.
struct ReadyCluster {
  EncodedCluster cluster;
  OpenCluster open;

  [[nodiscard]] double use() const { return use_of(cluster.gain, cluster.bytes.size()); }
};

/// Puts less useful clusters after others. The order is the same on all machines.
struct LessUseful {
  bool operator()(const std::unique_ptr<ReadyCluster>& a, const std::unique_ptr<ReadyCluster>& b) const {
    const ClusterHead &p = a->cluster.head, &q = b->cluster.head;
    if (a->use() != b->use()) return a->use() < b->use();
    return p.parent != q.parent ? p.parent > q.parent : p.first > q.first;
  }
};

/// Encoder of one tree.
class ClusterEncoder {
 public:
  explicit ClusterEncoder(ClusterWork& work)
      : work_(work), source_(work.source), tree_(work.tree), precision_(work.precision) {}

  /// Encodes all children of some Gaussians of a cluster, as one or more clusters. `first` means that `open` is the
  /// root node, so that the result has no parent cluster.
  void divide(const OpenCluster& open, std::size_t begin, std::size_t end, bool first,
              const std::function<void(std::unique_ptr<ReadyCluster>)>& take) {
    Children children = children_of(open, begin, end, first);
    if (children.empty()) return;
    std::vector<std::size_t> ends;  // coded bytes after the children of each Gaussian
    (void)encode(open, first, children, begin, end, &ends);
    const std::size_t parts = 1 + ends.back() / (kMostBytes - kSpareBytes);
    const std::size_t part = std::min(ends.back() / parts + kSpareBytes, kMostBytes - kSpareBytes / 2);
    for (std::size_t from = begin; from < end;) {
      const std::size_t start = from == begin ? 0 : ends[from - begin - 1];
      std::size_t to = from + 1;
      while (to < end && ends[to - begin] - start <= part) ++to;
      auto ready = encode(open, first, children, from, to, nullptr);
      while (ready->cluster.bytes.size() > kMostBytes && to > from + 1)
        ready = encode(open, first, children, from, --to, nullptr);
      if (ready->cluster.bytes.size() > kMostBytes) {
        children[from] = parts_of(tree_, open.places[from], -1, kUsualChildren);
        ready = encode(open, first, children, from, to, nullptr);
      }
      from = to;
      if (ready->cluster.replaced > 0) take(std::move(ready));
    }
  }

  /// Reports whether all Gaussians of a cluster are leaves or given nodes.
  [[nodiscard]] bool given(const OpenCluster& open) const {
    return std::ranges::all_of(open.places, [&](std::uint32_t i) { return tree_[i].leaf() || i < tree_.given(); });
  }

 private:
  /// Returns the code of a node of the tree below a decoded Gaussian.
  [[nodiscard]] SplatCode code_of(std::uint32_t place, const SplatNode& parent) const {
    const MergedNode& node = tree_[place];
    SplatCode code;
    code.leaf = node.leaf();
    const FitGaussian* fitted = work_.fitted ? work_.fitted->of(place) : nullptr;
    const glm::vec3 &mean = fitted ? fitted->mean : node.blob.mean, &color = fitted ? fitted->color : node.blob.color;
    Ellipsoid shape;
    if (code.leaf) {
      const glm::vec4& q = source_.rotations[node.right];
      shape = sorted(source_.scales[node.right], glm::mat3_cast(glm::quat(q.w, q.x, q.y, q.z)));
      code.opacity = opacity_code(source_.opacities[node.right]);
      for (std::size_t k = 0; k < 3; ++k) code.scales[k] = scale_code(shape.scales[static_cast<int>(k)]);
      code.scales[2] = thinned(code.scales[1], code.scales[2], code.leaf);
      code.fine =
          fine_codes(code, {shape.scales.x, shape.scales.y, shape.scales.z}, source_.opacities[node.right], precision_);
    } else {
      // Half the precision.
      const BlobLook look = fitted ? BlobLook{fitted->covariance, fitted->opacity} : tree_.look(place);
      shape = ellipsoid_of(look.covariance);
      code.opacity = opacity_code(look.opacity) | 1;
      for (std::size_t k = 0; k < 3; ++k)
        code.scales[k] = std::min((scale_code(shape.scales[static_cast<int>(k)]) + 1) >> 1 << 1, kMostScale - 1);
      code.scales[2] = thinned(code.scales[1], code.scales[2], code.leaf);
    }
    const SplatSteps steps = steps_of(code, precision_);
    const glm::vec4& from = parent.rotation;
    const glm::quat turn = glm::conjugate(glm::quat(from.w, from.x, from.y, from.z)) * glm::quat_cast(shape.axes);
    // Half turns about the axes do not change the shape. The largest component becomes w.
    const std::array<glm::quat, 4> same{turn, turn * glm::quat(0, 1, 0, 0), turn * glm::quat(0, 0, 1, 0),
                                        turn * glm::quat(0, 0, 0, 1)};
    glm::quat best = *std::ranges::max_element(same, {}, [](const glm::quat& one) { return std::abs(one.w); });
    if (best.w < 0) best = -best;
    const std::array<float, 3> parts{best.x, best.y, best.z};
    for (std::size_t k = 0; k < 3; ++k) code.turn[k] = static_cast<int>(std::lround(parts[k] / steps.turn[k]));
    const auto axes = axes_of(turned(parent.rotation, code.turn, steps.turn));
    const glm::dvec3 apart = glm::dvec3(mean) - glm::dvec3(parent.position);
    for (std::size_t k = 0; k < 3; ++k) {
      const double along = axes[k][0] * apart.x + axes[k][1] * apart.y + axes[k][2] * apart.z;
      code.place[k] =
          static_cast<int>(std::clamp(std::nearbyint(along / steps.place[k]), -double{kMostPlace}, double{kMostPlace}));
    }
    code.color = color_code(glm::dvec3(color) - glm::dvec3(parent.color), steps.color);
    return code;
  }

  /// Returns the children of Gaussians `begin` to `end` of a cluster; leaves and other Gaussians have none. Returns an
  /// empty list if all are leaves.
  [[nodiscard]] Children children_of(const OpenCluster& open, std::size_t begin, std::size_t end, bool first) {
    std::size_t leaves = 0;
    for (std::size_t i = begin; i < end; ++i)
      if (!open.nodes[i].leaf) leaves += tree_[open.places[i]].leaves;
    if (leaves == 0) return {};
    Children children(open.nodes.size());
    if (first) {
      children[0] = parts_of(tree_, open.places[0], 0, kFirstNodes);
      for (const std::uint32_t place : children[0]) work_.first_error = std::max(work_.first_error, tree_[place].error);
      return children;
    }
    // A range of a larger cluster does not jump to its leaves, even if they are few.
    const bool last = leaves <= kFewLeavesOfCluster && end - begin == open.nodes.size();
    float least = last ? -1 : error_below(work_.first_error, open.head.level);
    // If no error is so large, this level takes smaller ones.
    for (bool any = false; !any; least = least > work_.first_error * 1e-12f ? least / kErrorRatio : -1)
      for (std::size_t i = begin; i < end; ++i)
        if (!open.nodes[i].leaf) {
          children[i] = parts_of(tree_, open.places[i], least, last ? kMostChildren : kUsualChildren);
          any = any || children[i].size() > 1;
        }
    return children;
  }

  /// Encodes the children of nodes `from` up to `to` of a cluster.
  [[nodiscard]] std::unique_ptr<ReadyCluster> encode(const OpenCluster& open, bool first, const Children& children,
                                                     std::size_t from, std::size_t to,
                                                     std::vector<std::size_t>* ends) const {
    auto ready = std::make_unique<ReadyCluster>();
    EncodedCluster& cluster = ready->cluster;
    if (!first) {
      cluster.head.parent = open.head.id;
      cluster.head.level = open.head.level + 1;
    }
    cluster.head.first = static_cast<std::uint32_t>(from);
    cluster.head.count = static_cast<std::uint32_t>(to - from);
    BinaryEncoder encoder;
    Writer writer{&encoder};
    auto models = std::make_shared<SplatModels>(*open.models);
    std::vector<SplatCode> codes;
    for (std::size_t i = from; i < to; ++i) {
      const SplatNode& parent = open.nodes[i];
      if (!parent.leaf) {
        ++cluster.replaced;
        codes.clear();
        for (const std::uint32_t place : children[i]) codes.push_back(code_of(place, parent));
        code_children(writer, *models, parent, !first, codes, precision_, cluster.nodes);
        cluster.gain += tree_[open.places[i]].error;
        for (std::size_t k = 0; k < codes.size(); ++k) {
          cluster.places.push_back(children[i][k]);
          cluster.parents.push_back(first ? MergedNode::kNone : open.places[i]);
          cluster.gain -= tree_[children[i][k]].error;
        }
      }
      if (ends) ends->push_back(encoder.size());
    }
    cluster.bytes = encoder.finish();
    ready->open.nodes = cluster.nodes;
    ready->open.places = cluster.places;
    ready->open.models = std::move(models);
    return ready;
  }

  ClusterWork& work_;
  const Gaussians& source_;
  const MergeTree& tree_;
  const Precision& precision_;
};

}  // namespace

bool encode_clusters(ClusterWork& work, std::vector<OpenRange> ranges,
                     const std::function<bool(EncodedCluster&&)>& take, std::vector<OpenCluster>* given,
                     Progress* progress) {
  ClusterEncoder encoder(work);
  std::vector<std::unique_ptr<ReadyCluster>> heap;  // the most useful one is first
  const auto add = [&](std::unique_ptr<ReadyCluster> ready) {
    heap.push_back(std::move(ready));
    std::ranges::push_heap(heap, LessUseful());
  };
  if (ranges.empty()) {
    OpenCluster root;
    root.nodes = {root_node(work.precision.box)};
    root.places = {work.tree.root()};
    root.models = std::make_shared<SplatModels>(work.precision.trained());
    encoder.divide(root, 0, 1, true, add);
  }
  for (OpenRange& range : ranges) {
    encoder.divide(range.cluster, range.from, range.to, false, add);
    range = {};
  }
  for (std::uint32_t id = work.first_id; !heap.empty(); ++id) {
    if (is_cancelled(progress)) return false;
    std::ranges::pop_heap(heap, LessUseful());
    const std::unique_ptr<ReadyCluster> ready = std::move(heap.back());
    heap.pop_back();
    ready->cluster.head.id = id;
    ready->open.head = ready->cluster.head;
    if (!take(std::move(ready->cluster))) return true;
    if (given && encoder.given(ready->open))
      given->push_back(std::move(ready->open));
    else
      encoder.divide(ready->open, 0, ready->open.nodes.size(), false, add);
  }
  return true;
}

}  // namespace gs::qnv::gaussians
