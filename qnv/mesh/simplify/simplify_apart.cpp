#include "qnv/mesh/simplify/simplifier.h"

#include <algorithm>
#include <utility>

// Independent collapses, which can be undone in any order.
namespace gs::qnv::displaced {

std::vector<HalfCollapse> Simplifier::collapse_apart(std::size_t most) {
  std::vector<HalfCollapse> done;
  std::vector<bool> stays(positions_.size(), false), taken(positions_.size(), false);
  queue_ = {};
  push_all();
  Candidate next{};
  while (done.size() < most && queue_.pop(next)) {
    if (stale(next)) continue;
    std::uint32_t gone = next.u, to = next.v;
    Quadric q = quadrics_[gone];
    q.add(quadrics_[to]);
    // Prefers to keep a rim vertex. Otherwise removes the end with the larger error.
    if (rim_[gone] == rim_[to] ? q.at(positions_[gone]) < q.at(positions_[to]) : rim_[gone]) std::swap(gone, to);
    if (stays[gone] || taken[to] || !may_merge(gone, to, positions_[to])) continue;
    HalfCollapse collapse{gone, to, kNone, kNone, 0};
    taken[to] = true;
    for (const std::uint32_t corner : at_u_) {
      const Corners& t = mesh_.of(corner);
      const std::uint32_t after = t[(corner % 3 + 1) % 3], before = t[(corner % 3 + 2) % 3];
      stays[after] = stays[before] = true;
      if (after == to) collapse.left = before;
      if (before == to) collapse.right = after;
    }
    const double area = areas_[gone] + areas_[to];
    collapse.distance = area > 0 ? std::sqrt(std::max(q.at(positions_[to]), 0.0) / area) : 0;
    done.push_back(collapse);
    merge(gone, to, q, glm::dvec3(positions_[to]));
  }
  return done;
}

}  // namespace gs::qnv::displaced
