#pragma once

#include <cstddef>
#include <cstdio>

namespace gs::bench {

/// Prints a Markdown table: a row per budget, and the PSNR and SSIM of each codec's picture. A curve maps budgets to
/// measurements with an `error`.
template <class Codecs, class Budgets, class Curves>
void print_curve_table(const Codecs& codecs, const Budgets& budgets, const Curves& curves) {
  std::printf("| budget, bytes |");
  for (const char* codec : codecs) std::printf(" %s |", codec);
  std::printf("\n|---:|");
  for (std::size_t i = 0; i < codecs.size(); ++i) std::printf("---:|");
  std::printf("\n");
  for (const std::size_t budget : budgets) {
    std::printf("| %zu |", budget);
    for (const auto& curve : curves) {
      const auto found = curve.find(budget);
      if (found == curve.end())
        std::printf(" - |");
      else
        std::printf(" %.1f / %.3f |", found->second.error.psnr, found->second.error.ssim);
    }
    std::printf("\n");
  }
}

}  // namespace gs::bench
