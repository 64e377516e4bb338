#pragma once

#include "qnv/codecs/gaussians/splat_code.h"

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace gs::qnv::gaussians {

/// 2^(i/8)
inline constexpr std::array<double, 8> kEighths = {1,
                                                   1.0905077326652577,
                                                   1.189207115002721,
                                                   1.2968395546510096,
                                                   1.4142135623730951,
                                                   1.5422108254079407,
                                                   1.681792830507429,
                                                   1.8340080864093424};

/// Returns 2^(eighths/8), for results that are normal numbers.
constexpr double power_of(int eighths) {
  constexpr int kShift = 100;  // octaves, so that the division rounds down
  const int octave = (eighths + kShift * kScaleSteps) / kScaleSteps - kShift;
  const auto place = static_cast<std::size_t>(eighths - octave * kScaleSteps);
  // 2^octave: the exponent of a double has an offset of 1023 and follows 52 bits.
  return kEighths[place] * std::bit_cast<double>(static_cast<std::uint64_t>(1023 + octave) << 52);
}

}  // namespace gs::qnv::gaussians
