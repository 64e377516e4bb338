#pragma once

#include "base/parallel.h"
#include "qnv/codecs/gaussians/fit/fit_painter.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gs::qnv::gaussians {

/// Pictures of the leaves of a tree. They are the targets of the fit.
class FitViews {
 public:
  /// Paints at least one Gaussian from around the scene, and a room also from free positions inside. Leaves cameras()
  /// empty if it is cancelled. Pictures have enough pixels to fit `most` Gaussians. `antialiased` has the meaning of
  /// Gaussians::antialiased.
  FitViews(std::span<const FitGaussian> leaves, std::size_t most, bool antialiased, unsigned threads,
           Progress* progress);

  [[nodiscard]] std::span<const FitCamera> cameras() const { return cameras_; }
  [[nodiscard]] int side() const { return side_; }
  /// Returns the blur of a picture with one pixel per `factor` x `factor` pixels.
  [[nodiscard]] FitBlur blur(int factor) const;
  /// Returns a picture with one pixel per `factor` x `factor` pixels. Omits the border if `side` times `factor` is less
  /// than side().
  [[nodiscard]] FitPixels reduced(std::size_t view, int side, int factor) const;

 private:
  int side_;
  std::vector<FitCamera> cameras_;
  std::vector<std::vector<std::array<std::uint8_t, 4>>> pictures_;
  bool antialiased_;
};

}  // namespace gs::qnv::gaussians
