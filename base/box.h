#pragma once

#include <glm/vec3.hpp>

#include <algorithm>
#include <limits>

namespace gs {

/// Axis-aligned box; empty if lower > upper on any axis.
template <class Number>
struct BasicBox {
  using Vector = glm::vec<3, Number>;
  Vector lower{std::numeric_limits<Number>::infinity()};
  Vector upper{-std::numeric_limits<Number>::infinity()};

  BasicBox() = default;
  BasicBox(const Vector& least, const Vector& most) : lower(least), upper(most) {}
  /// Converts without loss, from float to double only.
  template <class Other>
  requires(sizeof(Other) < sizeof(Number)) BasicBox(const BasicBox<Other>& other)
      : lower(other.lower), upper(other.upper) {}

  [[nodiscard]] bool empty() const { return !(lower.x <= upper.x && lower.y <= upper.y && lower.z <= upper.z); }
  void add(const Vector& point) {
    lower = {std::min(lower.x, point.x), std::min(lower.y, point.y), std::min(lower.z, point.z)};
    upper = {std::max(upper.x, point.x), std::max(upper.y, point.y), std::max(upper.z, point.z)};
  }
  void add(const BasicBox& other) {
    if (other.empty()) return;
    add(other.lower);
    add(other.upper);
  }
  [[nodiscard]] Vector center() const { return (lower + upper) * Number(0.5); }
  /// Returns the extents in single precision. An extent that does not fit is infinite.
  [[nodiscard]] glm::vec3 size() const { return glm::vec3(upper - lower); }
  friend bool operator==(const BasicBox&, const BasicBox&) = default;
};

using Box = BasicBox<float>;
/// Box in double precision, for world space; precise even far from 0.
using WideBox = BasicBox<double>;

}  // namespace gs
