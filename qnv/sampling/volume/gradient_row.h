#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>

/// Gradients along a row of voxels. Only volume encoders and their tests use them.
namespace gs::qnv {

/// Row of values along x, and its neighbour rows. At a border, the row itself replaces the missing neighbour.
struct GradientRow {
  const float* here = nullptr;
  std::array<const float*, 2> before{}, after{};  // neighbour rows on the y axis, on the z axis
  std::array<double, 2> factor{1, 1};             // 0.5 between two neighbours, 1 at a border
  std::uint32_t count = 0;
};

/// Returns the gradient at voxel x of a row. Uses central differences; one-sided differences if a neighbour is missing
/// or outside the volume; 0 on an axis without neighbours. Returns zero if the voxel itself is missing. `to_world` maps
/// differences along the axes to world space: it is the inverse transpose of the matrix of the axes.
[[nodiscard]] glm::dvec3 gradient_at(const GradientRow& row, std::uint32_t x, const glm::dmat3& to_world);

/// Computes the lengths of all gradients of a row, clamped to the largest float and rounded to float. Set `gaps` if
/// values may be missing, which is slower. All versions give the same bits.
void magnitudes_portable(const GradientRow& row, const glm::dmat3& to_world, bool gaps, float* out);
/// Computes the same lengths with AVX2. Call it only if has_avx2().
void magnitudes_avx2(const GradientRow& row, const glm::dmat3& to_world, bool gaps, float* out);
[[nodiscard]] bool has_avx2();

/// Computes the same lengths with the fastest version for this processor.
void magnitudes(const GradientRow& row, const glm::dmat3& to_world, bool gaps, float* out);

}  // namespace gs::qnv
