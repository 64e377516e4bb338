#include "app/insitu/bricks/quantise.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace gs::app::insitu {
namespace quantise_test {

constexpr float kNone = std::numeric_limits<float>::quiet_NaN(), kInfinite = std::numeric_limits<float>::infinity();

std::vector<float> random_values(std::size_t count, float low, float high) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> spread(low, high);
  std::vector<float> values(count);
  for (float& value : values) value = spread(random);
  return values;
}

TEST_CASE("in situ codes: values return within half a quantum, and missing ones as NaN") {
  for (const std::size_t count : {0UL, 1UL, 7UL, 8UL, 29UL, 1000UL}) {
    INFO(count << " values");
    std::vector<float> values = random_values(count, -3, 500);
    if (count > 20) values[3] = kNone, values[9] = kInfinite, values[20] = -kInfinite;
    FiniteRange range;
    measure(values.data(), count, range);
    CHECK(range.empty() == (count == 0));
    const CodeScale scale = scale_of(range);
    std::vector<std::int16_t> codes(count);
    FiniteRange again;
    quantise(values.data(), count, scale, codes.data(), again);
    CHECK((again.low == range.low && again.high == range.high));
    std::vector<float> back(count);
    dequantise(codes.data(), 1, count, scale, back.data());
    bool right = true;
    for (std::size_t i = 0; i < count; ++i)
      right = right && (std::isfinite(values[i]) ? std::abs(back[i] - values[i]) <= scale.quantum * 0.501f
                                                 : std::isnan(back[i]));
    CHECK(right);
  }
}

TEST_CASE("in situ codes: a scale has room for growth, and one value is exact") {
  const CodeScale scale = scale_of({10, 20});
  CHECK(scale.low() < 9);
  CHECK(scale.high() > 21);
  const std::vector<float> equal(16, 4.25f);
  FiniteRange range;
  measure(equal.data(), equal.size(), range);
  std::vector<std::int16_t> codes(16);
  FiniteRange measured;
  quantise(equal.data(), 16, scale_of(range), codes.data(), measured);
  std::vector<float> back(4);
  dequantise(codes.data(), 4, 4, scale_of(range), back.data());
  CHECK(back == std::vector<float>(4, 4.25f));
}

TEST_CASE("in situ codes: values outside of the scale extend the range, so that the caller sees them") {
  const std::vector<float> values = random_values(37, -1000, 1000);
  std::vector<std::int16_t> codes(values.size());
  FiniteRange range;
  quantise(values.data(), values.size(), scale_of({0, 1}), codes.data(), range);
  CHECK(range.low == *std::ranges::min_element(values));
  CHECK(range.high == *std::ranges::max_element(values));
}

TEST_CASE("in situ codes: rounding stays within the error and keeps large and missing values") {
  std::vector<float> values = random_values(101, -50, 50);
  values[5] = kNone;
  values[6] = 1e30f;
  std::vector<float> rounded = values;
  round_within(rounded.data(), rounded.size(), 0.07f);
  float most = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i == 5 || i == 6) continue;
    most = std::max(most, std::abs(rounded[i] - values[i]));
    CHECK(rounded[i] / 0.125f == std::nearbyint(rounded[i] / 0.125f));  // the largest power of two up to 0.14
  }
  CHECK(most <= 0.07f);
  CHECK(most > 0.05f);
  CHECK(std::isnan(rounded[5]));
  CHECK(rounded[6] == 1e30f);
  rounded = values;
  round_within(rounded.data(), rounded.size(), 0);
  CHECK(rounded[0] == values[0]);
}

TEST_CASE("in situ codes: doubles become floats, and bytes are shuffled by their places") {
  std::vector<double> doubles(11);
  for (std::size_t i = 0; i < doubles.size(); ++i) doubles[i] = 0.1 * static_cast<double>(i) - 0.3;
  std::vector<float> floats(doubles.size());
  floats_of_doubles(doubles.data(), doubles.size(), floats.data());
  for (std::size_t i = 0; i < doubles.size(); ++i) CHECK(floats[i] == static_cast<float>(doubles[i]));
  const std::vector<float> two{1, -2};  // 0x3f800000, 0xc0000000
  std::vector<std::uint8_t> bytes(8);
  shuffle_floats(two.data(), two.size(), bytes.data());
  CHECK(bytes == std::vector<std::uint8_t>{0, 0, 0, 0, 0x80, 0, 0x3f, 0xc0});
}

TEST_CASE("in situ codes: rounded scales keep values within the error and have steps of powers of two") {
  const std::vector<float> values = random_values(1001, -20, 130);
  FiniteRange range;
  measure(values.data(), values.size(), range);
  for (const float error : {3.0f, 0.05f, 0.01f}) {
    INFO(error);
    const CodeScale scale = rounded_scale(range, error);
    REQUIRE(scale.quantum > 0);
    CHECK(std::exp2(std::round(std::log2(scale.quantum))) == scale.quantum);
    std::vector<std::int16_t> codes(values.size());
    FiniteRange found;
    quantise(values.data(), values.size(), scale, codes.data(), found);
    std::vector<float> decoded(values.size());
    dequantise(codes.data(), 1, codes.size(), scale, decoded.data());
    for (std::size_t i = 0; i < values.size(); ++i) CHECK(std::abs(decoded[i] - values[i]) <= error);
  }
}

TEST_CASE("in situ codes: rounded scales have no step if 16 bits do not suffice") {
  CHECK(rounded_scale({0, 1}, 0.000001f).quantum == 0);
  CHECK(rounded_scale({1e6f, 1e6f + 1}, 0.01f).quantum == 0);  // floats are coarser
  CHECK(rounded_scale({0, 1}, 0).quantum == 0);
  CHECK(rounded_scale({}, 0.1f).quantum == 1);
  CHECK(rounded_scale({7, 7}, 0).offset == 7);
}

TEST_CASE("in situ codes: differences are shuffled by their places, modulo 2^16") {
  for (const std::size_t count : {std::size_t{0}, std::size_t{1}, std::size_t{5}, std::size_t{100}}) {
    std::vector<std::int16_t> codes(count);
    for (std::size_t i = 0; i < count; ++i) codes[i] = static_cast<std::int16_t>(i % 7 == 3 ? kMissingCode : i * 3119);
    std::vector<std::uint8_t> bytes(2 * count);
    shuffle_differences(codes.data(), count, 0, bytes.data(), bytes.data() + count);
    std::uint16_t sum = 0;
    for (std::size_t i = 0; i < count; ++i) {
      sum = static_cast<std::uint16_t>(sum + bytes[i] + 256 * bytes[count + i]);
      CHECK(static_cast<std::int16_t>(sum) == codes[i]);
    }
  }
}

}  // namespace quantise_test
}  // namespace gs::app::insitu
