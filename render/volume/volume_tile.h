#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace gs::render {

constexpr int kVolumeTile = 32;  // pixels along an edge

/// Where the footprint of a vector ends: exp(-kVolumeCut^2) is a hundredth.
constexpr float kVolumeCut = 2.2f;

/// A vector of a volume in view. Pixels of the viewport: centres of pixels have whole numbers.
struct VolumeSplat {
  float x, y;
  float reach;  // kVolumeCut sqrt(A)
  float alpha;  // in the middle
  float depth;  // along the view axis, > 0
  std::uint32_t color;
};

/// The pixels of one tile, premultiplied. `stop` is the caller's: what lies deeper is hidden.
struct alignas(64) VolumeTile {
  static constexpr std::size_t kPixels = std::size_t{kVolumeTile} * kVolumeTile;
  std::array<float, kPixels> red, green, blue;  // 0..255
  std::array<float, kPixels> clear;             // what is behind shows through with this part
  std::array<float, kPixels> depth;             // 0: nothing here
  std::array<float, kPixels> stop;
};

/// Blends the splats `order`, the first one in front, into the tile whose lower left pixel is (left, bottom). Stops
/// when nothing shows through any more. `tile` leaves the stops aside.
struct VolumeKernel {
  using Tile = void (*)(const VolumeSplat* splats, std::span<const std::uint32_t> order, int left, int bottom,
                        VolumeTile& tile);
  Tile tile, stopped_tile;
};

/// The one for this processor, and the one for every processor: both give the same bits.
[[nodiscard]] const VolumeKernel& volume_kernel();
[[nodiscard]] const VolumeKernel& volume_kernel_baseline();

}  // namespace gs::render
