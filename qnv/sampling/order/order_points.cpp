#include "qnv/sampling/order/order_points.h"

#include "qnv/base/morton.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <utility>

namespace gs::qnv::order {
namespace {

constexpr std::size_t kPointsPerTask = std::size_t{1} << 16;  // number of points in one task of a thread

// Calls work(first, last) for blocks that together cover 0..count.
template <class Work>
void in_blocks(std::size_t count, unsigned threads, const Work& work) {
  const std::size_t blocks = (count + kPointsPerTask - 1) / kPointsPerTask;
  parallel_for(
      blocks, [&](std::size_t b) { work(b * kPointsPerTask, std::min(count, (b + 1) * kPointsPerTask)); },
      blocks > 1 ? threads : 1);
}

constexpr unsigned kDigit = 11;  // bits of a digit
using DigitHistogram = std::array<std::uint32_t, std::size_t{1} << kDigit>;

// Sorts by one digit of the keys. Stable.
void sort_by_digit(const std::vector<KeyedIndex>& from, std::vector<KeyedIndex>& to, unsigned shift, unsigned mask,
                   std::vector<DigitHistogram>& histograms, unsigned threads) {
  in_blocks(from.size(), threads, [&](std::size_t first, std::size_t last) {
    DigitHistogram& histogram = histograms[first / kPointsPerTask];
    histogram.fill(0);
    for (std::size_t i = first; i < last; ++i) ++histogram[from[i].key >> shift & mask];
  });
  std::uint32_t sum = 0;
  for (std::size_t digit = 0; digit <= mask; ++digit)
    for (DigitHistogram& histogram : histograms) sum += std::exchange(histogram[digit], sum);
  in_blocks(from.size(), threads, [&](std::size_t first, std::size_t last) {
    DigitHistogram& next = histograms[first / kPointsPerTask];
    for (std::size_t i = first; i < last; ++i) to[next[from[i].key >> shift & mask]++] = from[i];
  });
}

std::uint32_t grid_coordinate(double offset, double side) {
  constexpr double cells = 1u << kDeepest;
  const double at = offset / side * cells;
  return at > 0 ? static_cast<std::uint32_t>(std::min(at, cells - 1)) : 0;  // NaN becomes 0
}

std::vector<KeyedIndex> sorted_keys(const Cube& cube, std::span<const glm::vec3> positions,
                                    const std::vector<std::uint32_t>& indices, unsigned threads) {
  std::vector<KeyedIndex> entries(indices.size());
  in_blocks(indices.size(), threads, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      const glm::vec3& p = positions[indices[i]];
      entries[i] = {morton_encode(grid_coordinate(p.x - cube.lower[0], cube.side),
                                  grid_coordinate(p.y - cube.lower[1], cube.side),
                                  grid_coordinate(p.z - cube.lower[2], cube.side)),
                    indices[i]};
    }
  });
  sort_by_key(entries, 3 * kDeepest, threads);
  return entries;
}

float finite_or(float value, double otherwise) { return std::isfinite(value) ? value : static_cast<float>(otherwise); }

// Returns the levels from the root to the first level with nearly as many cells as points, or to the deepest level.
std::vector<Level> make_levels(const std::vector<std::uint64_t>& keys) {
  // Number of cells that each level adds. Two neighbours on the Morton curve add a cell at the level where they
  // separate.
  std::array<std::size_t, kDeepest + 1> parted{};
  const auto parting_level = [&](std::size_t i) -> unsigned {
    if (i == 0) return 0;
    const std::uint64_t difference = keys[i] ^ keys[i - 1];
    if (difference == 0) return kDeepest + 1;
    return kDeepest - static_cast<unsigned>(63 - std::countl_zero(difference)) / 3;
  };
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const unsigned level = parting_level(i);
    if (level <= kDeepest) ++parted[level];
  }
  unsigned deepest = 0;
  for (std::size_t cells = parted[0]; deepest < kDeepest && cells < keys.size() - keys.size() / 8;)
    cells += parted[++deepest];
  std::vector<Level> levels(deepest + 1);
  for (std::size_t i = 0; i < keys.size(); ++i)
    if (parting_level(i) <= deepest) levels[deepest].begin.push_back(static_cast<std::uint32_t>(i));
  levels[deepest].begin.push_back(static_cast<std::uint32_t>(keys.size()));
  for (unsigned level = deepest; level-- > 0;) {
    const Level& below = levels[level + 1];
    for (std::size_t cell = 0; cell < below.size(); ++cell) {
      if (parting_level(below.begin[cell]) > level) continue;
      levels[level].begin.push_back(below.begin[cell]);
      levels[level].first_child.push_back(static_cast<std::uint32_t>(cell));
    }
    levels[level].begin.push_back(static_cast<std::uint32_t>(keys.size()));
    levels[level].first_child.push_back(static_cast<std::uint32_t>(below.size()));
  }
  return levels;
}

}  // namespace

GoldenStride::GoldenStride(std::size_t count, std::uint64_t seed) : count_(count), stride_(1), at_(0) {
  if (count < 2) return;
  // Increases the stride until it is coprime to the count, so that all entries are visited.
  stride_ = static_cast<std::size_t>(static_cast<double>(count) * 0.6180339887498949);
  while (std::gcd(++stride_, count) != 1) {
  }
  at_ = hash(seed) % count;
}

std::size_t GoldenStride::next() {
  const std::size_t result = at_;
  at_ += stride_ % count_;
  if (at_ >= count_) at_ -= count_;
  return result;
}

void sort_by_key(std::vector<KeyedIndex>& entries, unsigned bits, unsigned threads) {
  std::vector<KeyedIndex> other(entries.size());
  std::vector<DigitHistogram> histograms((entries.size() + kPointsPerTask - 1) / kPointsPerTask);
  for (unsigned shift = 0; shift < bits; shift += kDigit) {
    const unsigned digit = std::min(kDigit, bits - shift);
    sort_by_digit(entries, other, shift, (1u << digit) - 1, histograms, threads);
    entries.swap(other);
  }
}

Cube cube_around(std::span<const glm::vec3> positions) {
  Box box;
  for (const glm::vec3& p : positions)
    if (std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z)) box.add(p);
  Cube cube;
  if (box.empty()) return cube;
  for (int axis = 0; axis < 3; ++axis) {
    cube.lower[static_cast<std::size_t>(axis)] = box.lower[axis];
    cube.side = std::max(cube.side, double{box.upper[axis]} - double{box.lower[axis]});
  }
  return cube;
}

void Points::resize(std::size_t count) {
  count_ = count;
  for (std::vector<float>* numbers : {&x, &y, &z, &nx, &ny, &nz}) numbers->resize(count + kPadding);
  density.resize(count + kPadding, 1);
}

Tree make_tree(const Cube& cube, std::span<const glm::vec3> positions, std::span<const glm::vec3> normals,
               std::vector<std::uint32_t> indices, unsigned threads) {
  Tree tree;
  const std::size_t count = indices.size();
  tree.keys.resize(count);
  tree.source.resize(count);
  tree.points.resize(count);
  const std::vector<KeyedIndex> sorted = sorted_keys(cube, positions, indices, threads);
  // Scales to the size of the cube, so that squared distances neither overflow nor underflow.
  const double scale = 1 / cube.side;
  in_blocks(count, threads, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      const std::uint32_t from = sorted[i].index;
      tree.keys[i] = sorted[i].key;
      tree.source[i] = from;
      const glm::vec3& p = positions[from];
      tree.points.x[i] = static_cast<float>((finite_or(p.x, cube.lower[0]) - cube.lower[0]) * scale);
      tree.points.y[i] = static_cast<float>((finite_or(p.y, cube.lower[1]) - cube.lower[1]) * scale);
      tree.points.z[i] = static_cast<float>((finite_or(p.z, cube.lower[2]) - cube.lower[2]) * scale);
      if (normals.empty()) continue;
      tree.points.nx[i] = finite_or(normals[from].x, 0);
      tree.points.ny[i] = finite_or(normals[from].y, 0);
      tree.points.nz[i] = finite_or(normals[from].z, 0);
    }
  });
  tree.levels = make_levels(tree.keys);
  return tree;
}

Neighbours neighbours_of_root() { return {{0, 1}, {0}}; }

Neighbours neighbours_below(const Tree& tree, unsigned level, const Neighbours& above, unsigned threads) {
  const Level& parents = tree.levels[level - 1];
  const Level& cells = tree.levels[level];
  const unsigned shift = 3 * (kDeepest - level);
  constexpr std::size_t block = 2048;  // parents per task
  constexpr std::uint32_t none = ~0u;
  std::vector<Neighbours> parts((parents.size() + block - 1) / block);
  const auto find = [&](std::size_t part) {
    Neighbours& result = parts[part];
    const std::size_t end = std::min(parents.size(), (part + 1) * block);
    result.cells.reserve((end - part * block) * 40);
    for (std::size_t parent = part * block; parent < end; ++parent) {
      // 4 * 4 * 4 cells inside and around the parent. Each child has 3 * 3 * 3 of them as neighbours.
      std::array<std::uint32_t, 64> around;
      around.fill(none);
      const auto at = morton_decode(tree.keys[parents.begin[parent]] >> shift >> 3);
      for (const std::uint32_t uncle : above.of(parent)) {
        const auto uncle_at = morton_decode(tree.keys[parents.begin[uncle]] >> shift >> 3);
        // Positions of the uncle's children relative to the parent's first child, which are -2..3, plus 1. Only results
        // 0..3 are used.
        const std::uint32_t x = 2 * (uncle_at[0] - at[0]) + 1, y = 2 * (uncle_at[1] - at[1]) + 1,
                            z = 2 * (uncle_at[2] - at[2]) + 1;
        for (std::uint32_t cell = parents.first_child[uncle]; cell < parents.first_child[uncle + 1]; ++cell) {
          const unsigned octant = tree.octant(level, cell);
          const std::uint32_t cx = x + (octant & 1), cy = y + (octant >> 1 & 1), cz = z + (octant >> 2);
          if ((cx | cy | cz) < 4) around[cx + 4 * cy + 16 * cz] = cell;
        }
      }
      for (std::uint32_t cell = parents.first_child[parent]; cell < parents.first_child[parent + 1]; ++cell) {
        const unsigned octant = tree.octant(level, cell);
        const unsigned corner = (octant & 1) + 4 * (octant >> 1 & 1) + 16 * (octant >> 2);
        for (const unsigned row : {0u, 4u, 8u, 16u, 20u, 24u, 32u, 36u, 40u})
          for (unsigned i = corner + row; i < corner + row + 3; ++i)
            if (around[i] != none) result.cells.push_back(around[i]);
        result.begin.push_back(static_cast<std::uint32_t>(result.cells.size()));
      }
    }
  };
  parallel_for(parts.size(), find, parts.size() > 4 ? threads : 1);
  Neighbours result;
  result.begin.reserve(cells.size() + 1);
  result.begin.push_back(0);
  for (const Neighbours& part : parts) {
    const auto before = static_cast<std::uint32_t>(result.cells.size());
    for (const std::uint32_t end : part.begin) result.begin.push_back(before + end);
    result.cells.insert(result.cells.end(), part.cells.begin(), part.cells.end());
  }
  return result;
}

}  // namespace gs::qnv::order
