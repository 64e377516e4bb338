#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace gs::render {

constexpr int kVolumeTile = 32;  // pixels along the side of a tile

/// Radius of a footprint in units of sqrt(A). exp(-kVolumeCut^2) is a hundredth.
constexpr float kVolumeCut = 2.2f;

/// Splat of a volume vector that is in view. Units are viewport pixels, with pixel centres at integers.
struct VolumeSplat {
  float x, y;
  float reach;  // radius: kVolumeCut sqrt(A)
  float alpha;  // opacity at the centre
  float depth;  // depth along the view axis, > 0
  std::uint32_t color;
};

/// Pixels of one tile, premultiplied. The caller sets the depths `stop`, behind which vectors are hidden.
struct alignas(64) VolumeTile {
  static constexpr std::size_t kPixels = std::size_t{kVolumeTile} * kVolumeTile;
  std::array<float, kPixels> red, green, blue;  // 0..255
  std::array<float, kPixels> clear;  // transmittance so far, 1 to 0
  std::array<float, kPixels> depth;  // 0 means that the pixel is empty
  std::array<float, kPixels> stop;
};

/// Functions that blend the splats with indexes `order`, front to back, into a tile. (left, bottom) is the lower left
/// pixel of the tile. The functions stop when the tile is opaque. `tile` ignores the stops; `stopped_tile` applies
/// them.
struct VolumeKernel {
  using Tile = void (*)(const VolumeSplat* splats, std::span<const std::uint32_t> order, int left, int bottom,
                        VolumeTile& tile);
  Tile tile, stopped_tile;
};

/// Returns the fastest kernel for this CPU.
[[nodiscard]] const VolumeKernel& volume_kernel();
/// Returns the portable kernel. Its results are identical to those of `volume_kernel`, bit for bit.
[[nodiscard]] const VolumeKernel& volume_kernel_baseline();

}  // namespace gs::render
