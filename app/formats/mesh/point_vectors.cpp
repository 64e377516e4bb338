#include "app/formats/mesh/point_vectors.h"

#include "app/formats/common/local_places.h"
#include "app/formats/common/ranges.h"
#include "app/formats/mesh/point_areas.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>
#include <utility>

namespace gs::app {
namespace {

/// Marks points at the position of an earlier point.
std::vector<bool> doubles(std::span<const glm::dvec3> points) {
  const auto bits = [&](std::size_t i) {
    std::array<std::uint64_t, 3> key{};
    for (std::size_t k = 0; k < 3; ++k) key[k] = std::bit_cast<std::uint64_t>(points[i][static_cast<int>(k)] + 0.0);
    return key;  // adding 0 has turned -0 into 0
  };
  std::vector<std::size_t> order(points.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    const auto x = bits(a), y = bits(b);
    return x != y ? x < y : a < b;
  });
  std::vector<bool> result(points.size());
  for (std::size_t i = 1; i < order.size(); ++i) result[order[i]] = bits(order[i]) == bits(order[i - 1]);
  return result;
}

/// Converter of points to vectors. Drops invalid points. If the file has no areas, also drops duplicate positions.
class Gatherer {
 public:
  explicit Gatherer(const PointVectors& points) : points_(points) {
    if (points.areas.empty()) doubled_places_ = doubles(points.positions);
    for (std::size_t i = 0; i < points.positions.size(); ++i) add(i);
  }

  ImportedVectors take() {
    if (places_.empty()) return std::string(points_.format) + ": no usable point; expected finite x y z and nx ny nz";
    set_places(splats_, places_);
    if (points_.areas.empty()) splats_.weights = point_areas(splats_.positions);
    qnv::Description& description = splats_.description;
    description.two_sided = true;
    for (std::size_t i = 0; i < splats_.size(); ++i) {
      // In float precision, close points may have area 0. Give them the smallest area.
      if (!std::isnormal(splats_.weights[i])) splats_.weights[i] = std::numeric_limits<float>::min();
      description.total += splats_.weights[i];
    }
    description.metadata.emplace_back("source", points_.format);
    count("points broken", broken_);
    count("points doubled", doubled_);
    const std::size_t there = points_.positions.size();
    count("points missing", points_.announced > there ? points_.announced - there : 0);
    return std::move(splats_);
  }

 private:
  void add(std::size_t i) {
    const glm::dvec3 p = points_.positions[i];
    const glm::vec3 n = points_.normals[i];
    const float length = std::sqrt(n.x * n.x + n.y * n.y + n.z * n.z);
    const bool placed =
        std::abs(p.x) <= kMaxCoordinate && std::abs(p.y) <= kMaxCoordinate && std::abs(p.z) <= kMaxCoordinate;
    if (!placed || !std::isnormal(length) ||
        (!points_.areas.empty() &&
         !(points_.areas[i] > 0 && points_.areas[i] <= 1e36f && std::isnormal(points_.areas[i])))) {
      ++broken_;
      return;
    }
    if (points_.areas.empty() && doubled_places_[i]) {
      ++doubled_;
      return;
    }
    places_.push_back(p);
    splats_.normals.push_back(n / length);
    if (!points_.areas.empty()) splats_.weights.push_back(points_.areas[i]);
    if (!points_.colors.empty()) {
      const auto part = [](float c) {
        return static_cast<std::uint8_t>(std::lround(c > 0 ? std::min(c, 255.0f) : 0.0f));
      };
      const glm::vec3 c = points_.colors[i];
      splats_.colors.push_back({part(c.x), part(c.y), part(c.z)});
    }
  }
  void count(const char* name, std::size_t number) {
    if (number > 0) splats_.description.metadata.emplace_back(name, std::to_string(number));
  }

  const PointVectors& points_;
  qnv::Splats splats_;
  std::vector<glm::dvec3> places_;
  std::vector<bool> doubled_places_;
  std::size_t broken_ = 0, doubled_ = 0;
};

}  // namespace

ImportedVectors vectors_of_points(const PointVectors& points) { return Gatherer(points).take(); }

}  // namespace gs::app
