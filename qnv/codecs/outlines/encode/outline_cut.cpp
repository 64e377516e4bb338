#include "qnv/codecs/outlines/encode/outline_pool.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

// Cuts a polygon with too many corners for a record into halves, along one coordinate of its projection. Corners
// exactly on the line count as below the line. Thus no corner is on the line, and each ring crosses the line an even
// number of times.
namespace gs::qnv::outline {
namespace {

constexpr std::size_t kNoIndex = std::numeric_limits<std::size_t>::max();

/// Corners of a ring on one side of the line, between two crossings.
struct Chain {
  std::vector<Corner> corners;
  std::size_t to = kNoIndex;  // index of the crossing at its end
};

struct Crossing {
  double along = 0;  // position of the crossing along the line
  bool upwards = false;  // true if the ring goes from below to above
  Corner corner;
  std::size_t chain = kNoIndex;  // index of the chain that starts here
  std::size_t partner = kNoIndex;
};

class PolygonCutter {
 public:
  PolygonCutter(const Polygon& polygon, std::size_t across, std::size_t along)
      : polygon_(polygon), across_(across), along_(along) {
    std::vector<std::uint32_t> values;
    for (const Corner& corner : polygon.corners) values.push_back(corner.p[across]);
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    line_ = *middle;
    // Corners with the middle value count as below. Lowers the line if no corner would be above.
    if (line_ == *std::max_element(values.begin(), values.end())) line_ = line_ == 0 ? 0 : line_ - 1;
  }

  bool cut(std::vector<LatticeRings>& pieces) {
    for (std::size_t ring = 0; ring < polygon_.ring_ends.size(); ++ring) {
      const std::size_t begin = polygon_.ring_begin(ring);
      add_ring(polygon_.corners.subspan(begin, polygon_.ring_end(ring) - begin));
    }
    if (crossings_.empty() || !pair_up()) return false;
    return trace(true, pieces) && trace(false, pieces);
  }

 private:
  [[nodiscard]] bool below(const Corner& corner) const { return corner.p[across_] <= line_; }

  void add_ring(std::span<const Corner> ring) {
    std::size_t first = 0;
    while (first < ring.size() && below(ring[first]) == below(ring[(first + ring.size() - 1) % ring.size()])) ++first;
    if (first == ring.size()) {
      (below(ring[0]) ? whole_below_ : whole_above_).emplace_back(ring.begin(), ring.end());
      return;
    }
    const std::size_t first_crossing = crossings_.size();
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const Corner& corner = ring[(first + i) % ring.size()];
      const Corner& before = ring[(first + i + ring.size() - 1) % ring.size()];
      if (below(corner) != below(before)) {
        if (crossings_.size() > first_crossing) chains_.back().to = crossings_.size();
        crossings_.push_back(crossing(before, corner));
        crossings_.back().chain = chains_.size();
        chains_.emplace_back();
      }
      chains_.back().corners.push_back(corner);
    }
    chains_.back().to = first_crossing;
  }

  [[nodiscard]] Crossing crossing(const Corner& from, const Corner& to) const {
    Crossing crossing;
    crossing.upwards = below(from);
    // Computes from the lower end, so that both directions give the same result.
    const Corner& a = crossing.upwards ? from : to;
    const Corner& b = crossing.upwards ? to : from;
    const double begin = a.p[across_], part = (line_ + 0.5 - begin) / (b.p[across_] - begin);
    const auto between = [part](double lower, double upper) { return lower + (upper - lower) * part; };
    crossing.along = between(a.p[along_], b.p[along_]);
    for (std::size_t axis = 0; axis < 3; ++axis)
      crossing.corner.p[axis] = static_cast<std::uint32_t>(std::lround(between(a.p[axis], b.p[axis])));
    crossing.corner.p[across_] = line_;
    for (std::size_t axis = 0; axis < 2; ++axis)
      crossing.corner.t[axis] = static_cast<std::uint32_t>(std::lround(between(a.t[axis], b.t[axis])));
    return crossing;
  }

  /// Pairs the crossings in their order along the line. The inside of the polygon is between the first and the second
  /// crossing, between the third and the fourth, and so on.
  bool pair_up() {
    std::vector<std::size_t> order(crossings_.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return crossings_[a].along < crossings_[b].along; });
    for (std::size_t i = 0; i + 1 < order.size(); i += 2) {
      Crossing &a = crossings_[order[i]], &b = crossings_[order[i + 1]];
      if (a.upwards == b.upwards) return false;
      a.partner = order[i + 1];
      b.partner = order[i];
    }
    return order.size() % 2 == 0;
  }

  /// Traces the pieces on one side of the line. Follows a ring from the crossing where it enters this side to the
  /// crossing where it leaves. Then follows the line to the paired crossing.
  bool trace(bool lower, std::vector<LatticeRings>& pieces) {
    std::vector<bool> done(crossings_.size());
    const std::size_t first_piece = pieces.size();
    for (std::size_t start = 0; start < crossings_.size(); ++start) {
      if (crossings_[start].upwards == lower || done[start]) continue;
      LatticeRings piece;
      for (std::size_t at = start; !done[at];) {
        done[at] = true;
        const Chain& chain = chains_[crossings_[at].chain];
        piece.corners.push_back(crossings_[at].corner);
        piece.corners.insert(piece.corners.end(), chain.corners.begin(), chain.corners.end());
        piece.corners.push_back(crossings_[chain.to].corner);
        at = crossings_[chain.to].partner;
        if (crossings_[at].upwards == lower) return false;
      }
      piece.ring_ends.push_back(static_cast<std::uint32_t>(piece.corners.size()));
      pieces.push_back(std::move(piece));
    }
    add_holes(lower ? whole_below_ : whole_above_, std::span(pieces).subspan(first_piece));
    for (std::size_t i = first_piece; i < pieces.size(); ++i) clean(pieces[i]);
    return true;
  }

  void add_holes(const std::vector<std::vector<Corner>>& holes, std::span<LatticeRings> pieces) const {
    for (const std::vector<Corner>& hole : holes) {
      // Finds the outer ring that contains most corners of the hole; the hole may touch the ring with other corners.
      std::size_t best = 0, most = 0;
      for (std::size_t i = 0; i < pieces.size(); ++i) {
        const auto outer = std::span<const Corner>(pieces[i].corners).first(pieces[i].ring_ends.front());
        std::size_t inside = 0;
        for (std::size_t corner = 0; corner < std::min<std::size_t>(hole.size(), 5); ++corner)
          inside += holds(outer, hole[corner]) ? 1 : 0;
        if (inside > most) most = inside, best = i;
      }
      LatticeRings& piece = pieces[best];
      piece.corners.insert(piece.corners.end(), hole.begin(), hole.end());
      piece.ring_ends.push_back(static_cast<std::uint32_t>(piece.corners.size()));
    }
  }

  [[nodiscard]] bool holds(std::span<const Corner> ring, const Corner& corner) const {
    bool inside = false;
    const double x = corner.p[across_], y = corner.p[along_];
    for (std::size_t i = 0, before = ring.size() - 1; i < ring.size(); before = i++) {
      const double ax = ring[before].p[across_], ay = ring[before].p[along_];
      const double bx = ring[i].p[across_], by = ring[i].p[along_];
      if ((ay > y) != (by > y) && x < ax + (bx - ax) * (y - ay) / (by - ay)) inside = !inside;
    }
    return inside;
  }

  const Polygon& polygon_;
  std::size_t across_, along_;
  std::uint32_t line_ = 0;
  std::vector<Chain> chains_;
  std::vector<Crossing> crossings_;
  std::vector<std::vector<Corner>> whole_below_, whole_above_;
};

}  // namespace

bool cut_polygon(const Polygon& polygon, std::vector<LatticeRings>& pieces) {
  const Plane plane = plane_across(polygon.normal(), 0);
  const auto extent = [&](std::size_t axis) {
    std::uint32_t lower = std::numeric_limits<std::uint32_t>::max(), upper = 0;
    for (const Corner& corner : polygon.corners) {
      lower = std::min(lower, corner.p[axis]);
      upper = std::max(upper, corner.p[axis]);
    }
    return upper - lower;
  };
  std::size_t across = plane.u(), along = plane.v();
  if (extent(along) > extent(across)) std::swap(across, along);
  for (int turn = 0; turn < 2; ++turn, std::swap(across, along)) {
    std::vector<LatticeRings> parts;
    if (!PolygonCutter(polygon, across, along).cut(parts)) continue;
    // Requires that each part has fewer corners, so that cutting terminates.
    const auto smaller = [&](const LatticeRings& part) { return part.corners.size() < polygon.corners.size(); };
    if (!std::all_of(parts.begin(), parts.end(), smaller)) continue;
    for (LatticeRings& part : parts) pieces.push_back(std::move(part));
    return true;
  }
  return false;
}

}  // namespace gs::qnv::outline
