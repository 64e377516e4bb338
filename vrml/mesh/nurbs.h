#pragma once

#include "vrml/scene/field_value.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace gs::vrml {

/// One direction of a non-uniform rational B-spline (VRML97 Amendment 1): its knots, and what each control point counts
/// at a place. A curve has one direction, a surface two.
class NurbsAxis {
 public:
  static constexpr int kMaximumOrder = 32;

  /// For `points` control points. Knots that are not points + order in number, decrease or are not finite are replaced
  /// by uniform ones that reach the first and the last control point. Nothing: fewer points than the order, or an order
  /// below 2 or above kMaximumOrder.
  [[nodiscard]] static std::optional<NurbsAxis> make(std::size_t points, std::int32_t order,
                                                     std::span<const float> knots);

  /// The control points from `first` on, `order()` of them, count `value`; the sum of these is 1. `slope` is how that
  /// changes with the place, where the whole axis has the length 1.
  struct Weights {
    std::size_t first = 0;
    std::array<double, kMaximumOrder> value{}, slope{};
  };
  /// `place`: 0 where the axis begins to 1 where it ends; what is outside counts as the nearest end.
  [[nodiscard]] Weights at(double place) const;

  [[nodiscard]] std::size_t points() const { return points_; }
  [[nodiscard]] std::size_t order() const { return order_; }
  /// Of how many pieces of equal length the axis is drawn by the `tessellation` of its node: as many as it says, where
  /// it is negative as many for each control point; where it is 0 two for each, and at least 16. At most 2048.
  [[nodiscard]] std::size_t steps(std::int32_t tessellation) const;

 private:
  std::size_t points_ = 0, order_ = 0;
  std::vector<double> knots_;  // points_ + order_, none smaller than the one before
};

/// The place of a curve whose control points are the axis's. Weights that are not as many as these, and single ones
/// that are not above 0, count as 1.
[[nodiscard]] SFVec3f nurbs_point(const NurbsAxis& axis, const MFVec3f& points, const MFFloat& weights, double place);

}  // namespace gs::vrml
