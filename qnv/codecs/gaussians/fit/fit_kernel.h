#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace gs::qnv::gaussians {

inline constexpr int kFitTile = 16;  // pixels along the side of a tile

/// Gaussian in a picture. Units are pixels, with pixel centres at integers. The opacity at (dx, dy) from the centre is
/// 2^(peak - (xx dx^2 + 2 xy dx dy + yy dy^2)).
struct FitSplat {
  float x = 0, y = 0;
  float xx = 0, xy = 0, yy = 0;
  float peak = 0;                                  // logarithm of the opacity to the base 2, at most 0
  float left = 0, right = 0, bottom = 0, top = 0;  // box of the visible pixels
  float red = 0, green = 0, blue = 0;
};

/// Gradient of half the squared error by one Gaussian in one tile, as sums over pixels. `a` is opacity x derivative by
/// opacity. `ax` to `ayy` have the additional factors dx and dy.
struct FitSums {
  float a = 0, ax = 0, ay = 0, axx = 0, axy = 0, ayy = 0;
  float red = 0, green = 0, blue = 0;
};

/// Pixels of one tile, in rows.
struct alignas(32) FitTile {
  using Channel = std::array<float, std::size_t{kFitTile} * kFitTile>;
  Channel red, green, blue, clear;  // premultiplied colours, transmittance
  // Derivatives of the error by the colours. `total` is the sum of their products with all visible colours. `sum` has
  // the products of the Gaussians so far.
  Channel by_red, by_green, by_blue, total, sum;
};

/// Functions for tiles, for one instruction set.
struct FitKernel {
  /// Blends Gaussians, front to back, into a tile. (left, bottom) is its lower left pixel. Stops if the tile is opaque.
  /// Returns the number of blended Gaussians.
  std::size_t (*blend)(std::span<const FitSplat> all, std::span<const std::uint32_t> order, float left, float bottom,
                       FitTile& tile);
  /// Computes the gradients by the blended Gaussians. `clear` must be 1 and `sum` 0 at the beginning.
  void (*differentiate)(std::span<const FitSplat> all, std::span<const std::uint32_t> order, float left, float bottom,
                        FitTile& tile, std::span<FitSums> sums);
};

/// Returns the fastest kernel for this CPU.
[[nodiscard]] const FitKernel& fit_kernel();
/// Returns the portable kernel. Its results are identical to those of fit_kernel(), bit for bit.
[[nodiscard]] const FitKernel& fit_kernel_baseline();

}  // namespace gs::qnv::gaussians
