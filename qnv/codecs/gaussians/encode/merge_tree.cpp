#include "qnv/codecs/gaussians/encode/merge_tree.h"

#include "qnv/base/morton.h"
#include "qnv/codecs/gaussians/encode/visibility.h"

#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

namespace gs::qnv::gaussians {
namespace {

// Largest growth of the covariance of a merged Gaussian; it replaces opacities above 1.
constexpr float kMostGrowth = 1.5f;
// Blurred details, relative to the median distance from the middle.
constexpr float kDetail = 1.0f / 300;
// Squared contrast between a Gaussian and what is behind it, summed over the colours.
constexpr float kContrast = 0.75f;
// Share of the possible merges of one round. The others may find better partners in the next one.
constexpr float kMergedShare = 0.9f;
// Neighbours on each side in an order, and those of them that are compared exactly.
constexpr std::size_t kReach = 5, kTried = 5;
// Cost of merges with errors that float cannot hold.
constexpr float kMostCost = 1e24f;

using Covariance = std::array<float, 6>;

/// Returns two blobs as one. Conserves the sum of cover x visibility.
Blob merged(const Blob& a, const Blob& b) {
  Blob all;
  all.weight = a.weight + b.weight;
  const float share = all.weight > 0 ? b.weight / all.weight : 0.5f, rest = 1 - share;
  all.visibility = rest * a.visibility + share * b.visibility;
  all.cover = (a.cover * a.visibility + b.cover * b.visibility) / all.visibility;
  const glm::vec3 apart = b.mean - a.mean;
  all.mean = a.mean + apart * share;
  all.color = a.color * rest + b.color * share;
  const Covariance spread{apart.x * apart.x, apart.x * apart.y, apart.x * apart.z,
                          apart.y * apart.y, apart.y * apart.z, apart.z * apart.z};
  for (std::size_t i = 0; i < 6; ++i)
    all.covariance[i] = rest * a.covariance[i] + share * b.covariance[i] + rest * share * spread[i];
  return all;
}

BlobLook look_of(const Blob& blob, float detail, bool leaf) {
  const float area = area_of(blob.covariance, detail);
  BlobLook look{blob.covariance, area > 0 ? blob.cover / area : 0};
  if (leaf) {
    look.opacity = std::min(look.opacity, 1.0f);
    return look;
  }
  const float growth = std::clamp(look.opacity, 1.0f, kMostGrowth);
  for (float& c : look.covariance) c *= growth;
  look.opacity = std::clamp(look.opacity, 0.0f, 1.0f);
  return look;
}

/// Numbers for pictures along the three axes of the coordinates. The last lane is not used.
using Three = float __attribute__((vector_size(16)));
using ThreeBits = std::int32_t __attribute__((vector_size(16)));

/// Returns the sum over the three pictures.
float sum_of(Three v) { return v[0] + v[1] + v[2]; }

Three masked(Three v, ThreeBits mask) { return reinterpret_cast<Three>(reinterpret_cast<ThreeBits>(v) & mask); }

Three root_of(Three v) { return Three{std::sqrt(v[0]), std::sqrt(v[1]), std::sqrt(v[2]), 0}; }

/// Returns e^x in the lanes of a mask, and 0 in the others.
Three exp_of(Three x, ThreeBits mask) {
  Three result{};
  for (int i = 0; i < 3; ++i)
    if (mask[i] != 0) result[i] = std::exp(x[i]);
  return result;
}

/// Gaussian in the pictures along the axes.
struct Flat {
  Three x, y;         // centre
  Three xx, xy, yy;   // covariance
  Three determinant;  // of the covariance
  Three r, g, b, a;   // colour times opacity, relative to grey; opacity with the weight of its contrast

  void set_determinant() { determinant = xx * yy - xy * xy; }
};

/// Returns the integrals of the product of two Gaussians with peaks of 1, divided by 2 pi.
Three overlap(const Flat& p, const Flat& q) {
  const Three xx = p.xx + q.xx, xy = p.xy + q.xy, yy = p.yy + q.yy, x = p.x - q.x, y = p.y - q.y;
  const Three determinant = xx * yy - xy * xy, both = p.determinant * q.determinant;
  const Three power = -0.5f * (yy * x * x - 2 * xy * x * y + xx * y * y) / determinant;
  const ThreeBits none = (determinant > 0) & (power < -20), visible = (determinant > 0) & ~none;
  return root_of(masked(masked(both, both > 0) / determinant, visible)) * exp_of(power, visible);
}

Three product(const Flat& p, const Flat& q) { return (p.r * q.r + p.g * q.g + p.b * q.b + p.a * q.a) * overlap(p, q); }

/// Returns product(p, p).
Three square(const Flat& p) {
  const Three sum = p.r * p.r + p.g * p.g + p.b * p.b + p.a * p.a, both = p.determinant * p.determinant;
  const Three integral = root_of(masked(both / (4 * p.determinant), p.determinant > 0));
  return sum * integral;
}

/// Returns the integrals of Gaussians with peaks of 1, divided by 2 pi.
Three area_of(const Flat& p) { return root_of(masked(p.determinant, p.determinant > 0)); }

/// Returns the part of both that is seen once although both cover it.
Flat common(const Flat& p, const Flat& q, float opacity_p, float opacity_q) {
  Flat both;
  const Three sx = p.xx + q.xx, sxy = p.xy + q.xy, sy = p.yy + q.yy, determinant = sx * sy - sxy * sxy;
  const Three x = q.x - p.x, y = q.y - p.y;
  // Gain of the product: P (P + Q)^-1.
  const Three ixx = sy / determinant, ixy = -sxy / determinant, iyy = sx / determinant;
  const Three kxx = p.xx * ixx + p.xy * ixy, kxy = p.xx * ixy + p.xy * iyy, kyx = p.xy * ixx + p.yy * ixy,
              kyy = p.xy * ixy + p.yy * iyy;
  both.x = p.x + kxx * x + kxy * y;
  both.y = p.y + kyx * x + kyy * y;
  both.xx = kxx * q.xx + kxy * q.xy;
  both.xy = kxx * q.xy + kxy * q.yy;
  both.yy = kyx * q.xy + kyy * q.yy;
  both.set_determinant();
  const Three power = -0.5f * (ixx * x * x + 2 * ixy * x * y + iyy * y * y);
  const Three peak = exp_of(power > -20 ? power : Three{-20, -20, -20, -20}, ThreeBits{-1, -1, -1, 0});
  // Premultiplied colours are opacity x colour: their mean, times both opacities.
  const Three half_p = 0.5f * opacity_q * peak, half_q = 0.5f * opacity_p * peak;
  both.r = p.r * half_p + q.r * half_q;
  both.g = p.g * half_p + q.g * half_q;
  both.b = p.b * half_p + q.b * half_q;
  both.a = p.a * half_p + q.a * half_q;
  return both;
}

Flat flattened(const Blob& blob, const BlobLook& look, float detail) {
  const float d = detail * detail;
  const Covariance& c = look.covariance;
  const float o = look.opacity * blob.visibility;
  const glm::vec3 tint = (blob.color - 0.5f) * o;
  const auto all = [](float v) { return Three{v, v, v, v}; };
  const glm::vec3& m = blob.mean;
  Flat flat;
  flat.x = Three{m.x, m.y, m.x, m.x};
  flat.y = Three{m.y, m.z, m.z, m.y};
  flat.xx = Three{c[0] + d, c[3] + d, c[0] + d, c[0] + d};
  flat.xy = Three{c[1], c[4], c[2], c[1]};
  flat.yy = Three{c[3] + d, c[5] + d, c[5] + d, c[3] + d};
  flat.set_determinant();
  flat.r = all(tint.x);
  flat.g = all(tint.y);
  flat.b = all(tint.z);
  flat.a = all(o * std::sqrt(kContrast));
  return flat;
}

/// Blob with what costs need.
struct Candidate {
  Blob blob;
  BlobLook look;
  Flat flat;
  Three self;  // squared integrals
};

Candidate candidate_of(const Blob& blob, float detail, bool leaf) {
  Candidate c{blob, look_of(blob, detail, leaf), {}, {}};
  c.flat = flattened(blob, c.look, detail);
  c.self = square(c.flat);
  return c;
}

/// Returns two candidates as one blob. An area that both cover counts once.
Blob joined(const Candidate& a, const Candidate& b) {
  Blob all = merged(a.blob, b.blob);
  const float twice = sum_of(a.look.opacity * b.look.opacity * overlap(a.flat, b.flat));
  const float sum = sum_of(a.look.opacity * area_of(a.flat) + b.look.opacity * area_of(b.flat));
  if (sum > 0) all.cover *= 1 - std::min(twice / sum, 0.5f);
  return all;
}

/// Returns the squared error of pictures with one Gaussian for both, summed over three directions. Hidden Gaussians
/// count less.
float cost_of(const Candidate& a, const Candidate& b, float detail) {
  const Candidate all = candidate_of(joined(a, b), detail, false);
  const Flat &p = a.flat, &q = b.flat, &m = all.flat;
  const Flat c = common(p, q, a.look.opacity, b.look.opacity);
  const float cost =
      sum_of(a.self + b.self + all.self + square(c) +
             2 * (product(p, q) - product(p, m) - product(q, m) - product(p, c) - product(q, c) + product(m, c)));
  return cost >= 0 && cost < kMostCost ? cost : cost < 0 ? 0 : kMostCost;
}

/// Best partner of a node so far.
struct Best {
  float cost = std::numeric_limits<float>::max();
  std::uint32_t with = MergedNode::kNone;
};

/// Input of rough_cost(). Stored apart from candidates, because the search reads the input of many neighbours.
struct RoughBlob {
  glm::vec3 mean, color, spread;
  float weight;
};

RoughBlob rough_of(const Candidate& one) {
  const Covariance& c = one.look.covariance;
  return {one.blob.mean, one.blob.color, {c[0], c[3], c[5]}, one.blob.weight};
}

/// Returns an estimate that orders partners: distance and change of colour, relative to the sizes.
float rough_cost(const RoughBlob& a, const RoughBlob& b, float detail) {
  const glm::vec3 apart = a.mean - b.mean, tint = a.color - b.color;
  const glm::vec3 spread = a.spread + b.spread + detail * detail;
  const float weight = a.weight * b.weight / std::max(a.weight + b.weight, 1e-30f);
  const glm::vec3 far = apart * apart / spread;
  return weight * (0.1f + glm::dot(tint, tint)) * (1 + far.x + far.y + far.z);
}

/// Builder of a tree. The active nodes are those without a parent so far.
class TreeBuilder {
 public:
  TreeBuilder(Forest forest, float detail, unsigned threads)
      : box_(forest.box),
        detail_(detail),
        threads_(threads),
        nodes_(std::move(forest.nodes)),
        active_(std::move(forest.roots)) {
    const glm::vec3 size = box_.size();
    edge_ = std::max({size.x, size.y, size.z, std::numeric_limits<float>::min()});
    nodes_.reserve(nodes_.size() + active_.size());
    known_.resize(nodes_.size() + active_.size());
  }

  [[nodiscard]] std::size_t roots() const { return active_.size(); }
  [[nodiscard]] MergeTree take(std::size_t given) { return {std::move(nodes_), std::move(active_), given, detail_}; }

  /// Merges pairs of nodes that suit each other best.
  void merge_pairs() {
    const std::size_t count = active_.size();
    all_.resize(count);
    rough_.resize(count);
    for_active([&](std::size_t i) {
      const MergedNode& node = nodes_[active_[i]];
      all_[i] = candidate_of(node.blob, detail_, node.leaf());
      rough_[i] = rough_of(all_[i]);
    });
    find_orders();
    find_partners();
    std::vector<std::pair<float, std::uint32_t>> pairs;
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::uint32_t j = best_[i].with;
      if (j != MergedNode::kNone && i < j && best_[j].with == i) pairs.emplace_back(best_[i].cost, i);
    }
    if (pairs.empty()) std::ranges::fill(known_, Best{});
    std::ranges::sort(pairs);
    const auto share = static_cast<std::size_t>(static_cast<float>(pairs.size()) * kMergedShare);
    pairs.resize(std::min(pairs.size(), std::max<std::size_t>(1, share)));
    std::vector<bool> gone(count);
    std::vector<std::uint32_t> next;
    for (const auto& [cost, i] : pairs) {
      const std::uint32_t j = best_[i].with;
      gone[i] = gone[j] = true;
      next.push_back(static_cast<std::uint32_t>(nodes_.size()));
      nodes_.push_back(parent_of(i, j, cost));
    }
    for (std::size_t i = 0; i < count; ++i)
      if (!gone[i]) next.push_back(active_[i]);
    active_ = std::move(next);
    ++round_;
  }

 private:
  // Orders in which neighbours are searched.
  static constexpr std::size_t kOrders = 2;

  template <class Work>
  void for_active(const Work& work) const {
    constexpr std::size_t kRange = 1024;
    const std::size_t count = active_.size();
    parallel_for((count + kRange - 1) / kRange,
                 [&](std::size_t r) {
                   for (std::size_t i = r * kRange; i < std::min(count, (r + 1) * kRange); ++i) work(i);
                 },
                 threads_);
  }

  /// Returns the parent of two active nodes.
  [[nodiscard]] MergedNode parent_of(std::uint32_t i, std::uint32_t j, float cost) const {
    const std::uint32_t left = active_[i], right = active_[j];
    const MergedNode &a = nodes_[left], &b = nodes_[right];
    MergedNode node;
    node.blob = joined(all_[i], all_[j]);
    node.error = a.error + b.error + cost;
    node.leaves = a.leaves + b.leaves;
    node.left = left;
    node.right = right;
    return node;
  }

  /// Sorts the active nodes by their Morton codes on lattices that are shifted against each other.
  void find_orders() {
    const std::size_t count = active_.size();
    places_.resize(count);
    for (std::size_t shift = 0; shift < kOrders; ++shift) {
      const float offset = 0.31f * static_cast<float>(shift) + 0.013f * static_cast<float>(round_ % 7);
      auto& keys = orders_[shift];
      keys.resize(count);
      for_active([&](std::size_t i) {
        const glm::vec3 p = (all_[i].blob.mean - box_.lower) / edge_ * 0.5f + offset;
        const auto part = [](float v) {
          return static_cast<std::uint32_t>(std::clamp(v, 0.0f, 1.0f) * static_cast<float>((1 << 21) - 1));
        };
        keys[i] = {morton_encode(part(p.x), part(p.y), part(p.z)), static_cast<std::uint32_t>(i)};
      });
      std::ranges::sort(keys);
      for (std::uint32_t at = 0; at < count; ++at) places_[keys[at].second][shift] = at;
    }
  }

  /// Returns the neighbours of an active node that a rough estimate prefers.
  [[nodiscard]] std::pair<std::array<Best, kTried>, std::size_t> likely_partners(std::size_t i) const {
    std::array<Best, kTried> tried;
    std::size_t found = 0;
    for (std::size_t shift = 0; shift < kOrders; ++shift) {
      const auto* const order = orders_[shift].data();
      const std::size_t at = places_[i][shift], end = std::min(active_.size(), at + kReach + 1);
      for (std::size_t other = at > kReach ? at - kReach : 0; other < end; ++other) {
        const std::uint32_t j = order[other].second;
        const auto same = [j](const Best& one) { return one.with == j; };
        if (j == i || std::any_of(tried.begin(), tried.begin() + static_cast<std::ptrdiff_t>(found), same)) continue;
        const float rough = rough_cost(rough_.data()[i], rough_.data()[j], detail_);
        if (found == kTried && !(rough < tried[found - 1].cost)) continue;
        std::size_t k = found == kTried ? found - 1 : found++;
        for (; k > 0 && rough < tried[k - 1].cost; --k) tried[k] = tried[k - 1];
        tried[k] = {rough, j};
      }
    }
    return {tried, found};
  }

  /// Finds the best partner of each active node. Those of earlier rounds stay while both exist.
  void find_partners() {
    const std::size_t count = active_.size();
    place_of_.assign(nodes_.size(), MergedNode::kNone);
    for (std::uint32_t i = 0; i < count; ++i) place_of_[active_[i]] = i;
    best_.assign(count, Best{});
    for_active([&](std::size_t i) {
      const Best& old = known_[active_[i]];
      if (old.with != MergedNode::kNone && place_of_[old.with] != MergedNode::kNone) {
        best_[i] = {old.cost, place_of_[old.with]};
        return;
      }
      const auto [tried, found] = likely_partners(i);
      for (std::size_t t = 0; t < found; ++t) {
        const std::uint32_t j = tried[t].with;
        // The order of the arguments gives both nodes the same cost, bit for bit.
        const float cost = i < j ? cost_of(all_[i], all_[j], detail_) : cost_of(all_[j], all_[i], detail_);
        if (cost < best_[i].cost || (cost == best_[i].cost && j < best_[i].with)) best_[i] = {cost, j};
      }
    });
    // A new node may suit an old one better than its partner so far.
    for (std::uint32_t i = 0; i < count; ++i) {
      const Best one = best_[i];
      if (one.with == MergedNode::kNone) continue;
      Best& other = best_[one.with];
      if (one.cost < other.cost || (one.cost == other.cost && i < other.with)) other = {one.cost, i};
    }
    for (std::size_t i = 0; i < count; ++i) {
      const std::uint32_t with = best_[i].with;
      known_[active_[i]] = {best_[i].cost, with == MergedNode::kNone ? with : active_[with]};
    }
  }

  Box box_;
  float detail_, edge_ = 1;
  unsigned threads_;
  int round_ = 0;
  std::vector<MergedNode> nodes_;
  std::vector<Best> known_;  // partners by node, from the latest round
  std::vector<std::uint32_t> active_;
  // Of the active nodes, by their positions in active_.
  std::vector<Candidate> all_;
  std::vector<RoughBlob> rough_;
  std::array<std::vector<std::pair<std::uint64_t, std::uint32_t>>, kOrders> orders_;
  std::vector<std::array<std::uint32_t, kOrders>> places_;  // in the orders
  std::vector<Best> best_;
  std::vector<std::uint32_t> place_of_;  // positions in active_ by node
};

}  // namespace

float detail_of(const Gaussians& source, const Box& box) {
  glm::dvec3 mean(0);
  for (const glm::vec3& p : source.positions) mean += glm::dvec3(p) / static_cast<double>(source.size());
  std::vector<float> distances;
  distances.reserve(source.size());
  for (const glm::vec3& p : source.positions) distances.push_back(glm::distance(p, glm::vec3(mean)));
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::ranges::nth_element(distances, middle);
  const glm::vec3 size = box.size();
  return std::max({*middle * kDetail, 1e-6f * std::max({size.x, size.y, size.z}), 1e-9f});
}

Forest leaves_of(const Gaussians& source, const Box& box, float detail, std::span<const float> visibility) {
  Forest forest;
  forest.box = box;
  forest.nodes.reserve(2 * source.size());
  forest.nodes.resize(source.size());
  forest.roots.resize(source.size());
  std::iota(forest.roots.begin(), forest.roots.end(), 0u);
  for (std::size_t i = 0; i < source.size(); ++i) {
    MergedNode& node = forest.nodes[i];
    node.right = static_cast<std::uint32_t>(i);
    node.blob.mean = source.positions[i];
    node.blob.covariance = covariance_of(source.scales[i], source.rotations[i]);
    node.blob.color = source.bases[i];
    node.blob.visibility = visibility[i];
    node.blob.cover = source.opacities[i] * area_of(node.blob.covariance, detail);
    node.blob.weight = node.blob.cover * visibility[i];
  }
  return forest;
}

BlobLook MergeTree::look(std::uint32_t i) const { return look_of(nodes_[i].blob, detail_, nodes_[i].leaf()); }

double MergeTree::energy(std::uint32_t i) const {
  const BlobLook shape = look(i);
  const Covariance& c = shape.covariance;
  const double d = detail_ * detail_, xx = c[0] + d, yy = c[3] + d, zz = c[5] + d;
  const auto flat = [](double a, double b, double ab) { return std::sqrt(std::max(a * b - ab * ab, 0.0)) / 2; };
  const double opacity = double{shape.opacity} * nodes_[i].blob.visibility;
  return opacity * opacity * (flat(xx, yy, c[1]) + flat(yy, zz, c[4]) + flat(xx, zz, c[2]));
}

std::optional<MergeTree> MergeTree::join(Forest forest, float detail, std::size_t most, unsigned threads,
                                         Progress* progress) {
  const std::size_t given = forest.nodes.size();
  TreeBuilder builder(std::move(forest), detail, threads);
  while (builder.roots() > most) {
    if (is_cancelled(progress)) return std::nullopt;
    builder.merge_pairs();
  }
  return builder.take(given);
}

std::optional<MergeTree> MergeTree::build(const Gaussians& source, unsigned threads, Progress* progress) {
  const Box& box = source.description.box;
  const float detail = detail_of(source, box);
  const std::vector<float> visibility = visibility_of(source, threads, progress);
  if (visibility.size() != source.size()) return std::nullopt;
  return join(leaves_of(source, box, detail, visibility), detail, 1, threads, progress);
}

float area_of(const std::array<float, 6>& c, float detail) {
  const float d = detail * detail, xx = c[0] + d, yy = c[3] + d, zz = c[5] + d;
  const float minors = xx * yy - c[1] * c[1] + xx * zz - c[2] * c[2] + yy * zz - c[4] * c[4];
  return 2 * std::numbers::pi_v<float> * std::sqrt(std::max(minors, 0.0f));
}

std::array<float, 6> covariance_of(const glm::vec3& scales, const glm::vec4& q) {
  const glm::mat3 axes = glm::mat3_cast(glm::quat(q.w, q.x, q.y, q.z));
  std::array<float, 6> c{};
  for (int k = 0; k < 3; ++k) {
    const glm::vec3 axis = axes[k] * scales[k];
    c[0] += axis.x * axis.x;
    c[1] += axis.x * axis.y;
    c[2] += axis.x * axis.z;
    c[3] += axis.y * axis.y;
    c[4] += axis.y * axis.z;
    c[5] += axis.z * axis.z;
  }
  return c;
}

}  // namespace gs::qnv::gaussians
