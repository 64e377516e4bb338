#include "vrml/mesh/polygon.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace gs::vrml {
namespace {

constexpr std::size_t kStepsPerCorner = 512;
constexpr std::size_t kStepsAtLeast = 16384;
constexpr std::size_t kMaxSteps = std::size_t{1} << 27;  // maximum steps per polygon, at most one second
constexpr int kMaxExceptions = 24;  // maximum ears cut with relaxed tests; only self-intersecting polygons need more
constexpr std::size_t kGridFrom = 48;  // minimum number of reflex corners for which a grid pays
constexpr std::size_t kMaximumColumns = 4096;

[[nodiscard]] std::size_t cell_of(double place, std::size_t size) {
  const auto last = static_cast<double>(size - 1);
  return place > 0 ? static_cast<std::size_t>(place < last ? place : last) : 0;
}

}  // namespace

glm::dvec3 newell_vector(std::span<const glm::vec3> polygon) {
  glm::dvec3 sum(0);
  if (polygon.size() < 3) return sum;
  const glm::dvec3 origin(polygon[0]);
  glm::dvec3 edge = glm::dvec3(polygon[1]) - origin;
  for (std::size_t i = 2; i < polygon.size(); ++i) {
    const glm::dvec3 next = glm::dvec3(polygon[i]) - origin;
    sum += glm::cross(edge, next);
    edge = next;
  }
  return sum;
}

std::span<const std::uint32_t> PolygonTriangulator::triangulate(std::span<const glm::vec3> polygon) {
  triangles_.clear();
  const std::size_t count = polygon.size();
  if (count < 3 || count >= kNone) return {};
  const glm::dvec3 normal = newell_vector(polygon);
  if (count == 3) {
    triangles_ = {0, 1, 2};
  } else if (count == 4) {
    quadrilateral(polygon, normal);
  } else {
    project(polygon, normal);
    link();
    clip();
  }
  return triangles_;
}

void PolygonTriangulator::quadrilateral(std::span<const glm::vec3> polygon, const glm::dvec3& normal) {
  const glm::dvec3 a(polygon[0]), b(polygon[1]), c(polygon[2]), d(polygon[3]);
  const bool first_diagonal =
      glm::dot(glm::cross(b - a, c - a), normal) > 0 && glm::dot(glm::cross(c - a, d - a), normal) > 0;
  if (first_diagonal)
    triangles_ = {0, 1, 2, 0, 2, 3};
  else
    triangles_ = {1, 2, 3, 1, 3, 0};
}

/// Projects the polygon by dropping the coordinate axis nearest to the normal. Unlike a rotation, this does not change
/// coordinates, so that collinear and coincident corners remain so. Mirrors the result if it would be clockwise.
void PolygonTriangulator::project(std::span<const glm::vec3> polygon, const glm::dvec3& normal) {
  const glm::dvec3 size(std::abs(normal.x), std::abs(normal.y), std::abs(normal.z));
  const int dropped = size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
  int u = (dropped + 1) % 3, v = (dropped + 2) % 3;
  if (normal[dropped] < 0) std::swap(u, v);
  points_.resize(polygon.size());
  for (std::size_t i = 0; i < polygon.size(); ++i) points_[i] = {polygon[i][u], polygon[i][v]};
}

/// Builds the ring of corners, and adds all corners to the queue.
void PolygonTriangulator::link() {
  const auto count = static_cast<std::uint32_t>(points_.size());
  previous_.resize(count);
  next_.resize(count);
  place_.assign(count, kNone);
  turn_.assign(count, 0);
  reflex_.clear();
  queue_.clear();
  queue_head_ = 0;
  columns_ = 0;
  first_ = 0;
  remaining_ = count;
  steps_left_ = std::min(count * kStepsPerCorner + kStepsAtLeast, kMaxSteps);
  changed_.clear();
  for (std::uint32_t i = 0; i < count; ++i) {
    previous_[i] = i == 0 ? count - 1 : i - 1;
    next_[i] = i + 1 == count ? 0 : i + 1;
    changed_.push_back(count - 1 - i);
  }
  settle();
  if (reflex_.size() >= kGridFrom) build_grid();
}

/// Reports whether a corner covers no area: it coincides with the next corner, or the polygon folds back on itself
/// there. Bridges to holes leave such corners after ears are cut.
bool PolygonTriangulator::is_spike(std::uint32_t corner) const {
  const glm::dvec2 back = points_[previous_[corner]] - points_[corner];
  const glm::dvec2 forth = points_[next_[corner]] - points_[corner];
  return forth == glm::dvec2(0) || (back.x * forth.y == back.y * forth.x && glm::dot(back, forth) > 0);
}

/// Updates all corners with new neighbours. Removes spikes, which may change further corners, and adds the others to
/// the queue.
void PolygonTriangulator::settle() {
  while (!changed_.empty()) {
    const std::uint32_t corner = changed_.back();
    changed_.pop_back();
    if (!in_ring(corner)) continue;
    if (remaining_ > 3 && is_spike(corner)) {
      unlink(corner);
      changed_.push_back(next_[corner]);
      changed_.push_back(previous_[corner]);
    } else {
      refresh(corner);
      enqueue(corner);
    }
  }
}

double PolygonTriangulator::area(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
  const glm::dvec2 ab = points_[b] - points_[a], ac = points_[c] - points_[a];
  return ab.x * ac.y - ab.y * ac.x;
}

/// Removes a corner from the ring. The corner's own links do not change.
void PolygonTriangulator::unlink(std::uint32_t corner) {
  next_[previous_[corner]] = next_[corner];
  previous_[next_[corner]] = previous_[corner];
  if (first_ == corner) first_ = next_[corner];
  --remaining_;
  if (place_[corner] == kNone) return;
  place_[reflex_.back()] = place_[corner];
  reflex_[place_[corner]] = reflex_.back();
  reflex_.pop_back();
  place_[corner] = kNone;
}

/// Updates the list of reflex corners after the neighbours of a corner have changed.
void PolygonTriangulator::refresh(std::uint32_t corner) {
  // A corner that is straight except for rounding errors would become a sliver, which leaves a visible seam.
  constexpr double kStraight = 1e-6;
  const glm::dvec2 across = points_[next_[corner]] - points_[previous_[corner]];
  const bool reflex = !(area(previous_[corner], corner, next_[corner]) > kStraight * glm::dot(across, across));
  if (reflex == (place_[corner] != kNone)) return;
  if (reflex) {
    place_[corner] = static_cast<std::uint32_t>(reflex_.size());
    reflex_.push_back(corner);
    if (columns_ != 0 && !in_grid_[corner]) enter_grid(corner);
  } else {
    place_[reflex_.back()] = place_[corner];
    reflex_[place_[corner]] = reflex_.back();
    reflex_.pop_back();
    place_[corner] = kNone;
  }
}

/// Returns the position of a corner in the grid, in units of cells.
glm::dvec2 PolygonTriangulator::to_grid(std::uint32_t corner) const {
  return (points_[corner] - grid_origin_) * grid_scale_;
}

void PolygonTriangulator::enter_grid(std::uint32_t corner) {
  const glm::dvec2 place = to_grid(corner);
  const std::size_t cell = cell_of(place.y, rows_) * columns_ + cell_of(place.x, columns_);
  cell_next_[corner] = cell_head_[cell];
  cell_head_[cell] = corner;
  in_grid_[corner] = true;
}

void PolygonTriangulator::build_grid() {
  glm::dvec2 lower = points_[first_], upper = lower;
  std::uint32_t corner = first_;
  do {
    lower = {std::min(lower.x, points_[corner].x), std::min(lower.y, points_[corner].y)};
    upper = {std::max(upper.x, points_[corner].x), std::max(upper.y, points_[corner].y)};
    corner = next_[corner];
  } while (corner != first_);
  // Chooses about as many cells as there are reflex corners. Cells are nearly square.
  const glm::dvec2 size = upper - lower;
  const auto cells = static_cast<double>(reflex_.size());
  const double columns = size.x > 0 ? (size.y > 0 ? std::sqrt(cells * (size.x / size.y)) : cells) : 1;
  columns_ = static_cast<std::size_t>(std::clamp(columns, 1.0, static_cast<double>(kMaximumColumns)));
  rows_ = std::clamp<std::size_t>(reflex_.size() / columns_, 1, kMaximumColumns);
  grid_filling_ = reflex_.size();
  grid_origin_ = lower;
  grid_scale_ = {size.x > 0 ? static_cast<double>(columns_) / size.x : 0,
                 size.y > 0 ? static_cast<double>(rows_) / size.y : 0};
  cell_head_.assign(columns_ * rows_, kNone);
  cell_next_.resize(points_.size());
  in_grid_.assign(points_.size(), false);
  for (const std::uint32_t reflex : reflex_) enter_grid(reflex);
}

/// Reports whether a reflex corner prevents cutting the ear at `tip`. A corner at the same position as a corner of the
/// ear, as at bridges to holes, does not prevent it: if its edges entered the ear, another reflex corner would be
/// inside.
bool PolygonTriangulator::blocks(std::uint32_t corner, std::uint32_t tip, Strictness strictness) const {
  const std::uint32_t a = previous_[tip], c = next_[tip];
  const glm::dvec2 p = points_[corner];
  if (p == points_[a] || p == points_[tip] || p == points_[c]) return false;
  const double in_a = area(a, tip, corner), in_b = area(tip, c, corner), in_c = area(c, a, corner);
  if (strictness == Strictness::clear) return in_a >= 0 && in_b >= 0 && in_c >= 0;
  return in_a > 0 && in_b > 0 && in_c > 0;
}

bool PolygonTriangulator::is_ear(std::uint32_t tip, Strictness strictness) {
  if (place_[tip] != kNone) return false;
  if (strictness == Strictness::any_convex) return true;
  if (columns_ != 0) return !grid_blocks(tip, strictness);
  for (const std::uint32_t corner : reflex_)
    if (spend(1), blocks(corner, tip, strictness)) return false;
  return true;
}

/// Tests the reflex corners in the cells that the ear touches, row by row.
bool PolygonTriangulator::grid_blocks(std::uint32_t tip, Strictness strictness) {
  constexpr double kSlack = 1e-6;  // in cells; margin for rounding errors where edges cross rows
  const glm::dvec2 corners[] = {to_grid(previous_[tip]), to_grid(tip), to_grid(next_[tip])};
  const std::size_t bottom = cell_of(std::min({corners[0].y, corners[1].y, corners[2].y}) - kSlack, rows_);
  const std::size_t top = cell_of(std::max({corners[0].y, corners[1].y, corners[2].y}) + kSlack, rows_);
  for (std::size_t y = bottom; y <= top; ++y) {
    const double low = static_cast<double>(y) - kSlack, high = static_cast<double>(y + 1) + kSlack;
    double left = HUGE_VAL, right = -HUGE_VAL;
    for (int i = 0; i < 3; ++i) {
      glm::dvec2 p = corners[i], q = corners[(i + 1) % 3];
      if (p.y > q.y) std::swap(p, q);
      if (p.y > high || q.y < low) continue;
      const double slope = q.y > p.y ? (q.x - p.x) / (q.y - p.y) : 0;
      const double x_low = p.y < low ? p.x + (low - p.y) * slope : p.x;
      const double x_high = q.y > high ? q.x - (q.y - high) * slope : q.x;
      left = std::min({left, x_low, x_high});
      right = std::max({right, x_low, x_high});
    }
    if (left > right) continue;
    const std::size_t last = cell_of(right + kSlack, columns_);
    for (std::size_t x = cell_of(left - kSlack, columns_); x <= last; ++x) {
      spend(1);
      for (std::uint32_t corner = cell_head_[y * columns_ + x]; corner != kNone; corner = cell_next_[corner])
        if (spend(1), place_[corner] != kNone && blocks(corner, tip, strictness)) return true;
    }
  }
  return false;
}

/// Ends the search for ears: makes a fan of the remaining corners, without triangles of area zero.
void PolygonTriangulator::fan() {
  for (std::uint32_t b = next_[first_]; next_[b] != first_; b = next_[b])
    if (area(first_, b, next_[b]) != 0) triangles_.insert(triangles_.end(), {first_, b, next_[b]});
}

void PolygonTriangulator::enqueue(std::uint32_t corner) { queue_.push_back({corner, ++turn_[corner]}); }

void PolygonTriangulator::enqueue_all() {
  queue_.clear();
  queue_head_ = 0;
  std::uint32_t corner = first_;
  do {
    enqueue(corner);
    corner = next_[corner];
  } while (corner != first_);
  spend(remaining_);
}

/// Cuts ears. A cut can turn only the two neighbours of the cut corner into ears. The neighbours go to the end of the
/// queue, so that the cuts proceed around the polygon instead of forming a fan of slivers.
void PolygonTriangulator::clip() {
  Strictness strictness = Strictness::clear;
  int exceptions = 0;
  while (remaining_ > 3 && steps_left_ > 0 && exceptions < kMaxExceptions) {
    if (queue_head_ == queue_.size()) {
      if (strictness == Strictness::any_convex) break;
      strictness = strictness == Strictness::clear ? Strictness::interior_clear : Strictness::any_convex;
      enqueue_all();
      continue;
    }
    const Candidate candidate = queue_[queue_head_++];
    const std::uint32_t tip = candidate.corner;
    spend(1);
    if (turn_[tip] != candidate.turn || !in_ring(tip) || !is_ear(tip, strictness)) continue;
    triangles_.insert(triangles_.end(), {previous_[tip], tip, next_[tip]});
    unlink(tip);
    if (strictness != Strictness::clear) {  // after a relaxed test, returns to strict tests
      strictness = Strictness::clear;
      queue_head_ = queue_.size();
      ++exceptions;
    }
    changed_ = {next_[tip], previous_[tip]};
    settle();
    if (columns_ != 0 && reflex_.size() * 4 < grid_filling_) {
      columns_ = 0;
      if (reflex_.size() >= kGridFrom) build_grid();
    }
  }
  if (remaining_ >= 3) fan();
}

}  // namespace gs::vrml
