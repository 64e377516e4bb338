#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace gs::render {

constexpr int kGaussianTile = 16;  // pixels along the side of a tile

/// Opacity below which a splat ends (3DGS), and its logarithm to the base 2.
constexpr float kGaussianLeastAlpha = 1 / 255.0f, kGaussianLeastPower = -7.994353f;
/// Maximum opacity of one splat (3DGS).
constexpr float kGaussianMostAlpha = 0.99f;

/// Gaussian splat in a picture. Units are viewport pixels, with pixel centres at integers. The opacity at (dx, dy) from
/// the centre is 2^(peak - (xx dx^2 + 2 xy dx dy + yy dy^2)).
struct GaussianSplat {
  float x, y;
  float xx, xy, yy;
  float peak;              // logarithm of the opacity to the base 2, at most 0
  float reach_x, reach_y;  // half extents of the ellipse at which the opacity is kGaussianLeastAlpha
  float red, green, blue;  // 0 is black, 1 is white
  float depth;             // along the view axis, > 0
  float least_depth;       // of this splat and of all that are blended after it
  /// Index of the surfel that defines the opacity instead of xx, xy and yy; -1 if the splat is not a surfel.
  std::int32_t surfel = -1;
};

/// Flat Gaussian (2DGS) in a picture. The ray through the pixel at (dx, dy) from the centre meets its plane at u = a /
/// c and v = b / c, in standard deviations, with a = a[0] dx + a[1] dy + a[2]; b and c are linear functions, too. The
/// opacity is 2^peak e^(-s / 2), where s is the smaller of u^2 + v^2 and kSurfelScreen (dx^2 + dy^2).
struct GaussianSurfel {
  std::array<float, 3> a, b, c;
};
/// Low-pass of surfels (2DGS): even edge-on, a surfel has a variance of at least 1 / kSurfelScreen pixels^2.
constexpr float kSurfelScreen = 2;

/// Pixels of one tile, premultiplied.
struct alignas(64) GaussianTile {
  static constexpr std::size_t kPixels = std::size_t{kGaussianTile} * kGaussianTile;
  std::array<float, kPixels> red, green, blue;  // 0..1 and above
  std::array<float, kPixels> clear;             // transmittance so far, 1 to 0
  std::array<float, kPixels> depth;             // at which half of the light is absorbed; 0 means none
  std::array<float, kPixels> stop;              // depth behind which splats are hidden
  std::uint32_t open = 0xffff;                  // rows in which more splats can be visible, one bit each

  void clear_pixels();
};

/// Splats of a picture.
struct GaussianSplats {
  const GaussianSplat* splats = nullptr;
  const GaussianSurfel* surfels = nullptr;
};

/// Blends the splats with indexes `order`, front to back, into a tile. (left, bottom) is the lower left pixel of the
/// tile. May be called again with splats farther away. Stops when no splat can be visible. `stopped_tile` applies the
/// stops, `tile` ignores them.
struct GaussianKernel {
  using Tile = void (*)(const GaussianSplats& all, std::span<const std::uint32_t> order, int left, int bottom,
                        GaussianTile& tile);
  Tile tile, stopped_tile;
};

/// Returns the fastest kernel for this CPU.
[[nodiscard]] const GaussianKernel& gaussian_kernel();
/// Returns the portable kernel. Its results are identical to those of `gaussian_kernel`, bit for bit.
[[nodiscard]] const GaussianKernel& gaussian_kernel_baseline();

}  // namespace gs::render
