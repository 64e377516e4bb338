#pragma once

#include "qnv/codecs/gaussians/fit/fit_kernel.h"

#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gs::qnv::gaussians {

/// Gaussian in space.
struct FitGaussian {
  glm::vec3 mean{0};
  std::array<float, 6> covariance{};  // xx, xy, xz, yy, yz, zz
  float opacity = 0;                  // 0 to 1
  glm::vec3 color{0};
};

/// Gradient of half the squared error of a picture by a Gaussian. All numbers are 0 for invisible Gaussians.
struct FitGradient {
  glm::vec3 mean{0};
  std::array<float, 6> covariance{};  // as a symmetric matrix
  float opacity = 0;                  // by the logarithm of the opacity
  glm::vec3 color{0};
  bool visible = false;
};

/// Perspective camera of square pictures.
struct FitCamera {
  glm::vec3 eye{0}, right{1, 0, 0}, up{0, 1, 0}, ahead{0, 0, 1};  // orthonormal axes
  float tangent = 1;                                              // of half the angle of view
  float near_plane = 0;
};

/// Picture with four numbers per pixel: red, green, blue over black, and transmittance.
using FitPixels = std::vector<std::array<float, 4>>;

/// Blur of Gaussians in a picture, in pixels^2.
struct FitBlur {
  float bright = 0.3f;  // makes small Gaussians brighter, as in the pictures of viewers (3DGS)
  float even = 0;       // keeps the sum of the opacity
};

/// Painter of small pictures of Gaussians by EWA splatting, as in viewers. Also computes gradients of errors. Gives
/// equal bits for any number of threads.
class FitPainter {
 public:
  /// Constructs a painter of `side` x `side` pixels, a multiple of kFitTile.
  FitPainter(int side, FitBlur blur, unsigned threads) : side_(side), blur_(blur), threads_(threads) {}

  void paint(std::span<const FitGaussian> gaussians, const FitCamera& camera, FitPixels& pixels);
  /// Computes the gradient of half the squared error against a picture, for backgrounds of any colour. Returns the
  /// squared error.
  double differentiate(std::span<const FitGaussian> gaussians, const FitCamera& camera, const FitPixels& target,
                       std::vector<FitGradient>& gradient);

 private:
  /// Intermediate values of a visible Gaussian, for its gradient.
  struct Seen {
    std::uint32_t index = 0;
    glm::vec3 across{0}, along{0};  // derivatives of the pixel by the position
    glm::vec3 inverse{0};           // xx, xy, yy of the inverse of the covariance in the picture
    glm::vec3 sharp{0};             // the inverse without FitBlur::even
  };
  /// Visible Gaussians of a range.
  struct Found {
    std::vector<FitSplat> splats;
    std::vector<Seen> seen;
    std::vector<float> distances;
  };

  void project(std::span<const FitGaussian> gaussians, const FitCamera& camera);
  /// Projects a Gaussian. Returns false if it is not in view.
  bool project(const FitGaussian& one, const FitCamera& camera, FitSplat& splat, Seen& seen) const;
  void fill_tiles();
  /// First and last tiles that a splat touches.
  struct TileBox {
    std::uint32_t left, right, bottom, top;
  };
  [[nodiscard]] TileBox box_of(const FitSplat& splat) const;
  /// Calls each(tile) for the tiles of a box.
  template <class Each>
  void for_tiles(const TileBox& box, const Each& each) const;
  /// Blends a tile. Returns the number of blended Gaussians.
  std::size_t blend(std::size_t tile, FitTile& pixels) const;
  /// Writes derivatives of the error to a blended tile. Returns the squared error.
  double compare(std::size_t tile, FitTile& pixels, const FitPixels& target) const;
  void gather(std::vector<FitGradient>& gradient) const;

  [[nodiscard]] std::size_t across() const { return static_cast<std::size_t>(side_ / kFitTile); }
  [[nodiscard]] std::size_t tiles() const { return across() * across(); }
  [[nodiscard]] float left_of(std::size_t tile) const { return static_cast<float>(tile % across() * kFitTile); }
  [[nodiscard]] float bottom_of(std::size_t tile) const { return static_cast<float>(tile / across() * kFitTile); }
  /// Returns the index in a picture of pixel `k` of a tile.
  [[nodiscard]] std::size_t pixel_of(std::size_t tile, std::size_t k) const {
    return (tile / across() * kFitTile + k / kFitTile) * static_cast<std::size_t>(side_) + tile % across() * kFitTile +
           k % kFitTile;
  }
  [[nodiscard]] std::span<const std::uint32_t> order_of(std::size_t tile) const {
    return std::span(order_).subspan(first_[tile], first_[tile + 1] - first_[tile]);
  }

  int side_;
  FitBlur blur_;
  unsigned threads_;
  std::vector<Found> found_;
  std::vector<FitSplat> splats_;  // visible Gaussians, nearest first
  std::vector<Seen> seen_;
  std::vector<TileBox> boxes_;
  std::vector<std::uint32_t> order_;  // Gaussians of the tiles, nearest first
  std::vector<std::size_t> first_;    // first place in order_, by tile
  std::vector<FitSums> sums_;         // by place in order_
};

}  // namespace gs::qnv::gaussians
