#pragma once

#include "vrml/mesh/mesh.h"

#include <glm/vec3.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace gs::render {

/// Half line for a search of the nearest hit. Distances are multiples of the length of `direction`, so that transforms
/// do not change them.
struct SightLine {
  glm::dvec3 origin{0}, direction{0, 0, -1};
  double farthest = std::numeric_limits<double>::infinity();
};

/// Bounding volume hierarchy for searches along lines and in boxes. Uses at most 26 bytes per box.
class BoxTree {
 public:
  struct Entry {
    Box box;  // an empty box is never hit
    std::uint32_t thing = 0;
  };

  /// Half line with precomputed values for fast box tests.
  struct Walker {
    glm::dvec3 origin, inverse;
    explicit Walker(const SightLine& line);
    /// Returns the distance at which the line enters the box. Returns infinity if it is not less than `farthest`.
    [[nodiscard]] double enter(const glm::vec3& lower, const glm::vec3& upper, double farthest) const;
  };

  BoxTree() = default;
  /// Builds the tree of things with the indexes 0, 1, ... The entries may have any order. Reuses their memory.
  explicit BoxTree(std::vector<Entry> entries);

  /// Replaces the boxes; `boxes` is indexed by thing. Large movements make searches slower.
  void refit(const std::vector<Box>& boxes);
  [[nodiscard]] std::size_t bytes() const {
    return nodes_.capacity() * sizeof(Node) + order_.capacity() * sizeof(std::uint32_t);
  }

  /// Calls `meet(thing, farthest)` for things with boxes on the line, nearer boxes first. `meet` returns the new
  /// maximum distance of the search.
  template <class Meet>
  void visit(const SightLine& line, const Meet& meet) const;
  /// Calls `meet(thing)` for things with boxes that may touch the box from `lower` to `upper`. Stops if `meet` returns
  /// false.
  template <class Meet>
  void visit(const glm::dvec3& lower, const glm::dvec3& upper, const Meet& meet) const;
  /// Calls `meet(thing)` for all things except those in a box that satisfies `outside(lower, upper)`. May also call
  /// `meet` for some excluded things. Stops if `meet` returns false.
  template <class Outside, class Meet>
  void visit_unless(const Outside& outside, const Meet& meet) const;

 private:
  // Node. Its first child, if any, is the next node in the array.
  struct Node {
    glm::vec3 lower;
    std::uint32_t place;  // index of the second child; in a leaf, index of the first thing in order_
    glm::vec3 upper;
    std::uint32_t count;  // number of things in a leaf; 0 means that the node has children
  };
  static_assert(sizeof(Node) == 32);
  // Nodes with more than kMaxThings are split into parts of at least kMinThings. This bounds the number of nodes.
  static constexpr std::size_t kMaxThings = 6, kMinThings = 3;
  // Nodes below depth kBalanced are split in halves. This bounds the depth.
  static constexpr std::uint32_t kBalanced = 48;
  static constexpr std::size_t kDeepest = 96;

  [[nodiscard]] static std::size_t part(Entry* entries, std::size_t count, bool halves);

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> order_;
};

inline BoxTree::Walker::Walker(const SightLine& line) : origin(line.origin), inverse(1.0 / line.direction) {}

inline double BoxTree::Walker::enter(const glm::vec3& lower, const glm::vec3& upper, double farthest) const {
  constexpr double kRounding = 1 + 1e-12;  // margin for rounding: a flat box has equal entry and exit
  double first = 0, last = farthest;
  for (int i = 0; i < 3; ++i) {
    const bool forward = inverse[i] > 0;
    const double in = ((forward ? lower[i] : upper[i]) - origin[i]) * inverse[i];
    const double out = ((forward ? upper[i] : lower[i]) - origin[i]) * inverse[i];
    // If the line is in the plane of a face, 0 times infinity is NaN. The comparisons ignore NaN.
    if (in > first) first = in;
    if (out < last) last = out;
  }
  return first <= last * kRounding ? first : std::numeric_limits<double>::infinity();
}

template <class Meet>
void BoxTree::visit(const SightLine& line, const Meet& meet) const {
  if (nodes_.empty()) return;
  constexpr double kMissed = std::numeric_limits<double>::infinity();
  const Walker walker(line);
  const auto enter = [&](std::uint32_t place, double before) {
    return walker.enter(nodes_[place].lower, nodes_[place].upper, before);
  };
  double farthest = line.farthest;
  std::array<std::pair<std::uint32_t, double>, kDeepest> open;  // nodes to visit, with distances
  std::size_t count = 0;
  if (const double enters = enter(0, farthest); enters < kMissed) open[count++] = {0, enters};
  while (count > 0) {
    const auto [place, enters] = open[--count];
    if (enters > farthest) continue;
    const Node& node = nodes_[place];
    if (node.count > 0) {
      for (std::uint32_t i = 0; i < node.count; ++i) farthest = meet(order_[node.place + i], farthest);
      continue;
    }
    std::pair<std::uint32_t, double> near{place + 1, enter(place + 1, farthest)},
        far{node.place, enter(node.place, farthest)};
    if (far.second < near.second) std::swap(near, far);
    if (far.second < kMissed) open[count++] = far;
    if (near.second < kMissed) open[count++] = near;
  }
}

template <class Meet>
void BoxTree::visit(const glm::dvec3& lower, const glm::dvec3& upper, const Meet& meet) const {
  const auto apart = [&](const glm::vec3& from, const glm::vec3& to) {
    bool any = false;
    for (int i = 0; i < 3; ++i) any |= from[i] > upper[i] || to[i] < lower[i];
    return any;
  };
  visit_unless(apart, meet);
}

template <class Outside, class Meet>
void BoxTree::visit_unless(const Outside& outside, const Meet& meet) const {
  if (nodes_.empty()) return;
  std::array<std::uint32_t, kDeepest> open;
  std::size_t count = 0;
  open[count++] = 0;
  while (count > 0) {
    const std::uint32_t place = open[--count];
    const Node& node = nodes_[place];
    if (!(node.lower.x <= node.upper.x) || outside(node.lower, node.upper)) continue;
    for (std::uint32_t i = 0; i < node.count; ++i)
      if (!meet(order_[node.place + i])) return;
    if (node.count > 0) continue;
    open[count++] = node.place;
    open[count++] = place + 1;
  }
}

}  // namespace gs::render
