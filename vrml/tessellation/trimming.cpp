#include "vrml/tessellation/trimming.h"

#include <algorithm>
#include <cmath>

namespace gs::vrml {
namespace {

/// TrimmingEdge of a contour that is not horizontal, from the lower to the upper corner.
struct TrimmingEdge {
  glm::dvec2 low, high;

  [[nodiscard]] double x_at(double y) const {
    return low.x + (high.x - low.x) * std::clamp((y - low.y) / (high.y - low.y), 0.0, 1.0);
  }
};

std::vector<TrimmingEdge> trimming_edges(const std::vector<std::vector<glm::dvec2>>& contours) {
  std::vector<TrimmingEdge> edges;
  for (const std::vector<glm::dvec2>& contour : contours)
    for (std::size_t i = 0; i < contour.size(); ++i) {
      const glm::dvec2 &from = contour[i], &to = contour[(i + 1) % contour.size()];
      if (from.y != to.y) edges.push_back(from.y < to.y ? TrimmingEdge{from, to} : TrimmingEdge{to, from});
    }
  return edges;
}

/// TrapezoidSide of a trapezoid: its x at the lower and at the upper end of the strip.
struct TrapezoidSide {
  double low, high;
};

// Clips a convex polygon to x >= limit, or to x <= limit if `below`.
std::vector<glm::dvec2> clipped(const std::vector<glm::dvec2>& polygon, double limit, bool below) {
  std::vector<glm::dvec2> result;
  const auto inside = [&](const glm::dvec2& p) { return below ? p.x <= limit : p.x >= limit; };
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const glm::dvec2 &from = polygon[i], &to = polygon[(i + 1) % polygon.size()];
    if (inside(from)) result.push_back(from);
    if (inside(from) != inside(to)) {
      const double part = (limit - from.x) / (to.x - from.x);
      result.emplace_back(limit, from.y + (to.y - from.y) * part);
    }
  }
  return result;
}

// Splits a trapezoid between two sides at the columns of the grid.
void split(TrapezoidSide left, TrapezoidSide right, double low, double high, std::size_t columns,
           std::vector<std::vector<glm::dvec2>>& polygons) {
  const auto inside = [](TrapezoidSide side) {
    return TrapezoidSide{std::clamp(side.low, 0.0, 1.0), std::clamp(side.high, 0.0, 1.0)};
  };
  left = inside(left);
  right = inside(right);
  right = {std::max(left.low, right.low), std::max(left.high, right.high)};
  if (left.low == right.low && left.high == right.high) return;
  const std::vector<glm::dvec2> whole{{left.low, low}, {right.low, low}, {right.high, high}, {left.high, high}};
  const auto count = static_cast<double>(columns);
  const auto first = static_cast<std::size_t>(std::min(left.low, left.high) * count);
  const double last = std::max(right.low, right.high);
  for (std::size_t i = first; i < columns && static_cast<double>(i) / count < last; ++i) {
    std::vector<glm::dvec2> cell = clipped(whole, static_cast<double>(i) / count, false);
    cell = clipped(cell, static_cast<double>(i + 1) / count, true);
    cell.erase(std::unique(cell.begin(), cell.end()), cell.end());
    if (cell.size() > 1 && cell.front() == cell.back()) cell.pop_back();
    if (cell.size() > 2) polygons.push_back(std::move(cell));
  }
}

// Returns the boundaries of strips: the rows of the grid and the corners of all contours.
std::vector<double> strip_bounds(const std::vector<std::vector<glm::dvec2>>& contours, std::size_t rows) {
  std::vector<double> bounds;
  for (std::size_t j = 0; j <= rows; ++j) bounds.push_back(static_cast<double>(j) / static_cast<double>(rows));
  for (const std::vector<glm::dvec2>& contour : contours)
    for (const glm::dvec2& corner : contour)
      if (corner.y > 0 && corner.y < 1) bounds.push_back(corner.y);
  std::sort(bounds.begin(), bounds.end());
  bounds.erase(std::unique(bounds.begin(), bounds.end()), bounds.end());
  return bounds;
}

}  // namespace

std::vector<std::vector<glm::dvec2>> trim(const std::vector<std::vector<glm::dvec2>>& contours, std::size_t columns,
                                          std::size_t rows) {
  std::vector<TrimmingEdge> edges = trimming_edges(contours);
  std::sort(edges.begin(), edges.end(), [](const TrimmingEdge& a, const TrimmingEdge& b) { return a.low.y < b.low.y; });
  const std::vector<double> bounds = strip_bounds(contours, rows);
  std::vector<std::vector<glm::dvec2>> polygons;
  std::vector<TrimmingEdge> active;
  std::size_t next = 0;
  for (std::size_t strip = 0; strip + 1 < bounds.size(); ++strip) {
    const double low = bounds[strip], high = bounds[strip + 1], middle = (low + high) / 2;
    while (next < edges.size() && edges[next].low.y <= low) active.push_back(edges[next++]);
    std::erase_if(active, [&](const TrimmingEdge& edge) { return edge.high.y <= low; });
    std::vector<const TrimmingEdge*> crossing;
    for (const TrimmingEdge& edge : active) crossing.push_back(&edge);
    std::sort(crossing.begin(), crossing.end(),
              [&](const TrimmingEdge* a, const TrimmingEdge* b) { return a->x_at(middle) < b->x_at(middle); });
    for (std::size_t i = 0; i + 1 < crossing.size(); i += 2)
      split({crossing[i]->x_at(low), crossing[i]->x_at(high)},
            {crossing[i + 1]->x_at(low), crossing[i + 1]->x_at(high)}, low, high, columns, polygons);
  }
  return polygons;
}

std::size_t most_corners(const std::vector<std::vector<glm::dvec2>>& contours, std::size_t columns, std::size_t rows) {
  constexpr std::size_t kCorners = 6;  // of a trapezoid clipped to one column
  std::size_t corners = 0;
  for (const std::vector<glm::dvec2>& contour : contours) corners += contour.size();
  // A strip has at most one trapezoid per pair of edges, and the trapezoids of a strip share the columns.
  return kCorners * (rows + 1 + corners) * (columns + corners);
}

}  // namespace gs::vrml
