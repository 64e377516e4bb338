#pragma once

#include "qnv/base/geometry.h"
#include "qnv/codecs/gaussians/splat_code.h"
#include "qnv/codecs/gaussians/splat_models.h"
#include "qnv/codecs/gaussians/splat_steps.h"

#include <array>
#include <cstddef>
#include <cstdint>

namespace gs::qnv::gaussians {

/// Models of the harmonics in one chunk.
struct HarmonicModels {
  BitModel any;
  std::array<std::array<SignedModel<8>, 3>, 3> coefficients;  // by degree and component
  std::array<std::array<TypicalSize, 3>, 15> sizes;           // by coefficient and component
};

/// Codes the coefficients of a Gaussian, each as luma and two differences. A Reader stores the result in `codes`.
/// Returns false if all are 0.
template <class Coder>
bool code_harmonics(Coder& coder, HarmonicModels& models, int degree,
                    std::array<std::array<int, 3>, harmonic_count(Gaussians::kMaxDegree)>& codes) {
  const std::size_t count = harmonic_count(degree);
  bool any = false;
  if constexpr (Coder::kWrites)
    for (std::size_t i = 0; i < count; ++i) any = any || codes[i] != std::array<int, 3>{};
  any = coder.bit(models.any, any);
  if (!any) codes = {};
  for (std::size_t i = 0; any && i < count; ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      TypicalSize& size = models.sizes[i][k];
      const std::size_t band = i < 3 ? 0 : i < 8 ? 1 : 2;
      const int value = models.coefficients[band][k].code(coder, size.size(), codes[i][k]);
      codes[i][k] = std::clamp(value, -kMostColor, kMostColor);
      size.learn(codes[i][k]);
    }
  return any;
}

/// Returns the step of the coefficients of a Gaussian.
[[nodiscard]] inline double harmonic_step(const SplatNode& node, const Precision& precision) {
  SplatCode code;
  code.leaf = node.leaf;
  for (std::size_t k = 0; k < 3; ++k) code.scales[k] = node.scales[k];
  code.opacity = node.opacity;
  return harmonic_factor(precision) * steps_of(code, precision).color;
}

}  // namespace gs::qnv::gaussians
