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
};

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

/// Blends the splats with indexes `order`, front to back, into a tile. (left, bottom) is the lower left pixel of the
/// tile. May be called again with splats farther away. Stops when no splat can be visible. `stopped_tile` applies the
/// stops, `tile` ignores them.
struct GaussianKernel {
  using Tile = void (*)(const GaussianSplat* splats, std::span<const std::uint32_t> order, int left, int bottom,
                        GaussianTile& tile);
  Tile tile, stopped_tile;
};

/// Returns the fastest kernel for this CPU.
[[nodiscard]] const GaussianKernel& gaussian_kernel();
/// Returns the portable kernel. Its results are identical to those of `gaussian_kernel`, bit for bit.
[[nodiscard]] const GaussianKernel& gaussian_kernel_baseline();

}  // namespace gs::render
