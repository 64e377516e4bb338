#pragma once

#include "vrml/syntax/numbers/number.h"

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

/// Code paths of parse_floats and parse_integers, public only for these functions and their tests. Both paths give the
/// same NumberRun and the same numbers for the same text.
namespace gs::vrml::number_paths {

/// Reads floats byte by byte, on any processor. The next function does the same for integers.
[[nodiscard]] NumberRun floats_portable(const char* begin, const char* end, float* out, std::size_t capacity);
[[nodiscard]] NumberRun integers_portable(const char* begin, const char* end, std::int32_t* out, std::size_t capacity);

/// Reports whether the processor supports the AVX2 path.
[[nodiscard]] bool has_avx2();

/// Reads eight floats at a time with AVX2. Requires has_avx2(). Never writes at or after out[capacity], but may write
/// invalid elements after the last number. The next function does the same for integers.
[[nodiscard]] NumberRun floats_avx2(const char* begin, const char* end, float* out, std::size_t capacity);
[[nodiscard]] NumberRun integers_avx2(const char* begin, const char* end, std::int32_t* out, std::size_t capacity);

/// Returns the last byte before `end` that cannot be part of a number. A loop over a number that starts before this
/// byte needs no other bound. Returns null if the last 128 bytes contain no such byte; the slow path then handles the
/// text.
[[nodiscard]] const char* find_guard(const char* begin, const char* end);

/// Reads the number at `p`, and moves `p` after it. A byte that cannot be part of a number must follow. Returns false
/// and does not move `p` if the text is not for bulk reads.
[[nodiscard]] bool read_number(const char*& p, float& value);
[[nodiscard]] bool read_number(const char*& p, std::int32_t& value);

/// Continues `run` byte by byte until it has `target` numbers or reaches `guard`, or until other text follows.
void read_plain(NumberRun& run, const char* guard, float* out, std::size_t target);
void read_plain(NumberRun& run, const char* guard, std::int32_t* out, std::size_t target);

/// Prefetches memory some distance after `p`, even if that address is not mapped. Hardware prefetching stops at the end
/// of a page, and these loops reach the next page before it is loaded. always_inline is necessary: otherwise GCC 12
/// removes the calls, because the function seems to have no effect.
[[gnu::always_inline]] inline void fetch_ahead(const void* p) {
  constexpr std::uintptr_t distance = 2048;
  __builtin_prefetch(reinterpret_cast<const void*>(reinterpret_cast<std::uintptr_t>(p) + distance));
}

/// All powers of ten that a double represents exactly; the index is the exponent.
inline constexpr std::array<double, 23> kPowersOfTen = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                                        1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                                        1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};

/// Computes mantissa * 10^exponent, rounded to the nearest float. Returns false if the result is too close to the
/// midpoint between two floats. The error of the double product is below two units in the last place: one unit from a
/// mantissa with more than 53 bits, half a unit from the product. A float has 29 fewer bits.
[[nodiscard]] inline bool scale(std::uint64_t mantissa, int exponent, float& value) {
  constexpr int last = static_cast<int>(kPowersOfTen.size()) - 1;
  if (exponent < -last || exponent > last) return false;
  const auto m = static_cast<double>(mantissa);
  const double product = exponent < 0 ? m / kPowersOfTen[static_cast<unsigned>(-exponent)]
                                      : m * kPowersOfTen[static_cast<unsigned>(exponent)];
  const auto bits = std::bit_cast<std::uint64_t>(product);
  if ((bits & 0x1fffffffu) - 0x0ffffffcu <= 8u || product > 1e38) return false;
  value = static_cast<float>(product);
  return true;
}

}  // namespace gs::vrml::number_paths
