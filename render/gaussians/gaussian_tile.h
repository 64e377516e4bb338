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
struct alignas(64) GaussianSplat {
  float x, y;
  float xx, xy, yy;
  float peak;                      // logarithm of the opacity to the base 2, at most 0
  float left, right, bottom, top;  // box of the pixels with an opacity of at least kGaussianLeastAlpha
  float red, green, blue;          // 0 is black, 1 is white
  float depth;                     // along the view axis, > 0
  float least_depth;               // minimum depth of this splat and of all later ones
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

/// Block of 4 x 4 pixels, premultiplied: two groups of 4 x 2 pixels, each with eight adjacent lanes. Lane 2 x + y of a
/// group is the pixel in column x and row y of the group.
struct alignas(64) GaussianBlock {
  static constexpr std::size_t kLanes = 16, kGroupLanes = 8;
  enum Channel : std::uint8_t {
    kRed,  // colours: 0..1 and above
    kGreen,
    kBlue,
    kClear,        // transmittance so far, 1 to 0
    kDepth,        // depth of the last splat that more than half of the light reaches
    kStop,         // depth behind which splats are hidden
    kColumn,       // pixel columns in the tile
    kChannels = 8  // one is unused, so that the kernel finds a block by a shift
  };
  std::array<float, kLanes * kChannels> values;

  [[nodiscard]] std::span<float, kLanes> channel(Channel which) {
    return std::span<float, kLanes>(values.data() + kLanes * which, kLanes);
  }
  [[nodiscard]] std::span<const float, kLanes> channel(Channel which) const {
    return std::span<const float, kLanes>(values.data() + kLanes * which, kLanes);
  }
};

/// Pixels of one tile. Groups are in columns: group 8 c + r has the lower left pixel (4 c, 2 r). Block b has the groups
/// 2 b and 2 b + 1.
struct alignas(64) GaussianTile {
  static constexpr std::size_t kGroups = 32, kBlocks = 16;
  static constexpr std::uint64_t kAllGroups = 0x5555555555555555u;
  std::array<GaussianBlock, kBlocks> blocks;
  std::uint64_t open = kAllGroups;  // groups in which more splats can be visible: bit 2 i is group i
  bool with_depths = true;          // if false, the depths of groups are undefined, except those of surfels

  void clear_pixels();

  [[nodiscard]] static constexpr std::size_t block_of(int x, int y) {
    return static_cast<std::size_t>(x / 4 * 4 + y / 4);
  }
  [[nodiscard]] static constexpr std::size_t lane_of(int x, int y) {
    return static_cast<std::size_t>(y % 4 / 2 * 8 + x % 4 * 2 + y % 2);
  }
  /// Returns the first lane of a group in the first channel of its block.
  [[nodiscard]] float* group(std::size_t number) {
    return blocks.data()[number / 2].values.data() + GaussianBlock::kGroupLanes * (number % 2);
  }
  [[nodiscard]] const float* group(std::size_t number) const {
    return blocks.data()[number / 2].values.data() + GaussianBlock::kGroupLanes * (number % 2);
  }
};

/// Splats of a picture.
struct GaussianSplats {
  const GaussianSplat* splats = nullptr;
  const GaussianSurfel* surfels = nullptr;
};

/// Functions for tiles, for one instruction set.
struct GaussianKernel {
  /// Blends the splats with the indices `order`, front to back, into a tile. (left, bottom) is the lower left pixel of
  /// the tile. Further calls may add more distant splats. Ends when no further splat can be visible. `stopped_tile`
  /// applies the stops, `tile` ignores them.
  using Tile = void (*)(const GaussianSplats& all, std::span<const std::uint16_t> order, int left, int bottom,
                        GaussianTile& tile);
  /// Writes the pixels of a tile as bytes R, G, B, A, and the depths at which half of the light is absorbed (0 if less
  /// is absorbed). If `depths` is null, writes no depths. `pitch` is the number of pixels from one row to the next.
  using Write = void (*)(const GaussianTile& tile, std::uint8_t* pixels, float* depths, std::size_t pitch);
  Tile tile, stopped_tile;
  Write write;
};

/// Returns the fastest kernel for this CPU.
[[nodiscard]] const GaussianKernel& gaussian_kernel();
/// Returns all kernels that this CPU can run, from the portable one to the fastest. Their results are identical, bit
/// for bit.
[[nodiscard]] std::span<const GaussianKernel> gaussian_kernels();

}  // namespace gs::render
