#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace gs::render {

/// View of the splats of one item.
struct GaussianLens {
  std::array<std::array<float, 3>, 4> camera_from_node;  // columns
  float pixels_x, pixels_y;                              // pixels per unit of length at depth 1
  float middle_x, middle_y;                              // pixel position of the optical axis
  float left, right, bottom, top;                        // bounds of the tangents where the projection is linearised
  float last_x, last_y;                                  // last pixels of the view
  float near_plane;
  bool antialiased;  // see qnv::Gaussians
};

/// Eight splats and their ellipses in the picture.
struct alignas(32) EightGaussians {
  static constexpr std::size_t kLanes = 8;
  using Numbers = std::array<float, kLanes>;
  Numbers position_x, position_y, position_z, scale_x, scale_y, scale_z;  // input, as in qnv::Gaussians
  Numbers rotation_x, rotation_y, rotation_z, rotation_w, opacity;        // input
  Numbers seen_x, seen_y, seen_z, distance;  // centre in camera space, and its squared distance from the eye
  Numbers x, y, xx, xy, yy, peak;            // as in GaussianSplat
  Numbers left, right, bottom, top;          // as in GaussianSplat
  std::uint32_t placed = 0;                  // bit per splat: beyond the near plane and not too faint
  std::uint32_t visible = 0;                 // bit per splat: its ellipse is in view
};

/// Projects eight splats by EWA (see project_gaussians). Accepts any numbers.
using GaussianEllipses = void (*)(const GaussianLens& lens, EightGaussians& eight);

/// Returns the fastest function for this CPU.
[[nodiscard]] GaussianEllipses gaussian_ellipses();
/// Returns the portable function. Its results are identical to those of `gaussian_ellipses`, bit for bit.
[[nodiscard]] GaussianEllipses gaussian_ellipses_baseline();

}  // namespace gs::render
