// Loops over all values of a block, once per step. Compiled with full optimisation.
#include "app/insitu/bricks/quantise.h"

#include <algorithm>
#include <bit>
#include <cmath>

#if defined(__x86_64__)
#include <emmintrin.h>
#endif

namespace gs::app::insitu {
namespace {

constexpr float kLargestFloat = std::numeric_limits<float>::max();

std::int16_t code_of(float value, float offset, float inverse, FiniteRange& range) {
  if (!(std::abs(value) <= kLargestFloat)) return kMissingCode;
  range.low = std::min(range.low, value);
  range.high = std::max(range.high, value);
  return static_cast<std::int16_t>(std::lrint(std::clamp((value - offset) * inverse, -kMaxCode, kMaxCode)));
}

// Maximum size of values in steps. Below it, floats hold all multiples of half a step exactly.
constexpr float kMostSteps = 4'194'304;

// Returns the largest power of two for which the nearest multiple differs from a value by at most `error`; 0 if there
// is none.
float step_within(float error) {
  if (!(error > 0) || !std::isfinite(error)) return 0;
  // The nearest multiple of 2^n differs from a value by at most 2^(n-1).
  const float step = std::exp2(std::floor(std::log2(2 * error)));
  return step > 0 && std::isfinite(step) && std::isfinite(1 / step) ? step : 0;
}

#if defined(__x86_64__)

// Range of the values in each of four lanes.
struct LaneRange {
  explicit LaneRange(const FiniteRange& range) : low(_mm_set1_ps(range.low)), high(_mm_set1_ps(range.high)) {}
  // Extends the range by the finite values. Returns a mask of these values.
  __m128 include(__m128 value) {
    const __m128 size = _mm_andnot_ps(_mm_set1_ps(-0.0f), value);
    const __m128 finite = _mm_cmple_ps(size, _mm_set1_ps(kLargestFloat));
    const __m128 known = _mm_and_ps(finite, value);
    const __m128 infinity = _mm_set1_ps(std::numeric_limits<float>::infinity());
    low = _mm_min_ps(low, _mm_or_ps(known, _mm_andnot_ps(finite, infinity)));
    high = _mm_max_ps(high, _mm_or_ps(known, _mm_andnot_ps(finite, _mm_sub_ps(_mm_setzero_ps(), infinity))));
    return finite;
  }
  void put(FiniteRange& range) const {
    alignas(16) float lows[4], highs[4];
    _mm_store_ps(lows, low);
    _mm_store_ps(highs, high);
    range.low = *std::min_element(lows, lows + 4);
    range.high = *std::max_element(highs, highs + 4);
  }
  __m128 low, high;
};

#endif

}  // namespace

CodeScale scale_of(const FiniteRange& range) {
  if (range.empty()) return {};
  constexpr float kRoom = 1.25f;
  const float offset = range.low + (range.high - range.low) / 2;
  const float quantum = (range.high - range.low) * (kRoom / (2 * kMaxCode));
  return {offset, std::isfinite(quantum) ? quantum : 0};
}

CodeScale rounded_scale(const FiniteRange& range, float error) {
  if (range.empty()) return {0, 1};
  if (range.low == range.high) return {range.low, 1};
  const float step = step_within(error);
  if (!(step > 0)) return {};
  const float middle = range.low / 2 + range.high / 2;
  const float offset = std::nearbyint(middle / step) * step;
  // The codes at the ends have room for the rounding of the offset.
  const bool fits = (range.high - range.low) / step < 2 * kMaxCode - 4 &&
                    std::max(std::abs(range.low), std::abs(range.high)) / step < kMostSteps;
  return fits ? CodeScale{offset, step} : CodeScale{};
}

void floats_of_doubles(const double* from, std::size_t count, float* to) {
  std::size_t i = 0;
#if defined(__x86_64__)
  for (; i + 4 <= count; i += 4)
    _mm_storeu_ps(to + i,
                  _mm_movelh_ps(_mm_cvtpd_ps(_mm_loadu_pd(from + i)), _mm_cvtpd_ps(_mm_loadu_pd(from + i + 2))));
#endif
  for (; i < count; ++i) to[i] = static_cast<float>(from[i]);
}

void quantise(const float* from, std::size_t count, const CodeScale& scale, std::int16_t* to, FiniteRange& range) {
  const float inverse = scale.quantum > 0 ? 1 / scale.quantum : 0;
  std::size_t i = 0;
#if defined(__x86_64__)
  LaneRange lanes(range);
  const __m128 offset = _mm_set1_ps(scale.offset), factor = _mm_set1_ps(inverse);
  const __m128i missing = _mm_set1_epi32(kMissingCode);
  const auto codes = [&](const float* at) {
    const __m128 value = _mm_loadu_ps(at);
    const __m128i finite = _mm_castps_si128(lanes.include(value));
    const __m128i code = _mm_cvtps_epi32(_mm_mul_ps(_mm_sub_ps(value, offset), factor));
    return _mm_or_si128(_mm_and_si128(finite, code), _mm_andnot_si128(finite, missing));
  };
  for (; i + 8 <= count; i += 8)
    _mm_storeu_si128(reinterpret_cast<__m128i*>(to + i), _mm_packs_epi32(codes(from + i), codes(from + i + 4)));
  lanes.put(range);
#endif
  for (; i < count; ++i) to[i] = code_of(from[i], scale.offset, inverse, range);
}

void measure(const float* from, std::size_t count, FiniteRange& range) {
  std::size_t i = 0;
#if defined(__x86_64__)
  LaneRange lanes(range);
  for (; i + 4 <= count; i += 4) (void)lanes.include(_mm_loadu_ps(from + i));
  lanes.put(range);
#endif
  for (; i < count; ++i) (void)code_of(from[i], 0, 0, range);
}

void dequantise(const std::int16_t* from, std::size_t step, std::size_t count, const CodeScale& scale, float* to) {
  const auto value_of = [&scale](std::int16_t code) {
    const float value = scale.offset + static_cast<float>(code) * scale.quantum;
    return code == kMissingCode ? std::numeric_limits<float>::quiet_NaN() : value;
  };
  if (step == 1)  // separate loop, so that the compiler can vectorise it
    for (std::size_t i = 0; i < count; ++i) to[i] = value_of(from[i]);
  else
    for (std::size_t i = 0; i < count; ++i) to[i] = value_of(from[i * step]);
}

void round_within(float* values, std::size_t count, float error) {
  const float step = step_within(error);
  if (!(step > 0)) return;
  const float inverse = 1 / step;
  std::size_t i = 0;
#if defined(__x86_64__)
  for (; i + 4 <= count; i += 4) {
    const __m128 value = _mm_loadu_ps(values + i), scaled = _mm_mul_ps(value, _mm_set1_ps(inverse));
    const __m128 small = _mm_cmplt_ps(_mm_andnot_ps(_mm_set1_ps(-0.0f), scaled), _mm_set1_ps(kMostSteps));
    const __m128 rounded = _mm_mul_ps(_mm_cvtepi32_ps(_mm_cvtps_epi32(scaled)), _mm_set1_ps(step));
    _mm_storeu_ps(values + i, _mm_or_ps(_mm_and_ps(small, rounded), _mm_andnot_ps(small, value)));
  }
#endif
  for (; i < count; ++i)
    if (std::abs(values[i] * inverse) < kMostSteps) values[i] = std::nearbyint(values[i] * inverse) * step;
}

void shuffle_floats(const float* from, std::size_t count, std::uint8_t* to) {
  std::uint8_t *first = to, *second = to + count, *third = to + 2 * count, *last = to + 3 * count;
  for (std::size_t i = 0; i < count; ++i) {
    const auto bits = std::bit_cast<std::uint32_t>(from[i]);
    first[i] = static_cast<std::uint8_t>(bits);
    second[i] = static_cast<std::uint8_t>(bits >> 8);
    third[i] = static_cast<std::uint8_t>(bits >> 16);
    last[i] = static_cast<std::uint8_t>(bits >> 24);
  }
}

void shuffle_differences(const std::int16_t* from, std::size_t count, std::int16_t previous, std::uint8_t* low,
                         std::uint8_t* high) {
  if (count == 0) return;
  const auto put = [&](std::size_t i, unsigned difference) {
    low[i] = static_cast<std::uint8_t>(difference);
    high[i] = static_cast<std::uint8_t>(difference >> 8);
  };
  put(0, static_cast<unsigned>(from[0] - previous));
  std::size_t i = 1;
#if defined(__x86_64__)
  const __m128i mask = _mm_set1_epi16(0xff);
  const auto differences = [&](std::size_t at) {
    const auto* const codes = reinterpret_cast<const __m128i*>(from + at);
    return _mm_sub_epi16(_mm_loadu_si128(codes), _mm_loadu_si128(reinterpret_cast<const __m128i*>(from + at - 1)));
  };
  for (; i + 16 <= count; i += 16) {
    const __m128i first = differences(i), second = differences(i + 8);
    _mm_storeu_si128(reinterpret_cast<__m128i*>(low + i),
                     _mm_packus_epi16(_mm_and_si128(first, mask), _mm_and_si128(second, mask)));
    _mm_storeu_si128(reinterpret_cast<__m128i*>(high + i),
                     _mm_packus_epi16(_mm_srli_epi16(first, 8), _mm_srli_epi16(second, 8)));
  }
#endif
  for (; i < count; ++i) put(i, static_cast<unsigned>(from[i] - from[i - 1]));
}

}  // namespace gs::app::insitu
