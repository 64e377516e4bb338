#pragma once

#include "qnv/codecs/displaced/surface.h"
#include "qnv/codecs/displaced/tessellation/patch_grid.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace gs::qnv {

/// Index of the first upright triangle in row j. A patch's upright triangles come first, row by row; from index
/// upright_triangles(n) on, the turned triangles follow.
[[nodiscard]] constexpr std::size_t upright_row(std::size_t j, std::size_t n) { return j * n - j * (j - 1) / 2; }
[[nodiscard]] constexpr std::size_t upright_triangles(std::size_t n) { return n * (n + 1) / 2; }
[[nodiscard]] constexpr std::size_t turned_row(std::size_t j, std::size_t n) {
  return upright_triangles(n) + j * (n - 1) - j * (j - 1) / 2;
}

/// Input of the loop `middles`: new vertices between existing ones, and their displacements.
struct PatchMiddles {
  std::size_t count = 0;
  const Columns *places = nullptr, *shifts = nullptr, *normals = nullptr;  // vertices of a patch at the previous level
  std::size_t a = 0, b = 0;  // index of the first vertex on each side
  std::array<const float*, displaced::kLayers> moved{};  // displacements along the normal, by layer; one
                                                         // number per vertex; nullptr means none
};

/// Loops over the vertices of one patch, compiled for one instruction set. All versions give the same bits as
/// displaced::predict().
struct PatchLoops {
  const char* name;
  /// Computes the cross products of all triangles of a patch with n steps per edge. gather() has filled `at`.
  void (*products)(const Columns& at, std::size_t n, Columns& products);
  /// Computes the unit normals of the inner vertices, row by row; zero if undefined.
  void (*inner_normals)(const Columns& products, std::size_t n, Columns& normals);
  void (*middles)(const PatchMiddles& of, Columns& places, Columns& shifts);
  /// Packs directions like pack_direction(). `packed` has the same padding as Columns.
  void (*pack_directions)(const Columns& units, std::size_t count, std::uint32_t* packed);
  /// Converts positions from a Frame with this lower corner and size to units of the stream. Positions that are not
  /// finite become `lower`.
  void (*leave_frame)(Columns& places, std::size_t count, const glm::vec3& lower, float size);
  /// Normalises the products into `units`. Products without direction become zero in both arrays.
  void (*directions)(Columns& products, std::size_t count, Columns& units);
  /// Returns the minimum of 1 and the dot products of the unit vectors with `axis`. Ignores zero vectors.
  float (*least_cosine)(const Columns& units, std::size_t count, const glm::vec3& axis);
  /// Returns the maximum distance of the positions from the point `from`.
  float (*farthest)(const Columns& places, std::size_t count, const glm::vec3& from);
};

/// Returns the versions that this machine supports, fastest first.
[[nodiscard]] std::span<const PatchLoops> patch_loops();

}  // namespace gs::qnv
