#pragma once

#include "qnv/base/cloud.h"
#include "qnv/base/parallel.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

/// Parts of progressive_order: points sorted along the Morton curve, and the octree that they make.
namespace gs::qnv::order {

/// Numbers that look random, the same everywhere (the finaliser of MurmurHash3).
[[nodiscard]] constexpr std::uint64_t hash(std::uint64_t v) {
  v = (v ^ v >> 33) * 0xff51afd7ed558ccdULL;
  v = (v ^ v >> 33) * 0xc4ceb9fe1a85ec53ULL;
  return v ^ v >> 33;
}

/// The order in which a list is gone through so that every prefix is spread over it: i times the golden ratio.
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
/// Sorts by the low `bits` of the keys; equal keys stay in their order.
void sort_by_key(std::vector<KeyedIndex>& entries, unsigned bits, unsigned threads);

/// The cube around a cloud.
struct Cube {
  std::array<double, 3> lower{};
  double side = 0;
};
[[nodiscard]] Cube cube_around(std::span<const glm::vec3> positions);

inline constexpr unsigned kDeepest = 16;  // levels of the octree below its root

/// Points one array a number, so that loops over them can be vectorised: behind the last there is room to read on.
class Points {
 public:
  static constexpr std::size_t kPadding = 8;
  std::vector<float> x, y, z;
  std::vector<float> nx, ny, nz;  // unit; 0 when there are none
  std::vector<float> density;     // >= 1: how much more are wanted here
  /// New points are at 0, with density 1.
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

/// One level of the octree: the cells that hold points, in Morton order.
struct Level {
  std::vector<std::uint32_t> begin;        // first point of each cell; one more for the end
  std::vector<std::uint32_t> first_child;  // in the level below, and one more for the end; empty at the deepest
  [[nodiscard]] std::size_t size() const { return begin.size() - 1; }
};

/// Points in Morton order and their octree.
struct Tree {
  std::vector<std::uint64_t> keys;    // Morton codes at kDeepest
  std::vector<std::uint32_t> source;  // index of each point in the cloud
  Points points;
  std::vector<Level> levels;  // from the root on, to the first with nearly as many cells as points or to kDeepest

  [[nodiscard]] unsigned octant(unsigned level, std::size_t cell) const {
    return static_cast<unsigned>(keys[levels[level].begin[cell]] >> 3 * (kDeepest - level) & 7);
  }
};

/// The tree of the points `indices` of a cloud. `normals` may be empty.
[[nodiscard]] Tree make_tree(const Cube& cube, std::span<const glm::vec3> positions, std::span<const glm::vec3> normals,
                             std::vector<std::uint32_t> indices, unsigned threads);

/// The cells of a level that touch each of its cells, itself included.
struct Neighbours {
  std::vector<std::uint32_t> begin;  // for each cell, in `cells`; one more for the end
  std::vector<std::uint32_t> cells;
  [[nodiscard]] std::span<const std::uint32_t> of(std::size_t cell) const {
    return std::span(cells).subspan(begin[cell], begin[cell + 1] - begin[cell]);
  }
};
/// Those of the root.
[[nodiscard]] Neighbours neighbours_of_root();
/// Those of `level`, from those of the level above it.
[[nodiscard]] Neighbours neighbours_below(const Tree& tree, unsigned level, const Neighbours& above, unsigned threads);

}  // namespace gs::qnv::order
