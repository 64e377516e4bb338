#pragma once

#include "qnv/codecs/displaced/surface.h"
#include "qnv/codecs/displaced/tessellation/patch_grid.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace gs::qnv {

/// Order of a patch's triangles: first the upright ones, row by row; from upright_triangles(n) on, the turned ones.
[[nodiscard]] constexpr std::size_t upright_row(std::size_t j, std::size_t n) { return j * n - j * (j - 1) / 2; }
[[nodiscard]] constexpr std::size_t upright_triangles(std::size_t n) { return n * (n + 1) / 2; }
[[nodiscard]] constexpr std::size_t turned_row(std::size_t j, std::size_t n) {
  return upright_triangles(n) + j * (n - 1) - j * (j - 1) / 2;
}

/// New vertices between existing ones, and their displacements.
struct PatchMiddles {
  std::size_t count = 0;
  const Columns *places = nullptr, *shifts = nullptr, *normals = nullptr;  // of the previous level, of one patch
  std::size_t a = 0, b = 0;                                                // index of the first vertex on either side
  std::array<const float*, displaced::kLayers> moved{};  // along the normal, one per vertex; nullptr means no
                                                         // displacement
};

/// Loops over the vertices of one patch, for several instruction sets. All give the same bits as displaced::predict().
struct PatchLoops {
  const char* name;
  /// Computes the cross products of all triangles, with n steps per edge. `at` is as filled by gather().
  void (*products)(const Columns& at, std::size_t n, Columns& products);
  /// Computes the unit normals of the inner vertices, row by row; zero if undefined.
  void (*inner_normals)(const Columns& products, std::size_t n, Columns& normals);
  void (*middles)(const PatchMiddles& of, Columns& places, Columns& shifts);
  /// Packs directions like pack_direction(); `packed` has padding as in Columns.
  void (*pack_directions)(const Columns& units, std::size_t count, std::uint32_t* packed);
  /// Converts positions from a Frame with this lower corner and size. Positions that are not finite become the lower
  /// corner.
  void (*leave_frame)(Columns& places, std::size_t count, const glm::vec3& lower, float size);
  /// Normalises the products into `units`. Products without direction become zero, in both.
  void (*directions)(Columns& products, std::size_t count, Columns& units);
  /// Returns the least dot product of the unit vectors with an axis, at most 1; skips zero vectors.
  float (*least_cosine)(const Columns& units, std::size_t count, const glm::vec3& axis);
  /// Returns the largest distance from a point.
  float (*farthest)(const Columns& places, std::size_t count, const glm::vec3& from);
};

/// Returns the versions that this machine supports, fastest first.
[[nodiscard]] std::span<const PatchLoops> patch_loops();

}  // namespace gs::qnv
