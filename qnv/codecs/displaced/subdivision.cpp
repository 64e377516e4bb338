#include "qnv/codecs/displaced/subdivision.h"

#include "base/parallel.h"

#include <algorithm>
#include <array>

namespace gs::qnv::displaced {
namespace {

constexpr std::size_t kPatchesTogether = 64;

/// Sums of triangle normals at slots. Every slot adds its terms in the order of patches and triangles, so that the
/// result does not depend on the number of threads.
class NormalSums {
 public:
  NormalSums(const Patches& patches, const Patches& slots, int level, std::span<const glm::vec3> positions,
             std::vector<glm::vec3>& normals)
      : patches_(patches),
        slots_(slots),
        level_(level),
        n_(std::size_t{1} << level),
        positions_(positions),
        normals_(normals) {}

  /// Selects a patch for the following calls.
  void patch(std::uint32_t p) {
    patches_.grid(p, level_, grid_);
    slots_.grid(p, level_, slot_grid_);
  }
  /// Adds the patch's triangles at all its slots.
  void whole() {
    const auto any = [](const At&) { return true; };
    for (std::size_t j = 0; j < n_; ++j)
      for (std::size_t i = 0; i + j < n_; ++i) {
        triangle({i, j}, {i + 1, j}, {i, j + 1}, any);
        if (i + j + 1 < n_) triangle({i + 1, j}, {i + 1, j + 1}, {i, j + 1}, any);
      }
  }
  /// Adds the patch's triangles at its slots, except at corners and at edges that another patch owns.
  void own(std::uint32_t p) {
    std::array<bool, 3> owns{};
    for (std::uint32_t k = 0; k < 3; ++k) owns[k] = slots_.owns(p, k);
    const bool all = owns[0] && owns[1] && owns[2];
    for (std::size_t j = 0; j < n_; ++j)
      for (std::size_t i = 0; i + j < n_; ++i) {
        const bool inside = i > 0 && j > 0 && i + j + 2 < n_;
        triangle({i, j}, {i + 1, j}, {i, j + 1}, [&](const At& at) { return inside || is_own(at, owns, all); });
        if (i + j + 1 < n_)
          triangle({i + 1, j}, {i + 1, j + 1}, {i, j + 1},
                   [&](const At& at) { return inside || is_own(at, owns, all); });
      }
  }
  /// Adds the patch's triangles at the slots of edge k, which another patch owns.
  void foreign(std::uint32_t k) {
    for (std::size_t j = 0; j < (k == 0 ? 1 : n_); ++j) {
      // Visits the triangles that touch the edge, in order.
      const std::size_t row = n_ - j, from = k == 1 && row > 2 ? row - 2 : 0, to = k == 2 ? 1 : row;
      for (std::size_t i = from; i < to; ++i) {
        triangle({i, j}, {i + 1, j}, {i, j + 1}, [&](const At& at) { return edge_of(at) == k; });
        if (i + j + 1 < n_)
          triangle({i + 1, j}, {i + 1, j + 1}, {i, j + 1}, [&](const At& at) { return edge_of(at) == k; });
      }
    }
  }
  /// Adds the patch's triangles at its corners.
  void corners() {
    const auto is_corner = [&](const At& at) { return edge_of(at) == kCorner; };
    triangle({0, 0}, {1, 0}, {0, 1}, is_corner);
    if (n_ == 1) return;
    triangle({n_ - 1, 0}, {n_, 0}, {n_ - 1, 1}, is_corner);
    triangle({0, n_ - 1}, {1, n_ - 1}, {0, n_}, is_corner);
  }

 private:
  struct At {
    std::size_t i, j;
  };
  static constexpr std::uint32_t kInside = 3, kCorner = 4;

  [[nodiscard]] std::uint32_t edge_of(const At& at) const {
    const bool first = at.j == 0, second = at.i + at.j == n_, third = at.i == 0;
    if (int{first} + int{second} + int{third} > 1) return kCorner;
    return first ? 0 : second ? 1 : third ? 2 : kInside;
  }
  [[nodiscard]] bool is_own(const At& at, const std::array<bool, 3>& owns, bool all) const {
    const std::uint32_t edge = edge_of(at);
    return edge == kInside || (edge != kCorner && (all || owns[edge]));
  }
  template <class Wanted>
  void triangle(const At& a, const At& b, const At& c, Wanted wanted) {
    const auto number = [&](const At& at) { return row_start(at.j, n_) + at.i; };
    const std::size_t at_a = number(a), at_b = number(b), at_c = number(c);
    const glm::vec3 from = positions_[grid_[at_a]];
    const glm::vec3 cross = glm::cross(positions_[grid_[at_b]] - from, positions_[grid_[at_c]] - from);
    if (wanted(a)) normals_[slot_grid_[at_a]] += cross;
    if (wanted(b)) normals_[slot_grid_[at_b]] += cross;
    if (wanted(c)) normals_[slot_grid_[at_c]] += cross;
  }

  const Patches &patches_, &slots_;
  int level_;
  std::size_t n_;
  std::span<const glm::vec3> positions_;
  std::vector<glm::vec3>& normals_;
  std::vector<std::uint32_t> grid_, slot_grid_;
};

}  // namespace

std::vector<glm::vec3> slot_normals(const Patches& patches, const Patches& slots, int level,
                                    std::span<const glm::vec3> positions, unsigned threads) {
  std::vector<glm::vec3> normals(slots.vertices_at(level), glm::vec3(0));
  const std::size_t all = patches.size(), parts = (all + kPatchesTogether - 1) / kPatchesTogether;
  const auto each_patch = [&](std::size_t part, const auto& work) {
    NormalSums sums(patches, slots, level, positions, normals);
    for (std::size_t p = part * kPatchesTogether; p < std::min(all, (part + 1) * kPatchesTogether); ++p)
      work(sums, static_cast<std::uint32_t>(p));
  };
  const auto in_parts = [&](const auto& work) {
    parallel_for(
        parts, [&](std::size_t part) { each_patch(part, work); }, threads);
  };
  if (threads == 1) {
    in_parts([](NormalSums& sums, std::uint32_t p) {
      sums.patch(p);
      sums.whole();
    });
  } else {
    // Patches add to their own slots first, then to edges of other patches: an edge's owner has the smaller index.
    // Corners are few and come last.
    in_parts([](NormalSums& sums, std::uint32_t p) {
      sums.patch(p);
      sums.own(p);
    });
    in_parts([&](NormalSums& sums, std::uint32_t p) {
      if (slots.owns(p, 0) && slots.owns(p, 1) && slots.owns(p, 2)) return;
      sums.patch(p);
      for (std::uint32_t k = 0; k < 3; ++k)
        if (!slots.owns(p, k)) sums.foreign(k);
    });
    NormalSums sums(patches, slots, level, positions, normals);
    for (std::uint32_t p = 0; p < all; ++p) {
      sums.patch(p);
      sums.corners();
    }
  }
  parallel_for(
      parts,
      [&](std::size_t part) {
        for (std::size_t s = normals.size() * part / parts; s < normals.size() * (part + 1) / parts; ++s) {
          const float length = glm::length(normals[s]);
          normals[s] = length > 0 ? normals[s] / length : glm::vec3(0);
        }
      },
      threads);
  return normals;
}

}  // namespace gs::qnv::displaced
