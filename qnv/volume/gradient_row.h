#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>

/// Gradients along a row of voxels; for the encoders of volumes, and for their tests.
namespace gs::qnv {

/// A row of values along x with its neighbours across: at a border the row itself stands for the one that
/// is not there.
struct GradientRow {
  const float* here = nullptr;
  std::array<const float*, 2> before{}, after{};  // across y, across z
  std::array<double, 2> factor{1, 1};             // 0.5 between two neighbours, 1 at a border
  std::uint32_t count = 0;
};

/// The gradient of the value at voxel x of a row: central differences, one-sided where a neighbour is
/// missing or beyond the border, 0 where both are. `to_world` maps differences along the axes to world
/// space: the inverse transpose of the matrix of axes. Zero where the voxel itself is missing.
[[nodiscard]] glm::dvec3 gradient_at(const GradientRow& row, std::uint32_t x, const glm::dmat3& to_world);

/// The lengths of these gradients for a whole row, cut to the largest float, rounded to float. `gaps`: some
/// values may be missing (slower). Both paths give the same bits.
void magnitudes_portable(const GradientRow& row, const glm::dmat3& to_world, bool gaps, float* out);
/// Call only where has_avx2().
void magnitudes_avx2(const GradientRow& row, const glm::dmat3& to_world, bool gaps, float* out);
[[nodiscard]] bool has_avx2();

/// By the fastest path.
void magnitudes(const GradientRow& row, const glm::dmat3& to_world, bool gaps, float* out);

}  // namespace gs::qnv
