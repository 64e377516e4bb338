#include "vrml/tessellation/nurbs.h"

#include <glm/vec4.hpp>

#include <algorithm>
#include <cmath>

namespace gs::vrml {
namespace {

/// Returns x / by, or 0 if by is 0: there is no basis function between coincident knots (Cox-de Boor recurrence).
double divided(double x, double by) { return by > 0 ? x / by : 0; }

template <class Number>
bool usable_knots(std::span<const Number> knots, std::size_t points, std::size_t order) {
  return knots.size() == points + order &&
         std::all_of(knots.begin(), knots.end(), [](Number knot) { return std::isfinite(knot); }) &&
         std::is_sorted(knots.begin(), knots.end()) && knots[order - 1] < knots[points];
}

/// Returns the weight of control point `i`: from the node if it has one weight per point, otherwise 1.
double weight_of(const MFFloat& weights, std::size_t points, std::size_t i) {
  return weights.size() == points && weights[i] > 0 && std::isfinite(weights[i]) ? weights[i] : 1;
}

}  // namespace

template <class Number>
std::optional<NurbsAxis> NurbsAxis::make_of(std::size_t points, std::int32_t order, std::span<const Number> knots) {
  if (order < 2 || order > kMaximumOrder || points < static_cast<std::size_t>(order)) return std::nullopt;
  NurbsAxis axis;
  axis.points_ = points;
  axis.order_ = static_cast<std::size_t>(order);
  axis.knots_.resize(points + axis.order_);
  if (usable_knots(knots, points, axis.order_)) {
    std::copy(knots.begin(), knots.end(), axis.knots_.begin());
  } else {
    const std::size_t pieces = points - axis.order_ + 1;
    for (std::size_t i = 0; i < axis.knots_.size(); ++i)
      axis.knots_[i] = static_cast<double>(std::clamp(i, axis.order_ - 1, axis.order_ - 1 + pieces));
  }
  return axis;
}

std::optional<NurbsAxis> NurbsAxis::make(std::size_t points, std::int32_t order, std::span<const float> knots) {
  return make_of(points, order, knots);
}
std::optional<NurbsAxis> NurbsAxis::make(std::size_t points, std::int32_t order, std::span<const double> knots) {
  return make_of(points, order, knots);
}

double NurbsAxis::place_of(double parameter) const {
  const double begin = knots_[order_ - 1], end = knots_[points_];
  return (parameter - begin) / (end - begin);
}

NurbsAxis::Weights NurbsAxis::at(double place) const {
  const double begin = knots_[order_ - 1], end = knots_[points_];
  const double t = begin + (end - begin) * (place > 0 ? std::min(place, 1.0) : 0);
  // Finds the knot interval that contains t. For the end of the axis, finds the last interval that is not empty.
  const auto from = knots_.begin() + static_cast<std::ptrdiff_t>(order_ - 1);
  const auto to = knots_.begin() + static_cast<std::ptrdiff_t>(points_);
  const auto above = t < end ? std::upper_bound(from, to, t) : std::lower_bound(from, to, end);
  const auto piece = static_cast<std::size_t>(above - knots_.begin()) - 1;

  Weights weights;
  weights.first = piece + 1 - order_;
  std::array<double, kMaximumOrder> below{};  // basis functions of the next lower order, for the slopes
  weights.value[0] = 1;
  for (std::size_t degree = 1; degree < order_; ++degree) {
    if (degree == order_ - 1) below = weights.value;
    double carried = 0;
    for (std::size_t k = 0; k < degree; ++k) {
      const double left = knots_[piece + k + 1 - degree], right = knots_[piece + k + 1];
      const double share = divided(weights.value[k], right - left);
      weights.value[k] = carried + (right - t) * share;
      carried = (t - left) * share;
    }
    weights.value[degree] = carried;
  }
  const auto degree = order_ - 1;
  double falling = 0;
  for (std::size_t k = 0; k <= degree; ++k) {
    const double left = knots_[piece + k + 1 - degree], right = k < degree ? knots_[piece + k + 1] : left;
    const double rising = k < degree ? divided(below[k], right - left) : 0;
    weights.slope[k] = static_cast<double>(degree) * (falling - rising) * (end - begin);
    falling = rising;
  }
  return weights;
}

std::size_t NurbsAxis::steps(std::int32_t tessellation) const {
  constexpr std::size_t kMax = 2048, kMin = 16;
  const auto size = static_cast<std::size_t>(std::abs(static_cast<std::int64_t>(tessellation)));
  const std::size_t points = std::min(points_, kMax);
  if (tessellation == 0) return std::clamp(2 * points, kMin, kMax);
  return std::min(tessellation > 0 ? size : std::min(size, kMax) * points, kMax);
}

SFVec3f nurbs_point(const NurbsAxis& axis, const MFVec3f& points, const MFFloat& weights, double place) {
  const NurbsAxis::Weights at = axis.at(place);
  glm::dvec4 sum(0);
  for (std::size_t k = 0; k < axis.order(); ++k) {
    const double weight = weight_of(weights, axis.points(), at.first + k);
    sum += glm::dvec4(glm::dvec3(points[at.first + k]), weight) * at.value[k];
  }
  return glm::vec3(glm::dvec3(sum) / sum.w);
}

}  // namespace gs::vrml
