#include "qnv/sampling/volume/marching_cubes.h"

#include <algorithm>
#include <cstddef>
#include <limits>

namespace gs::qnv::marching_cubes {
namespace {

constexpr std::uint8_t kNone = 0xff;
constexpr std::size_t kFaceSets = 64;

std::uint8_t edge_between(std::uint8_t a, std::uint8_t b) {
  for (std::uint8_t e = 0; e < kEdges.size(); ++e)
    if (kEdges[e].lower == std::min(a, b) && kEdges[e].upper == std::max(a, b)) return e;
  return kNone;
}

bool is_inside(std::uint8_t inside, std::uint8_t corner) { return (inside >> corner & 1) != 0; }

bool has_corner(std::size_t face, std::uint8_t corner) {
  return std::find(kFaces[face].begin(), kFaces[face].end(), corner) != kFaces[face].end();
}

bool share_face(std::uint8_t a, std::uint8_t b) {
  for (std::size_t face = 0; face < kFaces.size(); ++face)
    if (has_corner(face, kEdges[a].lower) && has_corner(face, kEdges[a].upper) && has_corner(face, kEdges[b].lower) &&
        has_corner(face, kEdges[b].upper))
      return true;
  return false;
}

// Connects the points at which the surface crosses a face into segments. Around a face, each segment starts at an edge
// that enters the inside and ends at an edge that leaves the inside. Usually it ends at the next such edge, which cuts
// off an inside corner. On a joined face it ends at the previous one, which cuts off an outside corner. Every edge is
// entered on one of its two faces and left on the other, so the segments form closed loops.
std::array<std::uint8_t, 12> segments(std::uint8_t inside, std::uint8_t joined) {
  std::array<std::uint8_t, 12> next;
  next.fill(kNone);
  for (std::size_t face = 0; face < kFaces.size(); ++face) {
    const auto& corners = kFaces[face];
    const auto crosses = [&](std::size_t i, bool from_inside) {
      return is_inside(inside, corners[i % 4]) == from_inside && is_inside(inside, corners[(i + 1) % 4]) != from_inside;
    };
    const bool join = (joined >> face & 1) != 0;
    for (std::size_t i = 0; i < 4; ++i) {
      if (!crosses(i, false)) continue;
      for (std::size_t step = 1; step < 4; ++step) {
        const std::size_t other = join ? i + 4 - step : i + step;
        if (!crosses(other, true)) continue;
        next[edge_between(corners[i], corners[(i + 1) % 4])] =
            edge_between(corners[other % 4], corners[(other + 1) % 4]);
        break;
      }
    }
  }
  return next;
}

// Triangulation of a loop with the minimum number of diagonals on faces of the cell. Such a diagonal might also be an
// edge in the adjacent cell; four triangles would then share the edge.
class Triangulation {
 public:
  Triangulation(const std::vector<std::uint8_t>& loop, std::vector<EdgeTriangle>& to) : loop_(loop), to_(to) {
    const std::size_t n = loop.size();
    cost_.assign(n * n, 0);
    middle_.assign(n * n, 0);
    for (std::size_t length = 2; length < n; ++length)
      for (std::size_t i = 0; i + length < n; ++i) solve(i, i + length);
    emit(0, n - 1);
  }

 private:
  void solve(std::size_t i, std::size_t j) {
    const std::size_t n = loop_.size();
    int best = std::numeric_limits<int>::max();
    for (std::size_t m = i + 1; m < j; ++m) {
      const int cost = cost_[i * n + m] + cost_[m * n + j];
      if (cost >= best) continue;
      best = cost;
      middle_[i * n + j] = m;
    }
    const bool diagonal = j - i < n - 1;
    cost_[i * n + j] = best + (diagonal && share_face(loop_[i], loop_[j]) ? 1 : 0);
  }
  void emit(std::size_t i, std::size_t j) {
    if (j < i + 2) return;
    const std::size_t m = middle_[i * loop_.size() + j];
    to_.push_back({loop_[i], loop_[m], loop_[j]});
    emit(i, m);
    emit(m, j);
  }

  const std::vector<std::uint8_t>& loop_;
  std::vector<EdgeTriangle>& to_;
  std::vector<int> cost_;
  std::vector<std::size_t> middle_;
};

void append_triangles(std::uint8_t inside, std::uint8_t joined, std::vector<EdgeTriangle>& to) {
  std::array<std::uint8_t, 12> next = segments(inside, joined);
  for (std::uint8_t start = 0; start < next.size(); ++start) {
    std::vector<std::uint8_t> loop;
    for (std::uint8_t e = start; next[e] != kNone;) {
      loop.push_back(e);
      const std::uint8_t following = next[e];
      next[e] = kNone;
      e = following;
    }
    if (loop.size() >= 3) Triangulation(loop, to);
  }
}

}  // namespace

Cases::Cases() : ranges_(256 * kFaceSets) {
  for (std::size_t inside = 0; inside < 256; ++inside) {
    for (std::size_t face = 0; face < kFaces.size(); ++face) {
      const auto& c = kFaces[face];
      const auto set = static_cast<std::uint8_t>(inside);
      if (is_inside(set, c[0]) == is_inside(set, c[2]) && is_inside(set, c[1]) == is_inside(set, c[3]) &&
          is_inside(set, c[0]) != is_inside(set, c[1]))
        ambiguous_[inside] = static_cast<std::uint8_t>(ambiguous_[inside] | 1u << face);
    }
    for (std::size_t joined = 0; joined < kFaceSets; ++joined) {
      if ((joined & ~std::size_t{ambiguous_[inside]}) != 0) continue;
      const auto first = static_cast<std::uint32_t>(triangles_.size());
      append_triangles(static_cast<std::uint8_t>(inside), static_cast<std::uint8_t>(joined), triangles_);
      ranges_[inside * kFaceSets + joined] = {first, static_cast<std::uint32_t>(triangles_.size()) - first};
    }
  }
}

const Cases& Cases::get() {
  static const Cases cases;
  return cases;
}

std::span<const EdgeTriangle> Cases::triangles(std::uint8_t inside, std::uint8_t joined) const {
  const Range range = ranges_[inside * kFaceSets + joined % kFaceSets];
  return std::span(triangles_).subspan(range.first, range.count);
}

}  // namespace gs::qnv::marching_cubes
