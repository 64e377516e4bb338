#pragma once

#include "base/parallel.h"
#include "qnv/base/description.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

/// Building blocks of progressive_order(): points sorted along the Morton curve, and their octree.
namespace gs::qnv::order {

/// Returns a pseudo-random number for v, equal on every machine (the finaliser of MurmurHash3).
[[nodiscard]] constexpr std::uint64_t hash(std::uint64_t v) {
  v = (v ^ v >> 33) * 0xff51afd7ed558ccdULL;
  v = (v ^ v >> 33) * 0xc4ceb9fe1a85ec53ULL;
  return v ^ v >> 33;
}

/// Order of visits in which every prefix is spread evenly over a list. Its indices are multiples of the golden ratio.
class GoldenStride {
 public:
  GoldenStride(std::size_t count, std::uint64_t seed);
  [[nodiscard]] std::size_t next();

 private:
  std::size_t count_, stride_, at_;
};

struct KeyedIndex {
  std::uint64_t key;
  std::uint32_t index;
};
/// Sorts entries by the lowest `bits` bits of their keys. Stable.
void sort_by_key(std::vector<KeyedIndex>& entries, unsigned bits, unsigned threads);

/// Cube around points.
struct Cube {
  std::array<double, 3> lower{};
  double side = 0;
};
[[nodiscard]] Cube cube_around(std::span<const glm::vec3> positions);

inline constexpr unsigned kDeepest = 16;  // number of octree levels below the root

/// Points in one array per component, for vectorised loops. Padding after the last point may be read.
class Points {
 public:
  static constexpr std::size_t kPadding = 8;
  std::vector<float> x, y, z;
  std::vector<float> nx, ny, nz;  // unit normals; 0 if the points have none
  std::vector<float> density;  // >= 1; factor by which more points are taken here
  /// Resizes the arrays. New points are at 0, with density 1.
  void resize(std::size_t count);
  [[nodiscard]] std::size_t size() const { return count_; }
  void copy(std::size_t to, const Points& from, std::size_t i) {
    x[to] = from.x[i], y[to] = from.y[i], z[to] = from.z[i];
    nx[to] = from.nx[i], ny[to] = from.ny[i], nz[to] = from.nz[i];
    density[to] = from.density[i];
  }

 private:
  std::size_t count_ = 0;
};

/// Level of the octree: its occupied cells, in Morton order.
struct Level {
  std::vector<std::uint32_t> begin;  // first point of each cell; one more entry for the end
  std::vector<std::uint32_t> first_child;  // index in the next level; one more entry for the end; empty at the
                                           // deepest level
  [[nodiscard]] std::size_t size() const { return begin.size() - 1; }
};

/// Points in Morton order, and their octree.
struct Tree {
  std::vector<std::uint64_t> keys;  // Morton code of each point at kDeepest
  std::vector<std::uint32_t> source;  // index of each point in the input
  Points points;
  std::vector<Level> levels;  // from the root to kDeepest, or to the first level with nearly as many cells as points

  [[nodiscard]] unsigned octant(unsigned level, std::size_t cell) const {
    return static_cast<unsigned>(keys[levels[level].begin[cell]] >> 3 * (kDeepest - level) & 7);
  }
};

/// Builds the tree of the points `indices`. `normals` may be empty.
[[nodiscard]] Tree make_tree(const Cube& cube, std::span<const glm::vec3> positions, std::span<const glm::vec3> normals,
                             std::vector<std::uint32_t> indices, unsigned threads);

/// Adjacent cells of each cell of a level, including the cell itself.
struct Neighbours {
  std::vector<std::uint32_t> begin;  // index in `cells` of each cell's first entry; one more for the end
  std::vector<std::uint32_t> cells;
  [[nodiscard]] std::span<const std::uint32_t> of(std::size_t cell) const {
    return std::span(cells).subspan(begin[cell], begin[cell + 1] - begin[cell]);
  }
};
/// Returns the neighbours at the level of the root.
[[nodiscard]] Neighbours neighbours_of_root();
/// Returns the neighbours of the cells of `level`. `above` has the neighbours of the next coarser level.
[[nodiscard]] Neighbours neighbours_below(const Tree& tree, unsigned level, const Neighbours& above, unsigned threads);

}  // namespace gs::qnv::order
