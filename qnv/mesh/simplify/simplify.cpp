#include "qnv/mesh/simplify/simplify.h"

#include "qnv/mesh/simplify/simplifier.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace gs::qnv::displaced {
namespace {

// Weight of additional planes that preserve the rims. They contain a rim and are perpendicular to the surface.
constexpr double kRimWeight = 4;
// Weights of an additional cost: the squared length of an edge times the area around it.
constexpr double kLengthWeight = 1e-4, kLengthWeightOfHalves = 1e-8;
constexpr Care kCareOfHalves{0.2, 0};
constexpr double kNoise = 0.03;  // noise area, relative to a triangle of the result
constexpr int kRepairs = 3;  // maximum number of repairs; each doubles the size limit

}  // namespace

Simplifier::Simplifier(const SurfaceMesh& mesh, std::vector<bool> kept, Way way)
    : mesh_(mesh),
      quadrics_(mesh.positions.size()),
      areas_(mesh.positions.size(), 0.0),
      stamp_(mesh.positions.size(), 0),
      mark_(mesh.positions.size(), 0),
      rim_(mesh.positions.size(), false),
      kept_(std::move(kept)),
      way_(way),
      care_(way == Way::any ? kCare[0] : kCareOfHalves) {
  // Scales to the box, so that costs do not depend on the unit.
  Box box;
  for (const glm::vec3& p : mesh.positions) box.add(p);
  const glm::dvec3 size(glm::dvec3(box.upper) - glm::dvec3(box.lower));
  const double scale = 1 / std::max({size.x, size.y, size.z, 1e-300});
  positions_.reserve(mesh.positions.size());
  for (const glm::vec3& p : mesh.positions) positions_.push_back((glm::dvec3(p) - glm::dvec3(box.lower)) * scale);
  const auto beside = neighbours_of(mesh.triangles);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const Corners& corners = mesh.triangles[t];
    const glm::dvec3 a = positions_[corners[0]], b = positions_[corners[1]], c = positions_[corners[2]];
    const glm::dvec3 cross = glm::cross(b - a, c - a);
    const double twice = glm::length(cross);
    const glm::dvec3 n = twice > 0 ? cross / twice : glm::dvec3(0);
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t v = corners[k];
      quadrics_[v].add_plane(n, -glm::dot(n, a), twice / 6);
      areas_[v] += twice / 6;
      if (beside[t][k] != kNone) continue;
      const std::uint32_t w = corners[(k + 1) % 3];
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

glm::dvec3 Simplifier::place_for(std::uint32_t u, std::uint32_t v, const Quadric& q) const {
  const glm::dvec3 a = positions_[u], b = positions_[v];
  // A rim vertex keeps its position.
  if (rim_[u] != rim_[v]) return rim_[u] ? a : b;
  if (way_ == Way::halves) return q.at(a) <= q.at(b) ? a : b;
  const glm::dvec3 middle = 0.5 * (a + b);
  const glm::dvec3 best = q.least(middle);
  const double length = glm::length(b - a);
  if (glm::length(best - middle) <= 1.5 * length) return best;
  const double at_a = q.at(a), at_b = q.at(b), at_middle = q.at(middle);
  if (at_middle <= at_a && at_middle <= at_b) return middle;
  return at_a <= at_b ? a : b;
}

double Simplifier::cost(std::uint32_t u, std::uint32_t v, const Quadric& q) const {
  const glm::dvec3 along = positions_[v] - positions_[u];
  const double weight = way_ == Way::any ? kLengthWeight : kLengthWeightOfHalves;
  return std::max(q.at(place_for(u, v, q)), 0.0) + weight * glm::dot(along, along) * (areas_[u] + areas_[v]);
}

void Simplifier::push(std::uint32_t u, std::uint32_t v) {
  Quadric q = quadrics_[u];
  q.add(quadrics_[v]);
  queue_.push(cost(u, v, q), {u, v, stamp_[u] + stamp_[v]});
}

void Simplifier::push_round(std::uint32_t v) {
  mesh_.gather(v, round_);
  ++marks_;
  for (const std::uint32_t corner : round_)
    for (const std::uint32_t w : mesh_.of(corner)) {
      if (w == v || mark_[w] == marks_) continue;
      mark_[w] = marks_;
      push(std::min(v, w), std::max(v, w));
    }
}

bool Simplifier::may_turn(std::span<const std::uint32_t> corners, std::uint32_t other, const glm::dvec3& place) const {
  for (const std::uint32_t corner : corners) {
    const Corners& t = mesh_.of(corner);
    if (t[0] == other || t[1] == other || t[2] == other) continue;
    const glm::dvec3 b = positions_[t[(corner % 3 + 1) % 3]];
    const glm::dvec3 c = positions_[t[(corner % 3 + 2) % 3]];
    const glm::dvec3 a = positions_[t[corner % 3]];
    const glm::dvec3 before = glm::cross(b - a, c - a), after = glm::cross(b - place, c - place);
    const double size = glm::length(after), size_before = glm::length(before);
    // The orientation of noise triangles may change.
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
  // Tests the link condition: the vertices adjacent to both ends must be exactly those opposite the edge.
  const auto others = [&](std::span<const std::uint32_t> corners, std::uint32_t self,
                          std::vector<std::uint32_t>& seen) {
    seen.clear();
    ++marks_;
    for (const std::uint32_t corner : corners)
      for (const std::uint32_t w : mesh_.of(corner))
        if (w != self && mark_[w] != marks_) {
          mark_[w] = marks_;
          seen.push_back(w);
        }
  };
  others(at_u_, u, seen_u_);
  others(at_v_, v, seen_v_);  // marks these vertices
  std::size_t common = 0, shared = 0;
  for (const std::uint32_t w : seen_u_) common += mark_[w] == marks_ && w != v ? 1 : 0;
  for (const std::uint32_t corner : at_u_) {
    const Corners& t = mesh_.of(corner);
    shared += t[0] == v || t[1] == v || t[2] == v ? 1 : 0;
  }
  if (shared == 0 || common != shared) return false;
  if (rim_[u] && rim_[v] && shared == 2) return false;
  // Keeps the last triangle or tetrahedron of a component.
  if (shared == 1 && at_u_.size() == 1 && at_v_.size() == 1) return false;
  if (shared == 2 && seen_u_.size() <= 3 && seen_v_.size() <= 3) return false;
  for (const std::uint32_t corner : at_u_) {
    const Corners& t = mesh_.of(corner);
    for (std::uint32_t k = 0; k < 3; ++k) {
      if (t[k] == u || t[k] == v || (t[0] != v && t[1] != v && t[2] != v)) continue;
      std::size_t around = 0;
      mesh_.any_corner(t[k], [&](std::uint32_t) {
        ++around;
        return false;
      });
      if (around <= (rim_[t[k]] ? 1u : 3u)) return false;
    }
  }
  return true;
}

bool Simplifier::may_merge(std::uint32_t u, std::uint32_t v, const glm::dvec3& place) {
  mesh_.gather(u, at_u_);
  mesh_.gather(v, at_v_);
  return linked_well(u, v) && may_turn(at_u_, v, place) && may_turn(at_v_, u, place);
}

bool Simplifier::collapse(std::uint32_t u, std::uint32_t v) {
  if (!kept_.empty() && (kept_[u] || kept_[v])) return false;
  Quadric q = quadrics_[u];
  q.add(quadrics_[v]);
  const glm::dvec3 place = place_for(u, v, q);
  if (!may_merge(u, v, place)) return false;
  merge(u, v, q, place);
  return true;
}

// Merges u into v. Call it after may_merge(), which collects the corners.
void Simplifier::merge(std::uint32_t u, std::uint32_t v, const Quadric& q, const glm::dvec3& place) {
  positions_[v] = place;
  quadrics_[v] = q;
  areas_[v] += areas_[u];
  rim_[v] = rim_[v] || rim_[u];
  mesh_.merge(u, v, at_u_);
  stamp_[u] += 1u << 30;  // excludes u from further collapses
  ++stamp_[v];
  push_round(v);
}

/// Returns the area of a triangle of the result with `wanted` triangles, and sets noise_.
double Simplifier::see_area(std::size_t wanted) {
  double area = 0;
  for (const double a : areas_) area += a;
  area /= static_cast<double>(std::max<std::size_t>(wanted, 1));
  noise_ = kNoise * 2 * area;
  return area;
}

void Simplifier::thin(std::size_t wanted, std::size_t left) {
  (void)see_area(wanted);
  collapse_to(left);
}

void Simplifier::run(std::size_t wanted, std::size_t begun) {
  const double area = see_area(wanted);
  // Scanned noise has small holes and tunnels. Collapses cannot close them, so they would use up all triangles.
  double edge = std::sqrt(2.31 * area);
  for (std::size_t more = begun; more > 1; more /= 2) {
    collapse_to(more * wanted);
    repair(edge);
  }
  collapse_to(wanted);
  for (int times = 0; times < kRepairs && triangles() > wanted; ++times) {
    care_ = kCare[1];
    edge *= 2;
    repair(edge);
    collapse_to(wanted);
  }
}

void Simplifier::push_all() {
  for (const Corners& t : mesh_.triangles())
    for (std::size_t k = 0; k < 3 && t[0] != kNone; ++k) {
      const std::uint32_t u = t[k], v = t[(k + 1) % 3];
      if (u < v || (rim_[u] && rim_[v])) push(std::min(u, v), std::max(u, v));
    }
}

void Simplifier::collapse_to(std::size_t wanted) {
  Candidate next{};
  while (triangles() > wanted && queue_.pop(next))
    if (!stale(next)) collapse(next.u, next.v);
}

bool Simplifier::stale(const Candidate& c) const {
  return !mesh_.used(c.u) || !mesh_.used(c.v) || c.stamp != stamp_[c.u] + stamp_[c.v];
}

SurfaceMesh Simplifier::result(const SurfaceMesh& mesh, std::vector<std::uint32_t>& places) const {
  Box box;
  for (const glm::vec3& p : mesh.positions) box.add(p);
  const glm::dvec3 size(glm::dvec3(box.upper) - glm::dvec3(box.lower));
  const double scale = std::max({size.x, size.y, size.z, 1e-300});
  SurfaceMesh out;
  places.assign(positions_.size(), kNone);
  for (const Corners& t : mesh_.triangles()) {
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

}  // namespace gs::qnv::displaced
