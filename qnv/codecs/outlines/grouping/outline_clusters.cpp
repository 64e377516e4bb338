#include "qnv/codecs/outlines/grouping/outline_parts.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>

namespace gs::qnv::outline {
namespace {

constexpr std::size_t kRange = 1u << 13;

// Conservative bounds of the corners and normals of a cluster.
struct Bounds {
  glm::vec3 normal{0}, center{0};
  float low = 0, high = 0;  // range of dot(normal, corner - center) over all corners
  float radius = 0;  // maximum distance of a corner from the centre
  float angle = 0;  // maximum angle between the normal and the normal of a face
};

struct FaceCluster {
  glm::dvec3 sum{0};  // sum of the vector areas of its faces
  glm::dvec3 moment{0};  // sum of the centres of its faces, weighted by area
  double length = 0;  // length of `sum`
  double area = 0, firm_area = 0;  // area of all faces; area of the faces that are not thin
  double perimeter = 0;
  std::uint32_t first = kNone, last = kNone;  // linked list of its faces
  std::uint32_t faces = 0;

  [[nodiscard]] glm::dvec3 center() const { return moment / area; }
};

struct Edge {
  std::uint32_t a = 0, b = 0;  // indices of the clusters, a < b
  float length = 0;  // length of the shared boundary
  bool refused = false;  // the two clusters cannot be merged in their current state
};

// Converts a bound to single precision, rounded outwards.
float outward(double x) { return static_cast<float>(x + std::fabs(x) * 1e-6 + std::numeric_limits<float>::min()); }

class Clustering {
 public:
  Clustering(const Mesh& mesh, const Labels& regions, const OutlineOptions& options, Progress* progress)
      : mesh_(mesh),
        threads_(options.threads),
        progress_(progress),
        tolerance_(options.tolerance),
        angle_(std::min(options.angle, std::numbers::pi)),
        target_(options.groups),
        next_face_(mesh.face_count(), kNone) {
    make_clusters(regions);
    make_edges(regions);
  }

  Labels run() {
    // Limit of the work: clusters in the form of stars or chains could need as many rounds as there are clusters.
    std::uint64_t budget = 256 * std::uint64_t{edges_.size()} + 4096;
    while (clusters_.size() > target_ && edges_.size() < budget) {
      budget -= edges_.size();
      choose();
      if (!merge_chosen()) break;
      if (progress_) {
        if (progress_->cancelled) break;
        progress_->done = mesh_.face_count() - clusters_.size();
      }
    }
    Labels labels;
    labels.count = static_cast<std::uint32_t>(clusters_.size());
    labels.of.resize(mesh_.face_count());
    for (std::uint32_t i = 0; i < clusters_.size(); ++i)
      for (std::uint32_t face = clusters_[i].first; face != kNone; face = next_face_[face]) labels.of[face] = i;
    return labels;
  }

 private:
  // Cluster that would result from merging two clusters.
  struct Union {
    glm::dvec3 normal{0}, center{0};
    double low = 0, high = 0, radius = 0, angle = 0;
  };

  void make_clusters(const Labels& regions) {
    clusters_.resize(regions.count);
    bounds_.resize(regions.count);
    for (std::uint32_t face = 0; face < mesh_.face_count(); ++face) {
      FaceCluster& cluster = clusters_[regions.of[face]];
      (cluster.first == kNone ? cluster.first : next_face_[cluster.last]) = face;
      cluster.last = face;
      ++cluster.faces;
    }
    for_ranges(clusters_.size(), kRange, threads_, [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i) measure(clusters_[i], bounds_[i]);
    });
  }

  void measure(FaceCluster& cluster, Bounds& bounds) const {
    for (std::uint32_t face = cluster.first; face != kNone; face = next_face_[face]) {
      const double area = std::max(mesh_.areas[face], 1e-200);
      glm::dvec3 center(0);
      for (std::uint32_t h = mesh_.begins[face]; h < mesh_.begins[face + 1]; ++h) center += mesh_.position(h);
      cluster.moment += center * (area / (mesh_.begins[face + 1] - mesh_.begins[face]));
      cluster.area += area;
      if (mesh_.thin[face]) continue;
      cluster.firm_area += area;
      cluster.sum += mesh_.normals[face] * area;
    }
    cluster.length = glm::length(cluster.sum);
    Union whole;
    whole.normal = cluster.length > 0 ? cluster.sum / cluster.length : glm::dvec3(0);
    whole.center = cluster.center();
    whole.low = INFINITY;
    whole.high = -INFINITY;
    scan(cluster, whole, false);
    keep(whole, bounds);
  }

  void make_edges(const Labels& regions) {
    std::vector<Edge> edges;
    for (std::uint32_t h = 0; h < mesh_.vertices.size(); ++h) {
      const std::uint32_t mate = mesh_.mates[h], a = regions.of[mesh_.faces[h]];
      if (mate != kNone && regions.of[mesh_.faces[mate]] == a) continue;
      const double length = glm::length(mesh_.position(mesh_.next(h)) - mesh_.position(h));
      clusters_[a].perimeter += length;
      if (mate == kNone || mate < h) continue;
      const std::uint32_t b = regions.of[mesh_.faces[mate]];
      edges.push_back({std::min(a, b), std::max(a, b), static_cast<float>(length), false});
    }
    edges_ = std::move(edges);
    join_parallel();
  }

  // Extends the union's bounds exactly to the corners and normals of a cluster. If `limited`, stops and returns false
  // when the bounds exceed the tolerances.
  bool scan(const FaceCluster& cluster, Union& whole, bool limited) const {
    double least = 1, radius2 = whole.radius * whole.radius;
    const double least_allowed = std::cos(angle_);
    bool fits = true;
    for (std::uint32_t face = cluster.first; face != kNone && fits; face = next_face_[face]) {
      if (!mesh_.thin[face]) least = std::min(least, glm::dot(mesh_.normals[face], whole.normal));
      for (std::uint32_t h = mesh_.begins[face]; h < mesh_.begins[face + 1]; ++h) {
        const glm::dvec3 from = mesh_.position(h) - whole.center;
        const double distance = glm::dot(from, whole.normal);
        whole.low = std::min(whole.low, distance);
        whole.high = std::max(whole.high, distance);
        radius2 = std::max(radius2, glm::dot(from, from));
      }
      if (limited) fits = least >= least_allowed && whole.high - whole.low <= 2 * tolerance_;
    }
    whole.radius = std::sqrt(radius2);
    whole.angle = std::max(whole.angle, std::acos(std::clamp(least, -1.0, 1.0)));
    return fits;
  }

  static void keep(const Union& whole, Bounds& bounds) {
    bounds.normal = glm::vec3(whole.normal);
    bounds.center = glm::vec3(whole.center);
    // Adds the rounding errors of the centre and the normal, which affect all distances.
    const double slack = (glm::length(whole.center) + whole.radius) * 4e-7;
    bounds.low = -outward(slack - whole.low);
    bounds.high = outward(whole.high + slack);
    bounds.radius = outward(whole.radius + slack);
    bounds.angle = outward(whole.angle + 1e-6);
  }

  // Extends the union's bounds conservatively to the bounds of a part, relative to the union's normal and centre.
  static void extend(const Bounds& part, Union& whole) {
    const glm::dvec3 normal(part.normal), away = glm::dvec3(part.center) - whole.center;
    const double turn = glm::length(whole.normal - normal) * part.radius;
    const double base = glm::dot(whole.normal, away);
    whole.low = std::min(whole.low, base + part.low - turn);
    whole.high = std::max(whole.high, base + part.high + turn);
    whole.radius = std::max(whole.radius, glm::length(away) + part.radius);
    const double chord = glm::length(whole.normal - normal);
    const double turned = normal == glm::dvec3(0) ? 0 : 2 * std::asin(std::min(1.0, chord / 2));
    whole.angle = std::max(whole.angle, part.angle + turned);
  }

  // Returns the cost of a merger: the increase of the L2,1 error of Cohen-Steiner et al., times a penalty for a short
  // shared boundary. The increase is proportional to |a| + |b| - |a + b|; it is computed without cancellation. Returns
  // infinity if the union would certainly be too bent or too thick.
  [[nodiscard]] double cost(const Edge& edge) const {
    const FaceCluster &a = clusters_[edge.a], &b = clusters_[edge.b];
    const glm::dvec3 sum = a.sum + b.sum;
    const double length = glm::length(sum), dot = glm::dot(a.sum, b.sum), product = a.length * b.length;
    if (!(length > 0)) return a.firm_area == 0 && b.firm_area == 0 ? 0 : INFINITY;
    const double least = std::cos(angle_);
    if (glm::dot(a.sum, sum) < least * a.firm_area * length * (1 - 1e-9) - 1e-300 ||
        glm::dot(b.sum, sum) < least * b.firm_area * length * (1 - 1e-9) - 1e-300)
      return INFINITY;
    const double apart = std::fabs(glm::dot(a.center() - b.center(), sum)) / length;
    if (apart > 2 * tolerance_ * (1 + 1e-9)) return INFINITY;
    const glm::dvec3 cross = glm::cross(a.sum, b.sum);
    const double bend = dot > 0 ? glm::dot(cross, cross) / (product + dot) : product - dot;
    const double error = 2 * bend / (a.length + b.length + length);
    // Prefers to merge a cluster with a cluster that surrounds it, not with one that merely touches it.
    const double perimeter = std::min(a.perimeter, b.perimeter), shared = edge.length;
    return perimeter > shared ? error * perimeter / std::max(shared, perimeter * 1e-6) : error;
  }

  // Chooses the edges that are the cheapest at both of their clusters. Compares costs coarsely, then pseudo-randomly.
  // Otherwise a chain of edges, each cheaper than the previous one, could limit a round to one merger.
  void choose() {
    keys_.resize(edges_.size());
    best_ = std::vector<std::atomic<std::uint64_t>>(clusters_.size());
    for (auto& entry : best_) entry.store(kNever, std::memory_order_relaxed);
    const auto lower = [](std::atomic<std::uint64_t>& entry, std::uint64_t key) {
      std::uint64_t now = entry.load(std::memory_order_relaxed);
      while (key < now && !entry.compare_exchange_weak(now, key, std::memory_order_relaxed)) {
      }
    };
    for_ranges(edges_.size(), kRange, threads_, [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i) {
        keys_[i] = edges_[i].refused ? kNever : key_of(static_cast<std::uint32_t>(i));
        edges_[i].refused = keys_[i] == kNever;
        if (keys_[i] == kNever) continue;
        lower(best_[edges_[i].a], keys_[i]);
        lower(best_[edges_[i].b], keys_[i]);
      }
    });
    chosen_.clear();
    for (std::uint32_t i = 0; i < edges_.size(); ++i)
      if (keys_[i] != kNever && best_[edges_[i].a] == keys_[i] && best_[edges_[i].b] == keys_[i]) chosen_.push_back(i);
    std::sort(chosen_.begin(), chosen_.end(), [&](std::uint32_t a, std::uint32_t b) { return keys_[a] < keys_[b]; });
    // Close to the target number of clusters, avoids expensive mergers as long as cheap ones remain.
    const bool near = clusters_.size() / 16 <= target_;
    if (target_ > 0)
      chosen_.resize(std::min(near ? (chosen_.size() + 1) / 2 : chosen_.size(), clusters_.size() - target_));
  }

  [[nodiscard]] std::uint64_t key_of(std::uint32_t edge) const {
    const double value = cost(edges_[edge]);
    if (!(value < INFINITY)) return kNever;
    // Keeps the sign, the exponent and three bits of the fraction.
    const std::uint64_t rough = std::bit_cast<std::uint64_t>(value) >> 49;
    const std::uint64_t chance = (std::uint64_t{edge} * 0x9e3779b97f4a7c15u) >> 47;
    return rough << 49 | chance << 32 | edge;
  }

  // Merges the chosen pairs of clusters. Returns false if no pair was chosen.
  bool merge_chosen() {
    if (chosen_.empty()) return false;
    into_.resize(clusters_.size());
    std::iota(into_.begin(), into_.end(), 0u);
    for_ranges(chosen_.size(), 256, threads_, [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i) {
        Edge& edge = edges_[chosen_[i]];
        if (merge(edge.a, edge.b, true))
          into_[edge.b] = edge.a;
        else
          edge.refused = true;
      }
    });
    std::size_t left = clusters_.size();
    for (std::size_t i = 0; i < into_.size(); ++i) left -= into_[i] != i;
    absorb_small(left);
    if (left < clusters_.size()) renumber(left);
    return true;
  }

  // Merges small clusters into larger ones. A large cluster may be the best choice for many small ones; otherwise it
  // would absorb only one of them per round.
  void absorb_small(std::size_t& left) {
    constexpr std::uint32_t kSmall = 8;  // minimum ratio of face counts
    for (std::uint32_t i = 0; i < clusters_.size() && left > target_ + 1; ++i) {
      const std::uint64_t key = best_[i].load(std::memory_order_relaxed);
      if (key == kNever || into_[i] != i) continue;
      const Edge& edge = edges_[key & 0xffffffffu];
      const std::uint32_t to = root(edge.a == i ? edge.b : edge.a);
      if (to == i || clusters_[i].faces > clusters_[to].faces / kSmall || !merge(to, i, false)) continue;
      into_[i] = to;
      --left;
    }
  }

  [[nodiscard]] std::uint32_t root(std::uint32_t cluster) const {
    while (into_[cluster] != cluster) cluster = into_[cluster];
    return cluster;
  }

  // Removes merged clusters, and renumbers clusters and edges.
  void renumber(std::size_t left) {
    std::vector<std::uint32_t> number(clusters_.size());
    std::vector<std::uint8_t> changed(left);
    std::uint32_t next = 0;
    for (std::uint32_t i = 0; i < clusters_.size(); ++i) {
      if (into_[i] != i) continue;
      clusters_[next] = clusters_[i];
      bounds_[next] = bounds_[i];
      number[i] = next++;
    }
    for (std::uint32_t i = 0; i < into_.size(); ++i) {
      if (into_[i] == i) continue;
      number[i] = number[root(i)];
      changed[number[i]] = 1;
    }
    clusters_.resize(left);
    bounds_.resize(left);
    for_ranges(edges_.size(), kRange * 4, threads_, [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i) {
        Edge& edge = edges_[i];
        const std::uint32_t a = number[edge.a], b = number[edge.b];
        edge = {std::min(a, b), std::max(a, b), edge.length, edge.refused && !changed[a] && !changed[b]};
      }
    });
    join_parallel();
  }

  // Merges cluster b into a if the result is within the tolerances. Unless `thorough`, merges only if the bounds of
  // both clusters prove that the result is.
  bool merge(std::uint32_t a, std::uint32_t b, bool thorough) {
    FaceCluster &to = clusters_[a], &from = clusters_[b];
    FaceCluster both = to;
    both.sum += from.sum;
    both.moment += from.moment;
    both.length = glm::length(both.sum);
    both.area += from.area;
    both.perimeter += from.perimeter;
    both.firm_area += from.firm_area;
    both.faces += from.faces;
    Union whole;
    whole.normal = both.length > 0 ? both.sum / both.length : glm::dvec3(0);
    whole.center = both.center();
    whole.low = INFINITY;
    whole.high = -INFINITY;
    Union quick = whole;
    extend(bounds_[a], quick);
    extend(bounds_[b], quick);
    if (quick.high - quick.low <= 2 * tolerance_ && quick.angle <= angle_) {
      whole = quick;
    } else if (!thorough) {
      return false;
    } else {
      const bool from_first = from.faces < to.faces;  // starts with the smaller cluster, which is faster
      if (!scan(from_first ? from : to, whole, true) || !scan(from_first ? to : from, whole, true)) return false;
    }
    next_face_[to.last] = from.first;
    both.last = from.last;
    to = both;
    keep(whole, bounds_[a]);
    return true;
  }

  // Sorts the edges, and combines all edges between the same two clusters. Subtracts edges inside a cluster from the
  // cluster's perimeter.
  void join_parallel() {
    std::vector<std::uint32_t> begins(clusters_.size() + 1);
    for (const Edge& edge : edges_) {
      if (edge.a == edge.b)
        clusters_[edge.a].perimeter -= 2 * double{edge.length};
      else
        ++begins[edge.a + 1];
    }
    for (std::size_t i = 1; i < begins.size(); ++i) begins[i] += begins[i - 1];
    std::vector<Edge> sorted(begins.back());
    std::vector<std::uint32_t> at(begins.begin(), begins.end() - 1);
    for (const Edge& edge : edges_)
      if (edge.a != edge.b) sorted[at[edge.a]++] = edge;
    for_ranges(clusters_.size(), kRange, threads_, [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i)
        std::sort(sorted.begin() + begins[i], sorted.begin() + begins[i + 1],
                  [](const Edge& x, const Edge& y) { return x.b < y.b; });
    });
    std::size_t to = 0;
    for (const Edge& edge : sorted) {
      if (to > 0 && sorted[to - 1].a == edge.a && sorted[to - 1].b == edge.b) {
        sorted[to - 1].length += edge.length;
        sorted[to - 1].refused = sorted[to - 1].refused && edge.refused;
      } else {
        sorted[to++] = edge;
      }
    }
    sorted.resize(to);
    edges_ = std::move(sorted);
  }

  static constexpr std::uint64_t kNever = ~std::uint64_t{0};

  const Mesh& mesh_;
  unsigned threads_;
  Progress* progress_;
  double tolerance_, angle_;
  std::size_t target_;
  std::vector<std::uint32_t> next_face_;
  std::vector<FaceCluster> clusters_;
  std::vector<Bounds> bounds_;
  std::vector<Edge> edges_;
  std::vector<std::uint64_t> keys_;
  std::vector<std::uint32_t> chosen_;
  std::vector<std::atomic<std::uint64_t>> best_;  // key of the cheapest edge of each cluster
  std::vector<std::uint32_t> into_;  // target of each cluster's merger in this round, or the cluster
};

}  // namespace

Labels cluster_regions(const Mesh& mesh, const Labels& regions, const OutlineOptions& options, Progress* progress) {
  return Clustering(mesh, regions, options, progress).run();
}

}  // namespace gs::qnv::outline
