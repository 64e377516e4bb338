#include "qnv/sampling/order/order.h"

#include "qnv/sampling/order/order_points.h"
#include "qnv/sampling/order/order_spread.h"

#include <algorithm>
#include <array>
#include <bit>
#include <numeric>
#include <utility>

namespace gs::qnv {
namespace {

constexpr unsigned kClasses = 6;  // number of magnitude classes, each a factor of eight apart
constexpr unsigned kClassSteps = 4;  // steps of `order::Taken` per halving of the distance

unsigned exponent(float weight) {
  const std::uint32_t bits = std::bit_cast<std::uint32_t>(weight);
  return bits >> 31 ? 0 : bits >> 23;
}

// Returns the points of each magnitude class. The first class starts at the magnitude that only the largest 1 % of the
// points reach.
std::array<std::vector<std::uint32_t>, kClasses> classes_of(std::span<const float> weights) {
  std::array<std::size_t, 256> histogram{};
  for (const float weight : weights) ++histogram[exponent(weight)];
  unsigned largest = 255;
  for (std::size_t above = histogram[255]; largest > 0 && above * 100 < weights.size();) above += histogram[--largest];
  std::array<std::vector<std::uint32_t>, kClasses> classes;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const unsigned e = exponent(weights[i]);
    const unsigned below = e >= largest ? 0 : (largest - e + 2) / 3;
    classes[std::min(below, kClasses - 1)].push_back(static_cast<std::uint32_t>(i));
  }
  return classes;
}

std::vector<std::uint32_t> order_surface(std::span<const glm::vec3> positions, std::span<const glm::vec3> normals,
                                         const order::Cube& cube, const OrderOptions& options) {
  std::vector<std::uint32_t> all(positions.size());
  std::iota(all.begin(), all.end(), 0u);
  order::Tree tree = order::make_tree(cube, positions, normals, std::move(all), options.threads);
  const auto taken = order::spread(tree, {options.seed, !normals.empty(), options.threads, options.progress});
  std::vector<std::uint32_t> result(taken.size());
  for (std::size_t i = 0; i < taken.size(); ++i) result[i] = tree.source[taken[i].point];
  return result;
}

// Orders each class separately, then merges the classes. Each class has half the distance between points of the class
// with the next lower magnitudes.
std::vector<std::uint32_t> order_volume(std::span<const glm::vec3> positions, std::span<const float> weights,
                                        const order::Cube& cube, const OrderOptions& options) {
  std::vector<order::KeyedIndex> entries;
  entries.reserve(positions.size());
  auto classes = classes_of(weights);
  for (unsigned c = 0; c < kClasses; ++c) {
    order::Tree tree = order::make_tree(cube, positions, {}, std::move(classes[c]), options.threads);
    const auto taken = order::spread(tree, {options.seed + c, false, options.threads, options.progress});
    if (taken.size() != tree.source.size()) return {};
    for (std::size_t first = 0, last = 0; first < taken.size(); first = last) {
      while (last < taken.size() && taken[last].step == taken[first].step) ++last;
      // Interleaves the classes evenly within each step.
      for (std::size_t i = first; i < last; ++i) {
        const std::uint64_t within = ((i - first) << 16) / (last - first);
        entries.push_back({std::uint64_t{taken[i].step + kClassSteps * c} << 16 | within, tree.source[taken[i].point]});
      }
    }
  }
  order::sort_by_key(entries, 16 + 7, options.threads);  // the maximum step is 4 * 17 + 1 + 4 * 5
  std::vector<std::uint32_t> result(entries.size());
  for (std::size_t i = 0; i < entries.size(); ++i) result[i] = entries[i].index;
  return result;
}

}  // namespace

std::vector<std::uint32_t> progressive_order(std::span<const glm::vec3> positions, std::span<const glm::vec3> normals,
                                             std::span<const float> weights, const OrderOptions& options) {
  order::Cube cube = order::cube_around(positions);
  if (!(cube.side > 0)) cube.side = 1;  // all points coincide
  std::vector<std::uint32_t> result = options.kind == Kind::surface ? order_surface(positions, normals, cube, options)
                                                                    : order_volume(positions, weights, cube, options);
  if (options.progress && options.progress->cancelled) return {};
  return result;
}

}  // namespace gs::qnv
