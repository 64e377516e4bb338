#include "qnv/codecs/values/coefficients.h"
#include "qnv/codecs/values/decode/values_decoder.h"
#include "qnv/codecs/values/lifting_kernel.h"
#include "qnv/codecs/values/plane_models.h"
#include "qnv/codecs/values/plane_range.h"
#include "tests/qnv/value_samples.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

namespace gs::qnv {
namespace values_kernels_test {

using Numbers = std::vector<std::int32_t>;

// Numbers of all sizes, up to the whole range.
Numbers wild_numbers(std::size_t count, std::mt19937& random) {
  Numbers numbers(count);
  for (std::int32_t& number : numbers) number = static_cast<std::int32_t>(random()) >> random() % 32;
  return numbers;
}

constexpr std::size_t kMostLength = 40;

TEST_CASE("values: The kernel of a lifting step gives the bits of the portable one") {
  std::mt19937 random(1);
  for (std::size_t n = 0; n <= kMostLength; ++n)
    for (std::size_t step = 0; step < 4; ++step)
      for (const bool undo : {false, true}) {
        const Numbers a = wild_numbers(n + 1, random);
        Numbers fast = wild_numbers(n + 3, random), plain = fast;
        values::lift(fast.data(), a.data(), a.data() + 1, n, step, undo);
        values::lift_portable(plain.data(), a.data(), a.data() + 1, n, step, undo);
        REQUIRE(fast == plain);
      }
}

TEST_CASE("values: The kernel of inverse lifting gives the bits of the portable one") {
  std::mt19937 random(2);
  for (std::size_t count = 0; count <= kMostLength; ++count)
    for (std::size_t size = 0; size <= kMostLength; size += count < 6 ? 1 : 3) {
      const std::size_t stride = size + random() % 3;
      Numbers fast = wild_numbers(count * stride + 1, random), plain = fast;
      values::unlift_rows(fast.data(), count, stride, size);
      values::unlift_rows_portable(plain.data(), count, stride, size);
      REQUIRE(fast == plain);
    }
}

TEST_CASE("values: Inverse lifting along rows reverts the transform of lines") {
  std::mt19937 random(3);
  Numbers buffer;
  for (std::size_t n = 1; n <= kMostLength; ++n) {
    const Numbers line = wild_numbers(n, random);
    Numbers bands(n), rows(n);
    values::split_line(line.data(), bands.data(), n, buffer);
    values::interleave(bands.data(), bands.data() + (n + 1) / 2, n / 2, rows.data());
    if (n % 2 != 0) rows[n - 1] = bands[n / 2];
    values::unlift_rows(rows.data(), n, 1, 1);
    CHECK(rows == line);
  }
}

TEST_CASE("values: The kernels that separate and interleave give the numbers of the portable ones") {
  std::mt19937 random(4);
  for (std::size_t n = 0; n <= kMostLength; ++n) {
    const Numbers whole = wild_numbers(2 * n, random);
    Numbers even(n + 1), odd(n + 1), back(2 * n + 1, 77), plain_even(n + 1), plain_odd(n + 1), plain_back = back;
    values::separate(whole.data(), n, even.data(), odd.data());
    values::separate_portable(whole.data(), n, plain_even.data(), plain_odd.data());
    CHECK(even == plain_even);
    CHECK(odd == plain_odd);
    values::interleave(even.data(), odd.data(), n, back.data());
    values::interleave_portable(even.data(), odd.data(), n, plain_back.data());
    CHECK(back == plain_back);
    CHECK(std::equal(whole.begin(), whole.end(), back.begin()));
    CHECK(back.back() == 77);
  }
}

TEST_CASE("values: Lines of coefficients keep magnitude and sign, and get the middle of their values") {
  std::mt19937 random(5);
  for (std::uint32_t count = 1; count <= values::kCubeEdge; ++count)
    for (int i = 0; i < 100; ++i) {
      Numbers from = wild_numbers(count, random), back(count);
      if (i % 3 == 0) from[0] = 0;
      std::vector<std::uint32_t> signed_sizes(count);
      values::load_line(from.data(), count, signed_sizes.data());
      values::add_line(signed_sizes.data(), count, 5, back.data());
      for (std::uint32_t x = 0; x < count; ++x) {
        const auto value = std::int64_t{from[x]};
        CHECK(signed_sizes[x] >> 31 == (value < 0 ? 1u : 0u));
        const std::int64_t expected = value + (value > 0 ? 5 : value < 0 ? -5 : 0);
        if (std::abs(value) < 1 << 30) CHECK(back[x] == expected);
      }
    }
}

TEST_CASE("values: The coder of clusters has the bytes of the general range coder") {
  std::mt19937 random(6);
  for (int round = 0; round < 200; ++round) {
    struct Decision {
      std::uint32_t probability;
      bool bit;
    };
    std::vector<Decision> decisions(random() % 300);
    for (Decision& one : decisions) {
      one.probability = random() % 3 == 0 ? 32768 : 48 + random() % (round % 2 == 0 ? 200 : 65440);
      one.bit = random() % 65536 < one.probability;
    }
    displaced::BinaryEncoder general;
    std::vector<std::byte> bytes(2048);
    values::RangeWriter writer(bytes.data());
    for (const Decision& one : decisions) {
      general.put(one.probability, one.bit);
      writer.put(one.bit, static_cast<std::uint32_t>(std::uint64_t{writer.range()} * one.probability >> 16));
    }
    const std::size_t size = writer.finish(bytes.data());
    const std::vector<std::byte> written(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
    CHECK(written == general.finish());
    std::vector<std::byte> padded = written;
    padded.resize(size + values::kMostCubeBytes);
    values::RangeReader reader(padded.data());
    bool same = true;
    for (const Decision& one : decisions) {
      const auto bound = static_cast<std::uint32_t>(std::uint64_t{reader.range()} * one.probability >> 16);
      same = (one.probability == 32768 ? reader.get_bit() != 0 : reader.get(bound)) == one.bit && same;
    }
    CHECK(same);
    CHECK_FALSE(reader.exhausted(padded.data() + size));
  }
}

// Ball with a rough surface.
Numbers rough_ball(values::Extent extent) {
  std::mt19937 random(7);
  Numbers samples;
  for (std::uint32_t z = 0; z < extent[2]; ++z)
    for (std::uint32_t y = 0; y < extent[1]; ++y)
      for (std::uint32_t x = 0; x < extent[0]; ++x) {
        const double u = 2.0 * x / extent[0] - 1, v = 2.0 * y / extent[1] - 1, w = 2.0 * z / extent[2] - 1;
        const double r = u * u + v * v + w * w;
        samples.push_back(r > 0.6 ? 0 : 1000 + static_cast<std::int32_t>(300 * std::sin(9 * u) + random() % 20));
      }
  return samples;
}

TEST_CASE("values: A limited size has the first clusters of the whole order, for any number of threads") {
  const values::Extent extent{140, 90, 70};
  const Numbers samples = rough_ball(extent);
  const auto whole = test::encode_samples(samples, extent, {});
  REQUIRE(whole);
  for (const std::size_t most : {3000, 20'000, 90'000})
    for (const unsigned threads : {1u, 3u}) {
      const auto limited = test::encode_samples(samples, extent, {0, most}, threads);
      REQUIRE(limited);
      REQUIRE(limited->clusters.size() < whole->clusters.size());
      bool same = true;
      for (std::size_t i = 0; i < limited->clusters.size(); ++i)
        same = same && values::pack(limited->clusters[i]) == values::pack(whole->clusters[i]);
      CHECK(same);
    }
}

TEST_CASE("values: A large level is shown after enough bytes") {
  const values::Extent extent{136, 132, 130};  // more samples than a reader computes without data
  const auto encoded = test::encode_samples(rough_ball(extent), extent, {0, 60'000});
  REQUIRE(encoded);
  const values::BlockLayout layout(extent, values::level_count(extent));
  values::ValuesDecoder decoder(extent);
  std::size_t bytes = 0;
  constexpr std::size_t kEnough = std::size_t{136} * 132 * 130 / 400;
  for (const values::Cluster& cluster : encoded->clusters)
    if (layout.place(cluster.block).level > 1 && bytes + cluster.bytes.size() < kEnough) {
      decoder.add(cluster);
      bytes += cluster.bytes.size();
    }
  CHECK(bytes > 3000);
  CHECK(decoder.level() == 1);
  for (const values::Cluster& cluster : encoded->clusters) decoder.add(cluster);
  CHECK(decoder.level() == 0);
}

}  // namespace values_kernels_test
}  // namespace gs::qnv
