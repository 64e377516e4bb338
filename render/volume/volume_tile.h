#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace gs::render {

constexpr int kVolumeTile = 32;  // pixels per edge

/// End of a vector's footprint: exp(-kVolumeCut^2) is a hundredth.
constexpr float kVolumeCut = 2.2f;

/// Vector of a volume in view, in viewport pixels; pixel centres are at integers.
struct VolumeSplat {
  float x, y;
  float reach;  // kVolumeCut sqrt(A)
  float alpha;  // at the centre
  float depth;  // along the view axis, > 0
  std::uint32_t color;
};

/// Pixels of one tile, premultiplied. The caller sets `stop`, beyond which vectors are hidden.
struct alignas(64) VolumeTile {
  static constexpr std::size_t kPixels = std::size_t{kVolumeTile} * kVolumeTile;
  std::array<float, kPixels> red, green, blue;  // 0..255
  std::array<float, kPixels> clear;             // transmittance
  std::array<float, kPixels> depth;             // 0 means empty
  std::array<float, kPixels> stop;
};

/// Blends the splats `order`, front to back, into the tile with lower left pixel (left, bottom). Stops once the tile is
/// opaque. `tile` ignores the stops; `stopped_tile` applies them.
struct VolumeKernel {
  using Tile = void (*)(const VolumeSplat* splats, std::span<const std::uint32_t> order, int left, int bottom,
                        VolumeTile& tile);
  Tile tile, stopped_tile;
};

/// Return the kernel for this CPU, and the portable one; both give the same bits.
[[nodiscard]] const VolumeKernel& volume_kernel();
[[nodiscard]] const VolumeKernel& volume_kernel_baseline();

}  // namespace gs::render
