#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

namespace gs::app::insitu {

/// Code of values that are missing or not finite.
inline constexpr std::int16_t kMissingCode = -32768;
/// Largest code of a value; the smallest one is -kMaxCode.
inline constexpr float kMaxCode = 32767;

/// Linear map from codes of 16 bits to values: offset + code * quantum.
struct CodeScale {
  float offset = 0, quantum = 0;

  [[nodiscard]] float low() const { return offset - kMaxCode * quantum; }
  [[nodiscard]] float high() const { return offset + kMaxCode * quantum; }
};

/// Range of the finite values of an array; low > high if there are none.
struct FiniteRange {
  float low = std::numeric_limits<float>::infinity(), high = -std::numeric_limits<float>::infinity();

  [[nodiscard]] bool empty() const { return low > high; }
};

/// Returns a scale for a range of values, extended by an eighth of the range at each end.
[[nodiscard]] CodeScale scale_of(const FiniteRange& range);
/// Returns a scale for a range of values. Its codes change values by at most `error`. Its step is a power of two, so
/// that floats hold the decoded values exactly. The step is 0 if 16 bits do not suffice.
[[nodiscard]] CodeScale rounded_scale(const FiniteRange& range, float error);

/// Converts numbers to float.
void floats_of_doubles(const double* from, std::size_t count, float* to);
/// Maps values to the nearest codes, and extends `range` by the values. Clamps values outside of the scale, so callers
/// must compare the range with the scale.
void quantise(const float* from, std::size_t count, const CodeScale& scale, std::int16_t* to, FiniteRange& range);
/// Extends `range` by values.
void measure(const float* from, std::size_t count, FiniteRange& range);
/// Maps every `step`-th code to its value; NaN for kMissingCode.
void dequantise(const std::int16_t* from, std::size_t step, std::size_t count, const CodeScale& scale, float* to);
/// Rounds values to multiples of a power of two, so that they compress well. Changes them by at most `error`.
void round_within(float* values, std::size_t count, float error);
/// Writes the lowest bytes of all values, then all second bytes, and so on, so that similar bytes are adjacent. This is
/// the little-endian shuffle codec of numcodecs.
void shuffle_floats(const float* from, std::size_t count, std::uint8_t* to);
/// Writes the low and the high bytes of the differences of neighbouring codes, modulo 2^16. `previous` is the code
/// before the first one. These are the codecs delta and shuffle of numcodecs.
void shuffle_differences(const std::int16_t* from, std::size_t count, std::int16_t previous, std::uint8_t* low,
                         std::uint8_t* high);

}  // namespace gs::app::insitu
