#pragma once

#include "qnv/codecs/values/block_places.h"

#include <cstdint>
#include <cstring>

namespace gs::qnv::values {

// Coefficients as signed integers, and as magnitudes with their sign in the highest bit. Four at a time.

using FourSigned = std::int32_t __attribute__((vector_size(16)));
using FourUnsigned = std::uint32_t __attribute__((vector_size(16)));
using TwoDoubles = double __attribute__((vector_size(16)));

/// Returns how far the middle of the possible values of a magnitude is above it, if planes `lowest` and above are
/// known. Small values are more frequent.
inline std::uint32_t middle_above(int lowest) {
  return lowest == 0 ? 0 : static_cast<std::uint32_t>((std::uint64_t{3} << lowest) >> 3);
}

/// Makes magnitudes with signs of `count` <= 4 integers.
inline void load_line(const std::int32_t* from, std::uint32_t count, std::uint32_t* to) {
  constexpr std::uint32_t kHighest = std::uint32_t{1} << 31;
  if (count == kCubeEdge) {
    FourSigned value;
    std::memcpy(&value, from, sizeof value);
    const FourSigned minus = value >> 31;
    const FourUnsigned size = FourUnsigned((value ^ minus) - minus) & ~kHighest;
    const FourUnsigned result = size | (FourUnsigned(value) & kHighest);
    std::memcpy(to, &result, sizeof result);
    return;
  }
  for (std::uint32_t x = 0; x < count; ++x) {
    const auto value = static_cast<std::uint32_t>(from[x]), minus = static_cast<std::uint32_t>(from[x] >> 31);
    to[x] = (((value ^ minus) - minus) & ~kHighest) | (value & kHighest);
  }
}

/// Adds integers for `count` <= 4 magnitudes with signs to `to`. `middle` is added to magnitudes that are not 0.
inline void add_line(const std::uint32_t* from, std::uint32_t count, std::uint32_t middle, std::int32_t* to) {
  constexpr std::uint32_t kHighest = std::uint32_t{1} << 31;
  if (count == kCubeEdge) {
    FourUnsigned value;
    std::memcpy(&value, from, sizeof value);
    const FourUnsigned size = value & ~kHighest, minus = FourUnsigned(FourSigned(value) >> 31);
    const FourUnsigned known = size + (FourUnsigned(size != 0) & middle);
    FourUnsigned result;
    std::memcpy(&result, to, sizeof result);
    result += (known ^ minus) - minus;
    std::memcpy(to, &result, sizeof result);
    return;
  }
  for (std::uint32_t x = 0; x < count; ++x) {
    const std::uint32_t size = from[x] & ~kHighest, known = size + (size != 0 ? middle : 0);
    to[x] =
        static_cast<std::int32_t>(static_cast<std::uint32_t>(to[x]) + ((from[x] & kHighest) != 0 ? 0u - known : known));
  }
}

/// Returns the sum of the squared errors of a cube of which planes `plane` and above are known. The order of the
/// additions is fixed, so that all machines give the same bits.
inline double squared_error(const std::uint32_t* values, int plane) {
  const std::uint32_t rest = (std::uint32_t{1} << plane) - 1, middle = middle_above(plane);
  TwoDoubles sums[2] = {{0, 0}, {0, 0}};
  for (std::uint32_t k = 0; k < kCubeSize; k += kCubeEdge) {
    FourUnsigned value;
    std::memcpy(&value, values + k, sizeof value);
    value &= ~(std::uint32_t{1} << 31);
    const FourUnsigned known = value & ~rest;
    const FourSigned error = FourSigned((value & rest) - (FourUnsigned(known != 0) & middle));
    for (int half = 0; half < 2; ++half) {
      const TwoDoubles two{static_cast<double>(error[2 * half]), static_cast<double>(error[2 * half + 1])};
      sums[half] += two * two;
    }
  }
  const TwoDoubles sum = sums[0] + sums[1];
  return sum[0] + sum[1];
}

}  // namespace gs::qnv::values
