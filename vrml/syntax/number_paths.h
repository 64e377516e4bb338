#pragma once

#include "vrml/syntax/number.h"

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

/// The code paths behind parse_floats and parse_integers; for those two, and for their tests. Both paths
/// give the same NumberRun and the same numbers for the same text.
namespace gs::vrml::number_paths {

/// Byte by byte; for every processor.
[[nodiscard]] NumberRun floats_portable(const char* begin, const char* end, float* out, std::size_t capacity);
[[nodiscard]] NumberRun integers_portable(const char* begin, const char* end, std::int32_t* out, std::size_t capacity);

/// True where the processor has what the AVX2 path needs.
[[nodiscard]] bool has_avx2();

/// Eight numbers at a time. Call only where has_avx2(). They write nothing behind out[capacity - 1], but
/// may leave rubbish behind the last number of the run.
[[nodiscard]] NumberRun floats_avx2(const char* begin, const char* end, float* out, std::size_t capacity);
[[nodiscard]] NumberRun integers_avx2(const char* begin, const char* end, std::int32_t* out, std::size_t capacity);

/// The last byte in front of `end` that cannot be part of a number, so that a loop over the characters of
/// a number that starts in front of it needs no other bound. Null when the last 128 bytes have none: such
/// a text is rubbish, and is left to the slow path.
[[nodiscard]] const char* find_guard(const char* begin, const char* end);

/// One number of a run at `p`, which moves behind it. False, and `p` as it was, where there is none that a
/// run takes. There must be a byte behind `p` that cannot be part of a number.
[[nodiscard]] bool read_number(const char*& p, float& value);
[[nodiscard]] bool read_number(const char*& p, std::int32_t& value);

/// Goes on with `run` byte by byte until it has `target` numbers, comes to `guard`, or must stop.
void read_plain(NumberRun& run, const char* guard, float* out, std::size_t target);
void read_plain(NumberRun& run, const char* guard, std::int32_t* out, std::size_t target);

/// Asks for the memory some way behind `p`, mapped or not: processors fetch ahead only to the end of a
/// page, and these loops are faster than the next page comes. (Were it not for the attribute, GCC 12 would
/// take a function without a result or side effect for an idle one, and leave it out.)
[[gnu::always_inline]] inline void fetch_ahead(const void* p) {
  constexpr std::uintptr_t distance = 2048;
  __builtin_prefetch(reinterpret_cast<const void*>(reinterpret_cast<std::uintptr_t>(p) + distance));
}

/// Every power of ten that a double holds exactly.
inline constexpr std::array<double, 23> kPowersOfTen = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                                        1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                                        1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};

/// mantissa * 10^exponent to the nearest float. False where the double product is too near to the middle
/// between two floats to tell: its error is less than two units in its last place (one from a mantissa of
/// more than 53 bits, half of one from the product), and a float keeps 29 bits less.
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
