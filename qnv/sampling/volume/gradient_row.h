#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>

/// Gradients along a row of voxels; for volume encoders and their tests.
namespace gs::qnv {

/// Row of values along x with its neighbour rows. At a border, the row itself replaces the missing neighbour.
struct GradientRow {
  const float* here = nullptr;
  std::array<const float*, 2> before{}, after{};  // across y, across z
  std::array<double, 2> factor{1, 1};             // 0.5 between two neighbours, 1 at a border
  std::uint32_t count = 0;
};

/// Returns the gradient at voxel x of a row: central differences; one-sided if a neighbour is missing or beyond the
/// border; 0 if both are. `to_world` maps differences along the axes to world space: it is the inverse transpose of the
/// axes' matrix. Returns zero if the voxel itself is missing.
[[nodiscard]] glm::dvec3 gradient_at(const GradientRow& row, std::uint32_t x, const glm::dmat3& to_world);

/// Computes the gradient lengths of a whole row, clamped to the largest float and rounded to float. `gaps` means that
/// values may be missing (slower). Both paths give the same bits.
void magnitudes_portable(const GradientRow& row, const glm::dmat3& to_world, bool gaps, float* out);
/// AVX2 version. Call only if has_avx2().
void magnitudes_avx2(const GradientRow& row, const glm::dmat3& to_world, bool gaps, float* out);
[[nodiscard]] bool has_avx2();

/// Selects the fastest version.
void magnitudes(const GradientRow& row, const glm::dmat3& to_world, bool gaps, float* out);

}  // namespace gs::qnv
