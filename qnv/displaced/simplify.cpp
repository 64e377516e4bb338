#include "qnv/displaced/simplify.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <queue>
#include <utility>

namespace gs::qnv::displaced {
namespace {

// Rims are worth keeping: planes through them, upright on the surface, weigh as much.
constexpr double kRimWeight = 4;
// Of the product of an edge's squared length and the area round it, as a cost beside the quadric's.
constexpr double kLengthWeight = 1e-4;
// A triangle may not turn further than this (a cosine) by one collapse, nor become narrower (1: equilateral).
struct Care {
  double least_turn, least_quality;
};
// Where no edge may go any more, more is allowed.
constexpr std::array<Care, 2> kCare{{{0.2, 0.08}, {0.05, 0.03}}};
// Holes and tunnels that are smaller round than this, in edges of the mesh that is wanted, cannot be seen in it.
constexpr double kHoleEdges = 1.5, kTunnelEdges = 0.75;
constexpr double kNoise = 0.03;              // of the area of a triangle of that mesh
constexpr std::size_t kMostSearched = 3000;  // triangles between both sides of a tunnel
constexpr int kRepairs = 3;                  // each with twice the measure

/// The sum of squared distances to planes, weighted: x^T A x + 2 b x + c.
struct Quadric {
  double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0, x = 0, y = 0, z = 0, c = 0;

  void add_plane(const glm::dvec3& n, double d, double weight) {
    xx += weight * n.x * n.x;
    xy += weight * n.x * n.y;
    xz += weight * n.x * n.z;
    yy += weight * n.y * n.y;
    yz += weight * n.y * n.z;
    zz += weight * n.z * n.z;
    x += weight * n.x * d;
    y += weight * n.y * d;
    z += weight * n.z * d;
    c += weight * d * d;
  }
  void add(const Quadric& q) {
    xx += q.xx, xy += q.xy, xz += q.xz, yy += q.yy, yz += q.yz, zz += q.zz, x += q.x, y += q.y, z += q.z, c += q.c;
  }
  [[nodiscard]] double at(const glm::dvec3& p) const {
    return p.x * (xx * p.x + 2 * (xy * p.y + xz * p.z + x)) + p.y * (yy * p.y + 2 * (yz * p.z + y)) +
           p.z * (zz * p.z + 2 * z) + c;
  }
  /// Where it is least, near `middle`; that itself where no place is much better than others.
  [[nodiscard]] glm::dvec3 least(const glm::dvec3& middle) const {
    // A little weight on the middle makes the matrix invertible.
    const double little = 1e-3 * (xx + yy + zz) + 1e-30;
    const double a = xx + little, d = yy + little, f = zz + little;
    const glm::dvec3 right(little * middle.x - x, little * middle.y - y, little * middle.z - z);
    const double c00 = d * f - yz * yz, c01 = xz * yz - xy * f, c02 = xy * yz - xz * d;
    const double determinant = a * c00 + xy * c01 + xz * c02;
    if (!(std::abs(determinant) > 0)) return middle;
    const double c11 = a * f - xz * xz, c12 = xz * xy - a * yz, c22 = a * d - xy * xy;
    return glm::dvec3(c00 * right.x + c01 * right.y + c02 * right.z, c01 * right.x + c11 * right.y + c12 * right.z,
                      c02 * right.x + c12 * right.y + c22 * right.z) /
           determinant;
  }
};

struct Candidate {
  double cost;
  std::uint32_t u, v, stamp;  // the sum of both stamps when it was made
  bool operator>(const Candidate& other) const {
    return cost != other.cost ? cost > other.cost : u != other.u ? u > other.u : v > other.v;
  }
};

class Simplifier {
 public:
  explicit Simplifier(const SurfaceMesh& mesh);
  void run(std::size_t wanted);
  [[nodiscard]] SurfaceMesh result(const SurfaceMesh& mesh) const;

 private:
  [[nodiscard]] std::uint32_t& vertex_at(std::uint32_t corner) { return triangles_[corner / 3][corner % 3]; }
  [[nodiscard]] bool alive(std::uint32_t triangle) const { return triangles_[triangle][0] != kNone; }
  void gather(std::uint32_t v, std::vector<std::uint32_t>& corners);
  [[nodiscard]] glm::dvec3 place_for(std::uint32_t u, std::uint32_t v, const Quadric& q) const;
  void push(std::uint32_t u, std::uint32_t v);
  void push_round(std::uint32_t v);
  [[nodiscard]] bool may_turn(std::span<const std::uint32_t> corners, std::uint32_t other,
                              const glm::dvec3& place) const;
  [[nodiscard]] bool linked_well(std::uint32_t u, std::uint32_t v);
  bool collapse(std::uint32_t u, std::uint32_t v);
  void push_all();
  std::uint32_t add_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c);
  void append_corner(std::uint32_t v, std::uint32_t corner);
  [[nodiscard]] double round(std::uint32_t a, std::uint32_t b, std::uint32_t c) const;
  [[nodiscard]] std::uint32_t triangle_left_of(std::uint32_t a, std::uint32_t b);
  [[nodiscard]] std::uint32_t third(std::uint32_t triangle, std::uint32_t a, std::uint32_t b) const;
  void repair(double edge);
  void close_rims(double most);
  void cut_tunnels(double most);
  bool cut_along(const Corners& cycle);
  [[nodiscard]] bool joined_elsewhere(const Corners& cycle);
  void collapse_to(std::size_t wanted);

  std::vector<glm::dvec3> positions_;
  std::vector<Corners> triangles_;
  std::vector<Quadric> quadrics_;
  std::vector<double> areas_;                      // round a vertex
  std::vector<std::uint32_t> head_, tail_, next_;  // the corners of a vertex, as a list
  std::vector<std::uint32_t> stamp_, mark_, seen_triangles_;
  std::uint32_t searches_ = 0;
  std::vector<bool> rim_;
  Care care_ = kCare[0];
  double noise_ = 0;  // twice the area of triangles that are far smaller than those wanted
  std::uint32_t marks_ = 0;
  std::size_t count_ = 0;
  std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>> queue_;
  std::vector<std::uint32_t> at_u_, at_v_, round_, seen_u_, seen_v_;
};

Simplifier::Simplifier(const SurfaceMesh& mesh)
    : triangles_(mesh.triangles),
      quadrics_(mesh.positions.size()),
      areas_(mesh.positions.size(), 0.0),
      head_(mesh.positions.size(), kNone),
      tail_(mesh.positions.size(), kNone),
      next_(mesh.triangles.size() * 3, kNone),
      stamp_(mesh.positions.size(), 0),
      mark_(mesh.positions.size(), 0),
      rim_(mesh.positions.size(), false),
      count_(mesh.triangles.size()) {
  // In units of the box, so that costs are of one size.
  Box box;
  for (const glm::vec3& p : mesh.positions) box.add(p);
  const glm::dvec3 size(glm::dvec3(box.upper) - glm::dvec3(box.lower));
  const double scale = 1 / std::max({size.x, size.y, size.z, 1e-300});
  positions_.reserve(mesh.positions.size());
  for (const glm::vec3& p : mesh.positions) positions_.push_back((glm::dvec3(p) - glm::dvec3(box.lower)) * scale);
  const auto beside = neighbours_of(mesh.triangles);
  for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
    const glm::dvec3 a = positions_[triangles_[t][0]], b = positions_[triangles_[t][1]],
                     c = positions_[triangles_[t][2]];
    const glm::dvec3 cross = glm::cross(b - a, c - a);
    const double twice = glm::length(cross);
    const glm::dvec3 n = twice > 0 ? cross / twice : glm::dvec3(0);
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t v = triangles_[t][k], corner = 3 * t + k;
      quadrics_[v].add_plane(n, -glm::dot(n, a), twice / 6);
      areas_[v] += twice / 6;
      (head_[v] == kNone ? head_[v] : next_[tail_[v]]) = corner;
      tail_[v] = corner;
      if (beside[t][k] != kNone) continue;
      const std::uint32_t w = triangles_[t][(k + 1) % 3];
      rim_[v] = rim_[w] = true;
      const glm::dvec3 along = positions_[w] - positions_[v];
      const double squared = glm::dot(along, along);
      glm::dvec3 upright = glm::cross(along, n);
      const double length = glm::length(upright);
      if (!(length > 0)) continue;
      upright /= length;
      for (const std::uint32_t end : {v, w})
        quadrics_[end].add_plane(upright, -glm::dot(upright, positions_[v]), kRimWeight * squared);
    }
  }
  push_all();
}

void Simplifier::gather(std::uint32_t v, std::vector<std::uint32_t>& corners) {
  // Corners of triangles that are gone leave the list on the way.
  corners.clear();
  std::uint32_t last = kNone;
  for (std::uint32_t corner = head_[v]; corner != kNone; corner = next_[corner]) {
    if (!alive(corner / 3)) continue;
    (last == kNone ? head_[v] : next_[last]) = corner;
    last = corner;
    corners.push_back(corner);
  }
  (last == kNone ? head_[v] : next_[last]) = kNone;
  tail_[v] = last;
}

glm::dvec3 Simplifier::place_for(std::uint32_t u, std::uint32_t v, const Quadric& q) const {
  const glm::dvec3 a = positions_[u], b = positions_[v];
  // The end of a rim stays on it.
  if (rim_[u] != rim_[v]) return rim_[u] ? a : b;
  const glm::dvec3 middle = 0.5 * (a + b);
  const glm::dvec3 best = q.least(middle);
  const double length = glm::length(b - a);
  if (glm::length(best - middle) <= 1.5 * length) return best;
  const double at_a = q.at(a), at_b = q.at(b), at_middle = q.at(middle);
  if (at_middle <= at_a && at_middle <= at_b) return middle;
  return at_a <= at_b ? a : b;
}

void Simplifier::push(std::uint32_t u, std::uint32_t v) {
  Quadric q = quadrics_[u];
  q.add(quadrics_[v]);
  const glm::dvec3 along = positions_[v] - positions_[u];
  const double cost =
      std::max(q.at(place_for(u, v, q)), 0.0) + kLengthWeight * glm::dot(along, along) * (areas_[u] + areas_[v]);
  queue_.push({cost, u, v, stamp_[u] + stamp_[v]});
}

void Simplifier::push_round(std::uint32_t v) {
  gather(v, round_);
  ++marks_;
  for (const std::uint32_t corner : round_)
    for (const std::uint32_t w : triangles_[corner / 3]) {
      if (w == v || mark_[w] == marks_) continue;
      mark_[w] = marks_;
      push(std::min(v, w), std::max(v, w));
    }
}

bool Simplifier::may_turn(std::span<const std::uint32_t> corners, std::uint32_t other, const glm::dvec3& place) const {
  for (const std::uint32_t corner : corners) {
    const Corners& t = triangles_[corner / 3];
    if (t[0] == other || t[1] == other || t[2] == other) continue;
    const glm::dvec3 b = positions_[t[(corner % 3 + 1) % 3]];
    const glm::dvec3 c = positions_[t[(corner % 3 + 2) % 3]];
    const glm::dvec3 a = positions_[t[corner % 3]];
    const glm::dvec3 before = glm::cross(b - a, c - a), after = glm::cross(b - place, c - place);
    const double size = glm::length(after), size_before = glm::length(before);
    // How noise turns does not matter.
    if (size < noise_ && size_before < noise_) continue;
    if (glm::dot(before, after) < care_.least_turn * size * size_before) return false;
    const auto quality = [&](const glm::dvec3& p, double twice_area) {
      const double edges = glm::dot(b - p, b - p) + glm::dot(c - p, c - p) + glm::dot(c - b, c - b);
      return 3.4641 * twice_area / std::max(edges, 1e-300);
    };
    const double now = quality(place, size);
    if (now < care_.least_quality && now < quality(a, size_before)) return false;
  }
  return true;
}

bool Simplifier::linked_well(std::uint32_t u, std::uint32_t v) {
  // The vertices beside both are those across the edge, and no others (the link condition).
  const auto others = [&](std::span<const std::uint32_t> corners, std::uint32_t self,
                          std::vector<std::uint32_t>& seen) {
    seen.clear();
    ++marks_;
    for (const std::uint32_t corner : corners)
      for (const std::uint32_t w : triangles_[corner / 3])
        if (w != self && mark_[w] != marks_) {
          mark_[w] = marks_;
          seen.push_back(w);
        }
  };
  others(at_u_, u, seen_u_);
  others(at_v_, v, seen_v_);  // these are marked now
  std::size_t common = 0, shared = 0;
  for (const std::uint32_t w : seen_u_) common += mark_[w] == marks_ && w != v ? 1 : 0;
  for (const std::uint32_t corner : at_u_) {
    const Corners& t = triangles_[corner / 3];
    shared += t[0] == v || t[1] == v || t[2] == v ? 1 : 0;
  }
  if (shared == 0 || common != shared) return false;
  if (rim_[u] && rim_[v] && shared == 2) return false;
  // The last triangle of a component, the last tetrahedron.
  if (shared == 1 && at_u_.size() == 1 && at_v_.size() == 1) return false;
  if (shared == 2 && seen_u_.size() <= 3 && seen_v_.size() <= 3) return false;
  for (const std::uint32_t corner : at_u_) {
    const Corners& t = triangles_[corner / 3];
    for (std::uint32_t k = 0; k < 3; ++k) {
      if (t[k] == u || t[k] == v || (t[0] != v && t[1] != v && t[2] != v)) continue;
      std::size_t around = 0;
      for (std::uint32_t c = head_[t[k]]; c != kNone; c = next_[c]) around += alive(c / 3) ? 1 : 0;
      if (around <= (rim_[t[k]] ? 1u : 3u)) return false;
    }
  }
  return true;
}

bool Simplifier::collapse(std::uint32_t u, std::uint32_t v) {
  gather(u, at_u_);
  gather(v, at_v_);
  if (!linked_well(u, v)) return false;
  Quadric q = quadrics_[u];
  q.add(quadrics_[v]);
  const glm::dvec3 place = place_for(u, v, q);
  if (!may_turn(at_u_, v, place) || !may_turn(at_v_, u, place)) return false;
  positions_[v] = place;
  quadrics_[v] = q;
  areas_[v] += areas_[u];
  rim_[v] = rim_[v] || rim_[u];
  for (const std::uint32_t corner : at_u_) {
    Corners& t = triangles_[corner / 3];
    if (t[0] == v || t[1] == v || t[2] == v) {
      t[0] = kNone;
      --count_;
    } else {
      vertex_at(corner) = v;
    }
  }
  if (head_[u] != kNone) {
    (head_[v] == kNone ? head_[v] : next_[tail_[v]]) = head_[u];
    tail_[v] = tail_[u];
    head_[u] = tail_[u] = kNone;
  }
  stamp_[u] += 1u << 30;  // never again
  ++stamp_[v];
  push_round(v);
  return true;
}

void Simplifier::run(std::size_t wanted) {
  double area = 0;
  for (const double a : areas_) area += a;
  noise_ = kNoise * 2 * area / static_cast<double>(std::max<std::size_t>(wanted, 1));
  // Scanned noise has holes and tunnels that no collapse may close, and that would take all triangles in the end.
  double edge = std::sqrt(2.31 * area / static_cast<double>(std::max<std::size_t>(wanted, 1)));
  for (const std::size_t more : {16, 8, 4, 2}) {
    collapse_to(more * wanted);
    repair(edge);
  }
  collapse_to(wanted);
  for (int times = 0; times < kRepairs && count_ > wanted; ++times) {
    care_ = kCare[1];
    edge *= 2;
    repair(edge);
    collapse_to(wanted);
  }
}

void Simplifier::repair(double edge) {
  close_rims(kHoleEdges * edge);
  cut_tunnels(kTunnelEdges * edge);
  push_all();
}

std::uint32_t Simplifier::add_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  const auto t = static_cast<std::uint32_t>(triangles_.size());
  triangles_.push_back({a, b, c});
  next_.resize(next_.size() + 3, kNone);
  for (std::uint32_t k = 0; k < 3; ++k) append_corner(triangles_[t][k], 3 * t + k);
  ++count_;
  return t;
}

void Simplifier::append_corner(std::uint32_t v, std::uint32_t corner) {
  (head_[v] == kNone ? head_[v] : next_[tail_[v]]) = corner;
  tail_[v] = corner;
  next_[corner] = kNone;
}

double Simplifier::round(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
  return glm::length(positions_[a] - positions_[b]) + glm::length(positions_[b] - positions_[c]) +
         glm::length(positions_[c] - positions_[a]);
}

std::uint32_t Simplifier::triangle_left_of(std::uint32_t a, std::uint32_t b) {
  for (std::uint32_t corner = head_[a]; corner != kNone; corner = next_[corner])
    if (alive(corner / 3) && triangles_[corner / 3][(corner % 3 + 1) % 3] == b) return corner / 3;
  return kNone;
}

// Holes of three edges get a triangle; what lies round a single triangle is none.
void Simplifier::close_rims(double most) {
  for (std::uint32_t u = 0; u < head_.size(); ++u) {
    if (!rim_[u] || head_[u] == kNone) continue;
    // A rim is walked against its triangles: from u over the side that has nothing on its left.
    gather(u, at_u_);
    for (const std::uint32_t corner : std::vector<std::uint32_t>(at_u_)) {
      const std::uint32_t v = triangles_[corner / 3][(corner % 3 + 2) % 3];  // the side from v to u
      if (triangle_left_of(u, v) != kNone) continue;
      for (std::uint32_t c = head_[v]; c != kNone; c = next_[c]) {
        if (!alive(c / 3)) continue;
        const std::uint32_t w = triangles_[c / 3][(c % 3 + 2) % 3];  // the side from w to v
        if (w == u || triangle_left_of(v, w) != kNone || triangle_left_of(u, w) == kNone ||
            triangle_left_of(w, u) != kNone || round(u, v, w) > most || third(corner / 3, u, v) == w)
          continue;
        add_triangle(u, v, w);
        break;
      }
    }
  }
  for (std::uint32_t v = 0; v < head_.size(); ++v) {
    if (!rim_[v] || head_[v] == kNone) continue;
    gather(v, at_v_);
    rim_[v] = std::any_of(at_v_.begin(), at_v_.end(), [&](std::uint32_t corner) {
      return triangle_left_of(v, triangles_[corner / 3][(corner % 3 + 2) % 3]) == kNone ||
             triangle_left_of(triangles_[corner / 3][(corner % 3 + 1) % 3], v) == kNone;
    });
  }
}

// Three edges round that bound no triangle: the surface is cut along them, and either side closed.
void Simplifier::cut_tunnels(double most) {
  const auto vertices = static_cast<std::uint32_t>(head_.size());
  for (std::uint32_t u = 0; u < vertices; ++u) {
    if (rim_[u] || head_[u] == kNone) continue;
    gather(u, at_u_);
    std::vector<std::uint32_t> beside;
    for (const std::uint32_t corner : at_u_) beside.push_back(triangles_[corner / 3][(corner % 3 + 1) % 3]);
    bool cut = false;
    for (std::size_t i = 0; i < beside.size() && !cut; ++i)
      for (std::size_t j = 0; j < beside.size() && !cut; ++j) {
        const std::uint32_t v = beside[i], w = beside[j];
        if (i == j || u > v || u > w || rim_[v] || rim_[w] || round(u, v, w) > most) continue;
        const std::uint32_t left = triangle_left_of(v, w), right = triangle_left_of(w, v);
        if (left == kNone || right == kNone || third(left, v, w) == u || third(right, v, w) == u) continue;
        cut = joined_elsewhere({u, v, w}) && cut_along({u, v, w});
      }
  }
}

std::uint32_t Simplifier::third(std::uint32_t triangle, std::uint32_t a, std::uint32_t b) const {
  for (const std::uint32_t v : triangles_[triangle])
    if (v != a && v != b) return v;
  return kNone;
}

bool Simplifier::joined_elsewhere(const Corners& cycle) {
  // Over edges other than the cycle's from its left to its right: else it would cut a part off.
  const std::uint32_t from = triangle_left_of(cycle[0], cycle[1]), to = triangle_left_of(cycle[1], cycle[0]);
  if (from == kNone || to == kNone) return false;
  const auto on_cycle = [&](std::uint32_t v) { return v == cycle[0] || v == cycle[1] || v == cycle[2]; };
  seen_triangles_.resize(triangles_.size(), 0);
  ++searches_;
  std::vector<std::uint32_t> open{from};
  seen_triangles_[from] = searches_;
  for (std::size_t i = 0; i < std::min(open.size(), kMostSearched); ++i) {
    if (open[i] == to) return true;
    const Corners& t = triangles_[open[i]];
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k], b = t[(k + 1) % 3];
      if (on_cycle(a) && on_cycle(b)) continue;
      const std::uint32_t beside = triangle_left_of(b, a);
      if (beside == kNone || seen_triangles_[beside] == searches_) continue;
      seen_triangles_[beside] = searches_;
      open.push_back(beside);
    }
  }
  return false;
}

bool Simplifier::cut_along(const Corners& cycle) {
  // Of each vertex the triangles on the left of the way round.
  std::array<std::vector<std::uint32_t>, 3> left;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t v = cycle[k], before = cycle[(k + 2) % 3];
    for (std::uint32_t to = cycle[(k + 1) % 3]; to != before;) {
      const std::uint32_t t = triangle_left_of(v, to);
      if (t == kNone || left[k].size() > 1000) return false;
      for (std::uint32_t c = 0; c < 3; ++c)
        if (triangles_[t][c] == v) left[k].push_back(3 * t + c);
      to = third(t, v, to);
    }
  }
  Corners copies{};
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t v = cycle[k], copy = copies[k] = static_cast<std::uint32_t>(head_.size());
    positions_.push_back(glm::dvec3(positions_[v]));
    quadrics_.push_back(Quadric(quadrics_[v]));
    areas_.push_back(double{areas_[v]});
    head_.push_back(kNone);
    tail_.push_back(kNone);
    stamp_.push_back(0);
    mark_.push_back(0);
    rim_.push_back(false);
    ++stamp_[v];
    std::vector<std::uint32_t> all;
    gather(v, all);
    head_[v] = tail_[v] = kNone;
    for (const std::uint32_t corner : all) {
      const bool moves = std::find(left[k].begin(), left[k].end(), corner) != left[k].end();
      if (moves) vertex_at(corner) = copy;
      append_corner(moves ? copy : v, corner);
    }
  }
  add_triangle(copies[0], copies[2], copies[1]);
  add_triangle(cycle[0], cycle[1], cycle[2]);
  return true;
}

void Simplifier::push_all() {
  for (const Corners& t : triangles_)
    for (std::size_t k = 0; k < 3 && t[0] != kNone; ++k) {
      const std::uint32_t u = t[k], v = t[(k + 1) % 3];
      if (u < v || (rim_[u] && rim_[v])) push(std::min(u, v), std::max(u, v));
    }
}

void Simplifier::collapse_to(std::size_t wanted) {
  while (count_ > wanted && !queue_.empty()) {
    const Candidate next = queue_.top();
    queue_.pop();
    if (head_[next.u] == kNone || head_[next.v] == kNone || next.stamp != stamp_[next.u] + stamp_[next.v]) continue;
    collapse(next.u, next.v);
  }
}

SurfaceMesh Simplifier::result(const SurfaceMesh& mesh) const {
  Box box;
  for (const glm::vec3& p : mesh.positions) box.add(p);
  const glm::dvec3 size(glm::dvec3(box.upper) - glm::dvec3(box.lower));
  const double scale = std::max({size.x, size.y, size.z, 1e-300});
  SurfaceMesh out;
  std::vector<std::uint32_t> places(positions_.size(), kNone);
  for (const Corners& t : triangles_) {
    if (t[0] == kNone) continue;
    Corners corners;
    for (std::size_t k = 0; k < 3; ++k) {
      std::uint32_t& place = places[t[k]];
      if (place == kNone) {
        place = static_cast<std::uint32_t>(out.positions.size());
        out.positions.push_back(glm::vec3(positions_[t[k]] * scale + glm::dvec3(box.lower)));
      }
      corners[k] = place;
    }
    out.triangles.push_back(corners);
  }
  return out;
}

}  // namespace

SurfaceMesh simplify(const SurfaceMesh& mesh, std::size_t triangles) {
  Simplifier simplifier(mesh);
  simplifier.run(triangles);
  return simplifier.result(mesh);
}

}  // namespace gs::qnv::displaced
