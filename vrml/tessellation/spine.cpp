#include "vrml/tessellation/spine.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace gs::vrml {
namespace {

/// Maximum sine of the angle between two segments that count as collinear.
constexpr double kCollinear = 1e-5;
/// Relative rounding error of a float coordinate.
constexpr double kRounding = 1.2e-7;

constexpr glm::dvec3 kZero(0);

[[nodiscard]] double largest(const glm::dvec3& v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

[[nodiscard]] glm::dvec3 unit(const glm::dvec3& v) {
  const double length = glm::length(v);
  return length > 0 ? v / length : kZero;
}

/// Returns the Z axis at `here`: the cross product of the vectors to the next and the previous point. Returns zero if
/// the three points are collinear within the precision of their coordinates.
[[nodiscard]] glm::dvec3 z_axis(const glm::dvec3& previous, const glm::dvec3& here, const glm::dvec3& next) {
  const glm::dvec3 forth = next - here, back = previous - here;
  const double a = glm::length(forth), b = glm::length(back);
  const glm::dvec3 z = glm::cross(forth, back);
  const double rounding = kRounding * std::max({largest(previous), largest(here), largest(next)});
  return glm::length(z) > kCollinear * a * b + rounding * (a + b) ? unit(z) : kZero;
}

/// Rotates the standard axes by the shortest rotation from +Y to `y`. If that is half a turn, rotates about Z.
[[nodiscard]] CrossSectionPlane turned_to(const glm::dvec3& y) {
  if (y == kZero) return {};
  if (y.y < -1 + 1e-12) return {{-1, 0, 0}, {0, -1, 0}, {0, 0, 1}};
  // Rodrigues' formula with the axis Y x y = (y.z, 0, -y.x).
  const double k = 1 / (1 + y.y);
  return {{1 - y.x * y.x * k, -y.x, -y.x * y.z * k}, y, {-y.x * y.z * k, -y.z, 1 - y.z * y.z * k}};
}

/// Builds a plane from two axes, which may be inexact or zero.
[[nodiscard]] CrossSectionPlane plane_of(const glm::dvec3& y, const glm::dvec3& z) {
  const glm::dvec3 x = glm::cross(y, z);
  if (glm::length(x) < 1e-9) return turned_to(y);
  CrossSectionPlane plane;
  plane.y = y;
  plane.x = unit(x);
  plane.z = glm::cross(plane.x, plane.y);
  return plane;
}

/// Spine of at least two points. No two neighbouring points coincide.
class Spine {
 public:
  explicit Spine(const std::vector<glm::dvec3>& points)
      : points_(points), count_(points.size()), closed_(count_ > 2 && points.front() == points.back()) {}

  [[nodiscard]] std::vector<CrossSectionPlane> planes() const {
    std::vector<glm::dvec3> z(count_);
    for (std::size_t i = 1; i + 1 < count_; ++i) z[i] = z_axis(points_[i - 1], points_[i], points_[i + 1]);
    if (closed_) z[0] = z_axis(points_[count_ - 2], points_[0], points_[1]);
    const auto first = std::find_if(z.begin(), z.end(), [](const glm::dvec3& v) { return v != kZero; });
    if (first == z.end()) return std::vector<CrossSectionPlane>(count_, turned_to(direction()));

    // Replaces undefined axes by the previous axis, or at the start by the first defined one. Then removes sudden
    // flips.
    std::vector<CrossSectionPlane> planes(count_);
    glm::dvec3 last = *first;
    for (std::size_t i = 0; i < count_; ++i) {
      if (z[i] == kZero) z[i] = last;
      if (glm::dot(z[i], last) < 0) z[i] = -z[i];
      last = z[i];
      planes[i] = plane_of(y_axis(i), z[i]);
    }
    if (closed_) planes.back() = planes.front();
    return planes;
  }

 private:
  /// Returns the direction of a straight spine.
  [[nodiscard]] glm::dvec3 direction() const {
    const glm::dvec3 along = unit(points_.back() - points_.front());
    return along != kZero ? along : unit(points_[1] - points_[0]);
  }

  [[nodiscard]] glm::dvec3 y_axis(std::size_t i) const {
    const bool first = i == 0, last = i + 1 == count_;
    const glm::dvec3& before = first ? points_[closed_ ? count_ - 2 : 0] : points_[i - 1];
    const glm::dvec3& after = last ? points_[closed_ ? 1 : i] : points_[i + 1];
    const glm::dvec3 y = unit(after - before);
    if (y != kZero) return y;
    return last ? unit(points_[i] - points_[i - 1]) : unit(points_[i + 1] - points_[i]);  // the spine turns back here
  }

  const std::vector<glm::dvec3>& points_;
  std::size_t count_;
  bool closed_;
};

}  // namespace

std::vector<CrossSectionPlane> cross_section_planes(std::span<const glm::vec3> spine) {
  std::vector<glm::dvec3> points;  // spine points without those that coincide with the previous point
  std::vector<std::size_t> place;  // index of each spine point in `points`
  place.reserve(spine.size());
  for (const glm::vec3& point : spine) {
    const glm::dvec3 p(point);
    const bool finite = std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
    if (finite && (points.empty() || points.back() != p)) points.push_back(p);
    place.push_back(points.empty() ? 0 : points.size() - 1);
  }
  std::vector<CrossSectionPlane> planes(spine.size());
  if (points.size() < 2) return planes;
  const std::vector<CrossSectionPlane> distinct = Spine(points).planes();
  for (std::size_t i = 0; i < spine.size(); ++i) planes[i] = distinct[place[i]];
  return planes;
}

}  // namespace gs::vrml
