#pragma once

#include "base/box.h"
#include "qnv/container/gaussian_coding.h"

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace gs::qnv::gaussians {

// Gaussians as integers. FORMAT.md, "Gaussians payload", defines them. All arithmetic that decides decoded bits uses
// double precision with +, -, *, / and square roots only, so that all machines decode the same.

/// Steps of standard deviations in an octave; the smallest one is 2^kLeastOctave.
inline constexpr int kScaleSteps = 8, kLeastOctave = -40, kMostScale = GaussianCoding::kMostScale;
/// Highest code of an opacity, which means 1. The code 0 is not used.
inline constexpr int kMostOpacity = 63;
/// Limits of codes in a stream.
inline constexpr std::int32_t kMostPlace = 1 << 24, kMostColor = 1 << 14, kMostTurn = 255, kMostTunedTurn = 2047;

/// Properties of a stream that decide the steps.
struct Precision {
  int important = 0;  // importance() of the Gaussians with the finest steps
  int finest = 0;     // scale below which details count as points
  int steps = 0;      // log2 of a factor of all steps, in eighths
  Box box;            // of all positions
  GaussianCoding::Version version = GaussianCoding::Version::plain;
  int fine = 0;  // as GaussianCoding::fine

  [[nodiscard]] bool trained() const { return version != GaussianCoding::Version::plain; }
  [[nodiscard]] bool tuned() const { return version == GaussianCoding::Version::tuned; }
};

/// Decoded Gaussian of a cluster.
struct SplatNode {
  glm::vec3 position{0};  // relative to the origin of the stream
  glm::vec4 rotation{0, 0, 0, 1};
  std::array<std::int16_t, 3> scales{};  // largest first
  std::uint8_t opacity = 0;
  bool leaf = false;                   // final; else children replace it
  std::array<std::uint8_t, 4> fine{};  // of a leaf: places of the scales and the opacity in their steps
  glm::vec3 color{0};
};

/// Differences of a Gaussian from its parent, as coded.
struct SplatCode {
  bool leaf = false;
  std::array<int, 3> scales{};  // as in SplatNode
  int opacity = 0;
  std::array<int, 4> fine{};  // as in SplatNode
  std::array<int, 3> turn{}, place{}, color{};
};

/// Rotation matrix by columns.
using SplatAxes = std::array<std::array<double, 3>, 3>;

/// Axes and standard deviations of a parent Gaussian.
struct SplatFrame {
  SplatAxes axes;
  std::array<double, 3> scales;
};

/// Steps of the codes of a Gaussian (splat_steps.h).
struct SplatSteps {
  std::array<double, 3> place, turn;
  double color = 0;
};

/// Values of a Gaussian that follow from its scales, opacity and turn.
struct SplatShape {
  SplatSteps steps;
  glm::vec4 rotation;
  SplatAxes axes;
};

[[nodiscard]] double scale_of(int code);
[[nodiscard]] double opacity_of(int code);
/// Returns the code with the nearest value.
[[nodiscard]] int scale_code(double scale);
[[nodiscard]] int opacity_code(double opacity);
/// Returns the rotation matrix of a unit quaternion x, y, z, w.
[[nodiscard]] SplatAxes axes_of(const glm::vec4& q);
[[nodiscard]] SplatFrame frame_of(const SplatNode& parent);
/// Returns the rotation of a child from that of its parent.
[[nodiscard]] glm::vec4 turned(const glm::vec4& parent, const std::array<int, 3>& turn,
                               const std::array<double, 3>& steps);
/// Returns the expected standard deviations of positions along the axes of a Gaussian, in steps. Assumes that siblings
/// spread like the parent.
[[nodiscard]] std::array<double, 3> place_spread(const SplatFrame& parent, const SplatAxes& axes,
                                                 const SplatSteps& steps);
/// Returns the difference of a colour from its code: luma, red against blue, green against both (YCoCg).
[[nodiscard]] glm::dvec3 rgb_of(const std::array<int, 3>& code, double step);
[[nodiscard]] std::array<int, 3> color_code(const glm::dvec3& rgb, double step);
/// Returns the decoded Gaussian. `shape` follows from the scales, the opacity and the turn of `code`.
[[nodiscard]] SplatNode node_of(const SplatNode& parent, const SplatCode& code, const SplatShape& shape,
                                const Precision& precision);

}  // namespace gs::qnv::gaussians
