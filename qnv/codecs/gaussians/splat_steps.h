#pragma once

#include "qnv/codecs/gaussians/splat_code.h"

#include <array>
#include <cstddef>

namespace gs::qnv::gaussians {

// Steps of the codes of Gaussians. FORMAT.md, "Gaussians payload", defines them.

/// Largest errors of final Gaussians. The first number of an array holds for important Gaussians, the second one for
/// all.
struct SplatErrors {
  std::array<double, 2> place;  // in standard deviations along each axis; a thin axis counts as wider (FORMAT.md)
  std::array<double, 2> color;
  std::array<double, 2> scale;    // of the two longer axes, relative to the deviation
  std::array<double, 2> thin;     // of the shortest axis, relative: first if about as long as the next one, then all
  std::array<double, 2> opacity;  // largest for splats below half a step, which have the minimum opacity
};
[[nodiscard]] SplatErrors splat_errors(const GaussianCoding& coding);
/// Returns the errors of streams that the encoder writes with such steps.
[[nodiscard]] SplatErrors splat_errors(int steps = 0);
/// Returns the properties of a stream that decide its steps.
[[nodiscard]] Precision precision_of(const GaussianCoding& coding, const Box& box);

/// Returns the step of harmonics, relative to that of the colour of the same Gaussian.
[[nodiscard]] double harmonic_factor(const Precision& precision);
/// Returns the importance of a Gaussian in pictures: log2 of its area times its squared opacity, kScaleSteps an octave.
[[nodiscard]] int importance(const std::array<int, 3>& scales, int opacity, const Precision& precision);
/// Returns the steps of a Gaussian with known scales and opacity.
[[nodiscard]] SplatSteps steps_of(const SplatCode& code, const Precision& precision);

/// Range of gaps between the two smaller scales. Larger gaps have wider cells, because thin Gaussians look alike.
struct GapCell {
  int lower = 0, width = 1;

  /// Returns the gap that stands for the cell until fine bits refine it.
  [[nodiscard]] int middle() const { return lower + width / 2; }
};
[[nodiscard]] GapCell cell_of_gap(int gap);
/// Return the number of the cell of a gap, and the cell with a number.
[[nodiscard]] int cell_index(int gap);
[[nodiscard]] GapCell gap_cell(int index);

/// Returns the smallest scale that stands for its cell of gaps. Without `leaf`, cells count gaps in steps of two codes.
[[nodiscard]] int thinned(int middle_scale, int least_scale, bool leaf);

/// Numbers of bits that refine the codes of a leaf: its two larger scales, the smallest one, and its opacity.
using FineBits = std::array<int, 4>;
[[nodiscard]] FineBits fine_bits(const SplatCode& code, const Precision& precision);
/// Returns the fine codes of a leaf with the given values. `code` already has the codes of its scales and opacity.
[[nodiscard]] std::array<int, 4> fine_codes(const SplatCode& code, const std::array<double, 3>& scales, double opacity,
                                            const Precision& precision);

/// Standard deviations and opacity of a decoded Gaussian.
struct SplatLook {
  std::array<double, 3> scales;
  double opacity;
};
[[nodiscard]] SplatLook look_of(const SplatNode& node, const Precision& precision);

}  // namespace gs::qnv::gaussians
