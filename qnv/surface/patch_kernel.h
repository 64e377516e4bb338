#pragma once

#include "qnv/displaced/surface.h"
#include "qnv/surface/patch_grid.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace gs::qnv {

/// Upright triangles of a patch, row by row; behind them, from upright_triangles(n) on, those that are turned.
[[nodiscard]] constexpr std::size_t upright_row(std::size_t j, std::size_t n) { return j * n - j * (j - 1) / 2; }
[[nodiscard]] constexpr std::size_t upright_triangles(std::size_t n) { return n * (n + 1) / 2; }
[[nodiscard]] constexpr std::size_t turned_row(std::size_t j, std::size_t n) {
  return upright_triangles(n) + j * (n - 1) - j * (j - 1) / 2;
}

/// Where new vertices lie between others, and how far they are moved.
struct PatchMiddles {
  std::size_t count = 0;
  const Columns *places = nullptr, *shifts = nullptr, *normals = nullptr;  // of the level before, of one patch
  std::size_t a = 0, b = 0;                                                // the first vertex on either side
  std::array<const float*, displaced::kLayers> moved{};  // along the normal, a number a vertex; null: not at all
};

/// Loops over the vertices of one patch, for several instruction sets: the same bits from each of them, and from
/// displaced::predict.
struct PatchLoops {
  const char* name;
  /// The products of the sides of all triangles of n steps an edge. `at`: as of gather.
  void (*products)(const Columns& at, std::size_t n, Columns& products);
  /// The unit sums round the vertices inside, row by row; zero where there is none.
  void (*inner_normals)(const Columns& products, std::size_t n, Columns& normals);
  void (*middles)(const PatchMiddles& of, Columns& places, Columns& shifts);
  /// As pack_direction; `packed` has room as Columns have.
  void (*pack_directions)(const Columns& units, std::size_t count, std::uint32_t* packed);
  /// Places from a frame with this lower corner and size; those that are not finite then become the corner.
  void (*leave_frame)(Columns& places, std::size_t count, const glm::vec3& lower, float size);
  /// Products that have no direction become zero; the others' directions.
  void (*directions)(Columns& products, std::size_t count, Columns& units);
  /// The least product of unit vectors with an axis, 1 at most; zeros do not count.
  float (*least_cosine)(const Columns& units, std::size_t count, const glm::vec3& axis);
  /// The longest way from a place.
  float (*farthest)(const Columns& places, std::size_t count, const glm::vec3& from);
};

/// Those that this machine has, the fastest first.
[[nodiscard]] std::span<const PatchLoops> patch_loops();

}  // namespace gs::qnv
