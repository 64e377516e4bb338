#pragma once

#include "render/image/image.h"

#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

namespace gs::bench {

/// Error of pictures against their references, combined over all pictures.
struct PictureError {
  double psnr = 0;  // dB, over all components
  double ssim = 0;  // mean over windows of 8 x 8 pixels of the luma (Wang et al. 2004), 4 apart
};

inline double luma(const render::Image& image, std::size_t pixel) {
  const std::uint8_t* c = image.pixels.data() + pixel * image.components;
  return image.components < 3 ? c[0] : 0.299 * c[0] + 0.587 * c[1] + 0.114 * c[2];
}

inline double structural_similarity(const render::Image& a, const render::Image& b) {
  constexpr std::size_t kWindow = 8, kStep = 4;
  constexpr double kC1 = 0.01 * 255 * 0.01 * 255, kC2 = 0.03 * 255 * 0.03 * 255;
  double sum = 0;
  std::size_t windows = 0;
  for (std::size_t y = 0; y + kWindow <= a.height; y += kStep)
    for (std::size_t x = 0; x + kWindow <= a.width; x += kStep) {
      double sa = 0, sb = 0, saa = 0, sbb = 0, sab = 0;
      for (std::size_t v = y; v < y + kWindow; ++v)
        for (std::size_t u = x; u < x + kWindow; ++u) {
          const double la = luma(a, v * a.width + u), lb = luma(b, v * b.width + u);
          sa += la;
          sb += lb;
          saa += la * la;
          sbb += lb * lb;
          sab += la * lb;
        }
      constexpr double kCount = kWindow * kWindow;
      // Windows with only background are skipped.
      if (saa == 0 && sbb == 0) continue;
      const double ma = sa / kCount, mb = sb / kCount;
      const double va = saa / kCount - ma * ma, vb = sbb / kCount - mb * mb, cov = sab / kCount - ma * mb;
      sum += (2 * ma * mb + kC1) * (2 * cov + kC2) / ((ma * ma + mb * mb + kC1) * (va + vb + kC2));
      ++windows;
    }
  return windows == 0 ? 1 : sum / static_cast<double>(windows);
}

inline PictureError picture_error(std::span<const render::Image> pictures, std::span<const render::Image> references) {
  double squares = 0, ssim = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    for (std::size_t k = 0; k < pictures[i].pixels.size(); ++k) {
      const double d = static_cast<double>(pictures[i].pixels[k]) - references[i].pixels[k];
      squares += d * d;
    }
    count += pictures[i].pixels.size();
    ssim += structural_similarity(pictures[i], references[i]);
  }
  return {10 * std::log10(255.0 * 255.0 * static_cast<double>(count) / std::max(squares, 1e-9)),
          ssim / static_cast<double>(pictures.size())};
}

}  // namespace gs::bench
