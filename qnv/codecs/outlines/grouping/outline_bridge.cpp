#include "qnv/codecs/outlines/grouping/outline_mesh.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace gs::qnv::outline {
namespace {

// Rings as linked lists. Connects holes to the outer ring one after another (Eberly, Triangulation by Ear Clipping,
// section 3). Holes are sorted by their leftmost vertex. Therefore the outer ring, or a hole that is already connected,
// is to the left of that vertex.
class Bridges {
 public:
  explicit Bridges(const OutlinePolygon& polygon) {
    glm::dvec3 normal(0);
    for (std::size_t i = 0; i < polygon.rings(); ++i) {
      const auto ring = polygon.ring(i);
      normal += ring_area(ring.size(), [&](std::size_t k) { return glm::dvec3(ring[k]); });
    }
    const double length = glm::length(normal);
    const PlaneAxes axes(length > 0 ? normal / length : glm::dvec3(0, 0, 1));
    nodes_.reserve(polygon.positions.size() + 2 * polygon.rings());
    for (std::size_t i = 0; i < polygon.rings(); ++i) {
      const std::size_t begin = polygon.ring_begin(i), end = polygon.ring_end(i);
      for (std::size_t k = begin; k < end; ++k) {
        const std::size_t before = k == begin ? end - 1 : k - 1, after = k + 1 == end ? begin : k + 1;
        nodes_.push_back({axes(glm::dvec3(polygon.positions[k])), static_cast<std::uint32_t>(k),
                          static_cast<std::uint32_t>(before), static_cast<std::uint32_t>(after)});
      }
      if (i > 0 && end > begin) holes_.push_back(leftmost(begin, end));
    }
    std::sort(holes_.begin(), holes_.end(), [&](std::uint32_t a, std::uint32_t b) { return left_of(a, b); });
  }

  std::vector<std::uint32_t> run() {
    std::vector<std::uint32_t> ring;
    if (nodes_.empty()) return ring;
    make_rows();
    enter_ring();
    for (const std::uint32_t hole : holes_) {
      const std::uint32_t to = bridge_to(hole);
      if (to != kNone) hang(hole, to);
    }
    std::uint32_t at = 0;
    do {
      ring.push_back(nodes_[at].corner);
      at = nodes_[at].next;
    } while (at != 0);
    return ring;
  }

 private:
  struct Node {
    glm::dvec2 p;
    std::uint32_t corner, before, next;
  };

  [[nodiscard]] bool left_of(std::uint32_t a, std::uint32_t b) const {
    const glm::dvec2 &p = nodes_[a].p, &q = nodes_[b].p;
    return p.x != q.x ? p.x < q.x : p.y != q.y ? p.y < q.y : a < b;
  }

  [[nodiscard]] std::uint32_t leftmost(std::size_t begin, std::size_t end) const {
    auto best = static_cast<std::uint32_t>(begin);
    for (auto i = static_cast<std::uint32_t>(begin); i < end; ++i)
      if (left_of(i, best)) best = i;
    return best;
  }

  // Chooses rows that are about as high as the average edge.
  void make_rows() {
    double highest = lowest_ = nodes_[0].p.y, sum = 0;
    for (const Node& node : nodes_) {
      lowest_ = std::min(lowest_, node.p.y);
      highest = std::max(highest, node.p.y);
      sum += std::fabs(nodes_[node.next].p.y - node.p.y);
    }
    const auto count = static_cast<double>(nodes_.size());
    const double rows = sum > 0 && !holes_.empty() ? std::min(count * (highest - lowest_) / sum, count / 8) : 1;
    rows_.resize(std::max<std::size_t>(1, static_cast<std::size_t>(rows)));
    rows_per_unit_ = highest > lowest_ ? static_cast<double>(rows_.size()) / (highest - lowest_) : 0;
  }

  [[nodiscard]] std::size_t row_of(double y) const {
    const double row = (y - lowest_) * rows_per_unit_;
    return row > 0 ? static_cast<std::size_t>(std::min(row, static_cast<double>(rows_.size() - 1))) : 0;
  }

  // Adds the edge that starts at a node to the rows that it crosses.
  void enter(std::uint32_t node) {
    constexpr std::size_t kLong = 32;
    const double y = nodes_[node].p.y, next = nodes_[nodes_[node].next].p.y;
    const std::size_t first = row_of(std::min(y, next)), last = row_of(std::max(y, next));
    if (last - first > kLong) {
      long_.push_back(node);
      return;
    }
    for (std::size_t row = first; row <= last; ++row) rows_[row].push_back(node);
  }

  void enter_ring() {
    std::uint32_t at = 0;
    do {
      enter(at);
      at = nodes_[at].next;
    } while (at != 0);
  }

  // Visits the nodes of the ring with edges that may reach heights from `low` to `high`. May visit a node several
  // times.
  template <typename Visit>
  void for_each(double low, double high, const Visit& visit) const {
    for (const std::uint32_t node : long_) visit(node);
    for (std::size_t row = row_of(low), last = row_of(high); row <= last; ++row)
      for (const std::uint32_t node : rows_[row]) visit(node);
  }

  // Reports whether the direction from the node towards p points into the polygon; tests the node's two edges.
  [[nodiscard]] bool opens_to(std::uint32_t node, const glm::dvec2& p) const {
    const glm::dvec2 &here = nodes_[node].p, &before = nodes_[nodes_[node].before].p,
                     &next = nodes_[nodes_[node].next].p;
    const bool left_of_next = turn(here, next, p) >= 0, left_of_before = turn(before, here, p) >= 0;
    return turn(before, here, next) >= 0 ? left_of_next && left_of_before : left_of_next || left_of_before;
  }

  // Returns a node of the ring that is visible from the leftmost vertex of the hole.
  [[nodiscard]] std::uint32_t bridge_to(std::uint32_t hole) const {
    const glm::dvec2 from = nodes_[hole].p;
    std::uint32_t best = kNone, touching = kNone;
    double hit = -INFINITY;
    for_each(from.y, from.y, [&](std::uint32_t at) {
      const glm::dvec2 &a = nodes_[at].p, &b = nodes_[nodes_[at].next].p;
      if (a == from && (touching == kNone || opens_to(at, nodes_[nodes_[hole].next].p))) touching = at;
      if (a.y < from.y || b.y > from.y || a.y == b.y) return;  // the inside is to the right of a downward edge
      const double x = a.x + (from.y - a.y) / (b.y - a.y) * (b.x - a.x);
      if (x > from.x || x <= hit) return;
      hit = x;
      best = a.x < b.x ? at : nodes_[at].next;
    });
    if (touching != kNone) return touching;
    if (best == kNone) return kNone;
    return nearest_in_triangle(from, {hit, from.y}, best);
  }

  // Returns a ring node that is visible from `from`. If ring corners hide the end of the edge that the ray hit, the
  // corner with the smallest angle to the ray is visible.
  [[nodiscard]] std::uint32_t nearest_in_triangle(const glm::dvec2& from, const glm::dvec2& hit,
                                                  std::uint32_t end) const {
    const glm::dvec2 corner = nodes_[end].p;
    const double side = corner.y < from.y ? 1 : -1;  // orients the triangle (from, hit, corner) counter-clockwise
    std::uint32_t best = end;
    double best_slope = INFINITY, best_x = -INFINITY;
    for_each(std::min(from.y, corner.y), std::max(from.y, corner.y), [&](std::uint32_t at) {
      const glm::dvec2& p = nodes_[at].p;
      if (p.x < corner.x || p.x >= from.x) return;
      if (side * turn(from, hit, p) < 0 || side * turn(hit, corner, p) < 0 || side * turn(corner, from, p) < 0) return;
      const double slope = std::fabs(p.y - from.y) / (from.x - p.x);
      if (slope > best_slope || (slope == best_slope && p.x <= best_x) || !opens_to(at, from)) return;
      best = at;
      best_slope = slope;
      best_x = p.x;
    });
    return best;
  }

  // Connects a hole to the node `to`. The ring then visits to, the whole hole, the hole's first node again, to again,
  // and continues.
  void hang(std::uint32_t hole, std::uint32_t to) {
    const auto hole_again = static_cast<std::uint32_t>(nodes_.size()), to_again = hole_again + 1;
    nodes_.push_back({nodes_[hole].p, nodes_[hole].corner, nodes_[hole].before, to_again});
    nodes_.push_back({nodes_[to].p, nodes_[to].corner, hole_again, nodes_[to].next});
    nodes_[nodes_[hole].before].next = hole_again;
    nodes_[nodes_[to].next].before = to_again;
    nodes_[hole].before = to;
    nodes_[to].next = hole;
    enter(to);
    enter(to_again);
    for (std::uint32_t at = hole; at != to_again; at = nodes_[at].next) enter(at);
  }

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> holes_;
  // Index of the ring: nodes by the rows that their edges cross. Edges that cross many rows are in long_.
  std::vector<std::vector<std::uint32_t>> rows_;
  std::vector<std::uint32_t> long_;
  double lowest_ = 0, rows_per_unit_ = 0;
};

}  // namespace
}  // namespace gs::qnv::outline

namespace gs::qnv {

std::vector<std::uint32_t> bridged_ring(const OutlinePolygon& polygon) { return outline::Bridges(polygon).run(); }

}  // namespace gs::qnv
