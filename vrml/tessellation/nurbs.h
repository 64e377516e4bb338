#pragma once

#include "vrml/scene/field_value.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace gs::vrml {

/// One parameter direction of a non-uniform rational B-spline (VRML97 Amendment 1): its knots and basis functions. A
/// curve has one direction, a surface has two.
class NurbsAxis {
 public:
  static constexpr int kMaximumOrder = 32;

  /// Makes an axis for `points` control points. Invalid knots (wrong number, decreasing or not finite) are replaced by
  /// uniform ones that reach the first and last control point. The valid number is points + order. Returns nullopt for
  /// fewer points than the order, and for an order below 2 or above kMaximumOrder.
  [[nodiscard]] static std::optional<NurbsAxis> make(std::size_t points, std::int32_t order,
                                                     std::span<const float> knots);

  /// Basis functions of `order()` control points from `first` on. The elements of `value` sum to 1. `slope` is their
  /// derivative by the parameter, where the whole axis has the length 1.
  struct Weights {
    std::size_t first = 0;
    std::array<double, kMaximumOrder> value{}, slope{};
  };
  /// Evaluates the basis at `place`, from 0 at the start of the axis to 1 at its end; clamps outside values.
  [[nodiscard]] Weights at(double place) const;

  [[nodiscard]] std::size_t points() const { return points_; }
  [[nodiscard]] std::size_t order() const { return order_; }
  /// Returns the number of equal intervals for a node's `tessellation` field: a positive value is the number itself; a
  /// negative one is a number per control point; 0 means two per control point, at least 16. The maximum is 2048.
  [[nodiscard]] std::size_t steps(std::int32_t tessellation) const;

 private:
  std::size_t points_ = 0, order_ = 0;
  std::vector<double> knots_;  // points_ + order_ of them, non-decreasing
};

/// Evaluates a curve at `place`. Weights <= 0 count as 1; so do all weights if their number differs from that of the
/// points.
[[nodiscard]] SFVec3f nurbs_point(const NurbsAxis& axis, const MFVec3f& points, const MFFloat& weights, double place);

}  // namespace gs::vrml
