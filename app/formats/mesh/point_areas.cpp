#include "app/formats/mesh/point_areas.h"

#include "base/parallel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>

namespace gs::app {
namespace {

constexpr std::size_t kNeighbors = 12, kLeaf = 12, kBlock = 4096;

/// Squared distances to the nearest points found so far, in ascending order.
struct Nearest {
  std::array<float, kNeighbors> squares{};
  std::size_t count = 0, wanted = kNeighbors;

  [[nodiscard]] bool wants(float square) const { return count < wanted || square < squares[count - 1]; }
  void add(float square) {
    if (!wants(square)) return;
    if (count < wanted) ++count;
    std::size_t i = count - 1;
    for (; i > 0 && squares[i - 1] > square; --i) squares[i] = squares[i - 1];
    squares[i] = square;
  }
};

/// Balanced kd-tree. The median along the longest axis splits each range of points.
class Tree {
 public:
  explicit Tree(std::span<const glm::vec3> points) : points_(points.begin(), points.end()), axes_(points.size()) {
    order_.resize(points.size());
    std::iota(order_.begin(), order_.end(), std::size_t{0});
    build(points, 0, points.size());
    for (std::size_t i = 0; i < order_.size(); ++i) points_[i] = points[order_[i]];
  }

  [[nodiscard]] const glm::vec3& point(std::size_t place) const { return points_[place]; }
  /// Returns the original index of the point at position `place` in the tree.
  [[nodiscard]] std::size_t index(std::size_t place) const { return order_[place]; }
  [[nodiscard]] std::size_t size() const { return points_.size(); }

  /// Finds the nearest neighbours of the point at position `place` in the tree, without that point itself.
  void search(std::size_t place, Nearest& nearest) const { search(place, 0, points_.size(), nearest); }

 private:
  void build(std::span<const glm::vec3> points, std::size_t first, std::size_t last) {
    while (last - first > kLeaf) {
      glm::vec3 lower = points[order_[first]], upper = lower;
      for (std::size_t i = first; i < last; ++i)
        for (int k = 0; k < 3; ++k) {
          lower[k] = std::min(lower[k], points[order_[i]][k]);
          upper[k] = std::max(upper[k], points[order_[i]][k]);
        }
      const glm::vec3 size = upper - lower;
      const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
      const std::size_t middle = first + (last - first) / 2;
      const auto at = [&](std::size_t i) { return order_.begin() + static_cast<std::ptrdiff_t>(i); };
      std::nth_element(at(first), at(middle), at(last),
                       [&](std::size_t a, std::size_t b) { return points[a][axis] < points[b][axis]; });
      axes_[middle] = static_cast<std::uint8_t>(axis);
      build(points, first, middle);
      first = middle + 1;
    }
  }

  void visit(std::size_t place, std::size_t other, Nearest& nearest) const {
    if (place == other) return;
    const glm::vec3 d = points_[place] - points_[other];
    nearest.add(d.x * d.x + d.y * d.y + d.z * d.z);
  }

  void search(std::size_t place, std::size_t first, std::size_t last, Nearest& nearest) const {
    if (last - first <= kLeaf) {
      for (std::size_t i = first; i < last; ++i) visit(place, i, nearest);
      return;
    }
    const std::size_t middle = first + (last - first) / 2;
    const int axis = axes_[middle];
    const float distance = points_[place][axis] - points_[middle][axis];
    const bool below = distance < 0 || (distance == 0 && place < middle);
    search(place, below ? first : middle + 1, below ? middle : last, nearest);
    visit(place, middle, nearest);
    if (nearest.wants(distance * distance)) search(place, below ? middle + 1 : first, below ? last : middle, nearest);
  }

  std::vector<glm::vec3> points_;
  std::vector<std::size_t> order_;
  std::vector<std::uint8_t> axes_;
};

/// Estimates the area per point. A circle through neighbour j (from 1) contains j + 1/2 points: the centre, j - 1
/// neighbours, and half of neighbour j on its border. The result is the sum of all circle areas divided by the sum of
/// these points.
float area_of(const Nearest& nearest) {
  if (nearest.count == 0) return 1;
  double squares = 0, points = 0;
  for (std::size_t j = 0; j < nearest.count; ++j) {
    squares += static_cast<double>(nearest.squares[j]);
    points += static_cast<double>(j) + 1.5;
  }
  return static_cast<float>(std::numbers::pi * squares / points);
}

}  // namespace

std::vector<float> point_areas(std::span<const glm::vec3> points) {
  std::vector<float> areas(points.size());
  const Tree tree(points);
  // Each thread writes separate elements. Only elements at block borders share cache lines.
  parallel_for((points.size() + kBlock - 1) / kBlock, [&](std::size_t block) {
    const std::size_t last = std::min(points.size(), (block + 1) * kBlock);
    for (std::size_t place = block * kBlock; place < last; ++place) {
      Nearest nearest;
      tree.search(place, nearest);
      areas[tree.index(place)] = area_of(nearest);
    }
  });
  return areas;
}

}  // namespace gs::app
