#pragma once

#include "vrml/scene/values/field_value.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace gs::vrml {

/// Parameter direction of a non-uniform rational B-spline (VRML97 Amendment 1): its knots and basis functions. A curve
/// has one direction, a surface has two.
class NurbsAxis {
 public:
  static constexpr int kMaximumOrder = 32;

  /// Makes an axis for `points` control points. Replaces invalid knots by uniform knots that reach the first and last
  /// control point. Knots are invalid if their number is not points + order, if a knot is less than the previous one,
  /// or if a knot is not finite. Returns nullopt if there are fewer points than the order, or if the order is below 2
  /// or above kMaximumOrder.
  [[nodiscard]] static std::optional<NurbsAxis> make(std::size_t points, std::int32_t order,
                                                     std::span<const float> knots);
  [[nodiscard]] static std::optional<NurbsAxis> make(std::size_t points, std::int32_t order,
                                                     std::span<const double> knots);

  /// Basis functions at a position: weights of order() control points, from index `first` on. The elements of `value`
  /// sum to 1. `slope` is their derivative by the parameter; the whole axis has the length 1.
  struct Weights {
    std::size_t first = 0;
    std::array<double, kMaximumOrder> value{}, slope{};
  };
  /// Evaluates the basis functions at `place`: 0 is the start of the axis, 1 its end. Clamps values outside.
  [[nodiscard]] Weights at(double place) const;

  [[nodiscard]] std::size_t points() const { return points_; }
  [[nodiscard]] std::size_t order() const { return order_; }
  /// Returns the number of equal intervals for the value of a `tessellation` field. A positive value is the number of
  /// intervals. A negative value is the number per control point. 0 means two per control point, at least 16. The
  /// maximum is 2048.
  [[nodiscard]] std::size_t steps(std::int32_t tessellation) const;
  /// Returns the place, 0 to 1, of a value of the parameter. Values outside of the axis give places outside of 0 to 1.
  [[nodiscard]] double place_of(double parameter) const;

 private:
  template <class Number>
  static std::optional<NurbsAxis> make_of(std::size_t points, std::int32_t order, std::span<const Number> knots);

  std::size_t points_ = 0, order_ = 0;
  std::vector<double> knots_;  // points_ + order_ knots, not decreasing
};

/// Evaluates a curve at `place`, 0 to 1. Points are homogeneous: (w x, w y, w z) for the weight w. Weights <= 0 count
/// as 1. All weights count as 1 if their number differs from the number of points.
[[nodiscard]] SFVec3f nurbs_point(const NurbsAxis& axis, const MFVec3f& points, const MFFloat& weights, double place);

}  // namespace gs::vrml
