#include "qnv/mesh/simplify/simplifier.h"

#include <algorithm>

// Closing of small holes and tunnels in scanned noise. Collapses cannot close them, so they would use up all triangles.
namespace gs::qnv::displaced {
namespace {

// Maximum perimeter of holes and of tunnels that are too small to be visible, in edges of the result.
constexpr double kHoleEdges = 1.5, kTunnelEdges = 0.75;
constexpr std::size_t kMaxSearched = 3000;  // maximum number of triangles searched between both sides of a tunnel

}  // namespace

void Simplifier::repair(double edge) {
  close_rims(kHoleEdges * edge);
  cut_tunnels(kTunnelEdges * edge);
  push_all();
}

double Simplifier::round(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
  return glm::length(positions_[a] - positions_[b]) + glm::length(positions_[b] - positions_[c]) +
         glm::length(positions_[c] - positions_[a]);
}

// Fills holes of three edges with a triangle. Skips holes that are the outside of a single triangle.
void Simplifier::close_rims(double most) {
  for (std::uint32_t u = 0; u < mesh_.vertices(); ++u) {
    if (!rim_[u] || !mesh_.used(u)) continue;
    // Follows the rim from u along the side without a triangle on its left, opposite to the direction of the triangles.
    mesh_.gather(u, at_u_);
    for (const std::uint32_t corner : std::vector<std::uint32_t>(at_u_)) {
      const std::uint32_t v = mesh_.of(corner)[(corner % 3 + 2) % 3];  // side from v to u
      if (mesh_.left_of(u, v) != kNone) continue;
      mesh_.any_corner(v, [&](std::uint32_t c) {
        const std::uint32_t w = mesh_.of(c)[(c % 3 + 2) % 3];  // side from w to v
        if (w == u || mesh_.left_of(v, w) != kNone || mesh_.left_of(u, w) == kNone || mesh_.left_of(w, u) != kNone ||
            round(u, v, w) > most || mesh_.third(corner / 3, u, v) == w)
          return false;
        mesh_.add_triangle({u, v, w});
        return true;
      });
    }
  }
  for (std::uint32_t v = 0; v < mesh_.vertices(); ++v) {
    if (!rim_[v] || !mesh_.used(v)) continue;
    mesh_.gather(v, at_v_);
    rim_[v] = std::any_of(at_v_.begin(), at_v_.end(), [&](std::uint32_t corner) {
      return mesh_.left_of(v, mesh_.of(corner)[(corner % 3 + 2) % 3]) == kNone ||
             mesh_.left_of(mesh_.of(corner)[(corner % 3 + 1) % 3], v) == kNone;
    });
  }
}

// Cuts the surface along cycles of three edges that are not the sides of a triangle, and closes both sides.
void Simplifier::cut_tunnels(double most) {
  const std::uint32_t vertices = mesh_.vertices();
  for (std::uint32_t u = 0; u < vertices; ++u) {
    if (rim_[u] || !mesh_.used(u)) continue;
    mesh_.gather(u, at_u_);
    std::vector<std::uint32_t> beside;
    for (const std::uint32_t corner : at_u_) beside.push_back(mesh_.of(corner)[(corner % 3 + 1) % 3]);
    bool cut = false;
    for (std::size_t i = 0; i < beside.size() && !cut; ++i) {
      const std::uint32_t v = beside[i];
      if (u > v || rim_[v]) continue;
      // Marks the ends of sides that leave v. Few of them are other neighbours of u, except along u's own triangles.
      ++marks_;
      mesh_.any_corner(v, [&](std::uint32_t c) {
        if (const Corners& t = mesh_.of(c); t[(c % 3 + 2) % 3] != u) mark_[t[(c % 3 + 1) % 3]] = marks_;
        return false;
      });
      const std::uint32_t marked = marks_;
      for (std::size_t j = 0; j < beside.size() && !cut; ++j) {
        const std::uint32_t w = beside[j];
        if (mark_[w] != marked || i == j || u > w || rim_[w] || round(u, v, w) > most) continue;
        const std::uint32_t left = mesh_.left_of(v, w), right = mesh_.left_of(w, v);
        if (left == kNone || right == kNone || mesh_.third(left, v, w) == u || mesh_.third(right, v, w) == u) continue;
        cut = joined_elsewhere({u, v, w}) && cut_along({u, v, w});
      }
    }
  }
}

bool Simplifier::joined_elsewhere(const Corners& cycle) {
  // Searches a path from the left of the cycle to its right across other edges. Without such a path, the cut would
  // separate a part.
  const std::uint32_t from = mesh_.left_of(cycle[0], cycle[1]), to = mesh_.left_of(cycle[1], cycle[0]);
  if (from == kNone || to == kNone) return false;
  const auto on_cycle = [&](std::uint32_t v) { return v == cycle[0] || v == cycle[1] || v == cycle[2]; };
  seen_triangles_.resize(mesh_.triangles().size(), 0);
  ++searches_;
  std::vector<std::uint32_t> open{from};
  seen_triangles_[from] = searches_;
  for (std::size_t i = 0; i < std::min(open.size(), kMaxSearched); ++i) {
    if (open[i] == to) return true;
    const Corners& t = mesh_.triangles()[open[i]];
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k], b = t[(k + 1) % 3];
      if (on_cycle(a) && on_cycle(b)) continue;
      const std::uint32_t beside = mesh_.left_of(b, a);
      if (beside == kNone || seen_triangles_[beside] == searches_) continue;
      seen_triangles_[beside] = searches_;
      open.push_back(beside);
    }
  }
  return false;
}

bool Simplifier::cut_along(const Corners& cycle) {
  // triangles at each vertex that are on the left of the cycle
  std::array<std::vector<std::uint32_t>, 3> left;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t v = cycle[k], before = cycle[(k + 2) % 3];
    for (std::uint32_t to = cycle[(k + 1) % 3]; to != before;) {
      const std::uint32_t t = mesh_.left_of(v, to);
      if (t == kNone || left[k].size() > 1000) return false;
      for (std::uint32_t c = 0; c < 3; ++c)
        if (mesh_.triangles()[t][c] == v) left[k].push_back(3 * t + c);
      to = mesh_.third(t, v, to);
    }
  }
  Corners copies{};
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t v = cycle[k];
    positions_.push_back(glm::dvec3(positions_[v]));
    quadrics_.push_back(Quadric(quadrics_[v]));
    areas_.push_back(double{areas_[v]});
    stamp_.push_back(0);
    mark_.push_back(0);
    rim_.push_back(false);
    ++stamp_[v];
    std::vector<std::uint32_t> all;
    mesh_.gather(v, all);
    copies[k] = mesh_.split(v, all, [&](std::uint32_t corner) {
      return std::find(left[k].begin(), left[k].end(), corner) != left[k].end();
    });
  }
  mesh_.add_triangle({copies[0], copies[2], copies[1]});
  mesh_.add_triangle(cycle);
  return true;
}

}  // namespace gs::qnv::displaced
