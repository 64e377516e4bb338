#pragma once

#include "qnv/sampling/volume/gradients.h"
#include "tests/qnv/volume_sources.h"

#include <cmath>
#include <cstdint>
#include <utility>
#include <variant>
#include <vector>

/// Volume for tests.
namespace gs::qnv {

/// Soft ball with a plate inside, on an oblique lattice of n^3 voxels, with the longest quarter of its gradients.
struct SoftBall {
  VolumeSource source;
  Volume geometry;

  explicit SoftBall(std::uint32_t n, double fraction = 0.25) {
    const auto middle = static_cast<float>(n - 1) * 0.5f, radius = static_cast<float>(n) * 0.33f;
    source = test::volume_of(test::oblique(n, n, n), [=](std::uint32_t x, std::uint32_t y, std::uint32_t z) {
      const float dx = static_cast<float>(x) - middle, dy = static_cast<float>(y) - middle,
                  dz = static_cast<float>(z) - middle;
      const float ball = 1 / (1 + std::exp(std::sqrt(dx * dx + dy * dy + dz * dz) - radius));
      return 100 * ball + (z == n / 2 && ball > 0.9f ? 80.0f : 0.0f);
    });
    GradientOptions options;
    options.fraction = fraction;
    auto found = gradient_vectors(source, options);
    geometry = std::move(std::get<Volume>(found));
  }
};

}  // namespace gs::qnv
