#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace gs::qnv::values {

/// Factors of the four lifting steps of CDF 9/7 (Daubechies and Sweldens 1998), in 1/16384.
inline constexpr std::array<std::int32_t, 4> kLiftFactors{-25987, -868, 14465, 7266};

/// Adds round(factor (a[i] + b[i]) / 16384) to target[i], or subtracts it, for `count` samples. Arithmetic wraps at 32
/// bits. `a` and `b` may overlap each other. All versions give the same bits.
void lift(std::int32_t* target, const std::int32_t* a, const std::int32_t* b, std::size_t count, std::size_t step,
          bool undo);

}  // namespace gs::qnv::values
