#include "qnv/codecs/values/cube_runs.h"
#include "qnv/codecs/values/decode/values_decoder.h"
#include "qnv/codecs/values/encode/encode_values.h"
#include "tests/qnv/value_samples.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

namespace gs::qnv {
namespace values_codec_test {

using values::Cluster;
using values::Extent;
using values::ValuesDecoder;

// Ball with a smooth inside in an empty volume, with a little noise where it is dense.
std::vector<std::int32_t> ball_values(Extent extent, std::int32_t height = 3000) {
  std::mt19937 random(7);
  std::vector<std::int32_t> samples;
  for (std::uint32_t z = 0; z < extent[2]; ++z)
    for (std::uint32_t y = 0; y < extent[1]; ++y)
      for (std::uint32_t x = 0; x < extent[0]; ++x) {
        const double u = 2.0 * x / extent[0] - 0.9, v = 2.0 * y / extent[1] - 1, w = 2.0 * z / extent[2] - 1.1;
        const double r = u * u + v * v + w * w;
        const auto noise = static_cast<std::int32_t>(random() % 9);
        samples.push_back(r > 0.6 ? 0 : static_cast<std::int32_t>(height * (1 - r)) + noise);
      }
  return samples;
}

std::uint32_t values_apart(const std::vector<std::int32_t>& a, const std::vector<std::int32_t>& b) {
  REQUIRE(a.size() == b.size());
  std::int64_t most = 0;
  for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, std::abs(std::int64_t{a[i]} - b[i]));
  return static_cast<std::uint32_t>(most);
}

double values_rms(const std::vector<std::int32_t>& a, const std::vector<std::int32_t>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += std::pow(static_cast<double>(a[i]) - b[i], 2);
  return std::sqrt(sum / static_cast<double>(a.size()));
}

std::vector<std::int32_t> decoded_values(Extent extent, const std::vector<Cluster>& clusters) {
  ValuesDecoder decoder(extent);
  for (const Cluster& cluster : clusters) decoder.add(cluster);
  return decoder.samples();
}

TEST_CASE("values: A complete stream restores every sample of volumes of any extent") {
  for (const Extent extent :
       {Extent{1, 1, 1}, Extent{2, 1, 3}, Extent{17, 1, 1}, Extent{5, 40, 7}, Extent{33, 34, 35}, Extent{70, 50, 20}}) {
    const auto samples = ball_values(extent);
    const auto encoded = test::encode_samples(samples, extent, {});
    REQUIRE(encoded);
    CHECK(encoded->errors.back().most == 0);
    CHECK(decoded_values(extent, encoded->clusters) == samples);
  }
}

TEST_CASE("values: Noise of the full permitted size is restored") {
  const Extent extent{20, 18, 19};
  std::mt19937 random(3);
  std::vector<std::int32_t> samples(values::sample_count(extent));
  for (std::int32_t& sample : samples)
    sample = static_cast<std::int32_t>(random() % (2u * values::kMostSample)) - values::kMostSample;
  const auto encoded = test::encode_samples(samples, extent, {});
  REQUIRE(encoded);
  CHECK(decoded_values(extent, encoded->clusters) == samples);
}

TEST_CASE("values: A volume without content needs no cluster") {
  const Extent extent{64, 64, 64};
  const auto encoded = test::encode_samples(std::vector<std::int32_t>(64 * 64 * 64, 0), extent, {});
  REQUIRE(encoded);
  CHECK(encoded->clusters.empty());
}

TEST_CASE("values: Corrections keep the permitted error of every sample, and larger errors need fewer bytes") {
  const Extent extent{48, 40, 36};
  const auto samples = ball_values(extent);
  std::size_t before = std::numeric_limits<std::size_t>::max();
  for (const std::uint32_t bound : {0u, 1u, 5u, 50u, 500u}) {
    const auto encoded = test::encode_samples(samples, extent, {.most_error = bound});
    REQUIRE(encoded);
    auto decoded = decoded_values(extent, encoded->clusters);
    for (std::size_t i = 0; i < encoded->corrections.size(); ++i)
      decoded[i] += static_cast<std::int32_t>(encoded->corrections[i] * values::correction_step(bound));
    CHECK(values_apart(decoded, samples) <= bound);
    CHECK(static_cast<float>(values_apart(decoded, samples)) == encoded->errors.back().most);
    CHECK(encoded->clusters.size() <= before);
    before = encoded->clusters.size();
  }
}

TEST_CASE("values: The bytes do not depend on the number of threads") {
  const Extent extent{70, 40, 36};
  const auto samples = ball_values(extent);
  const auto one = test::encode_samples(samples, extent, {.most_error = 9}, 1);
  const auto three = test::encode_samples(samples, extent, {.most_error = 9}, 3);
  REQUIRE(one);
  REQUIRE(three);
  REQUIRE(one->clusters.size() == three->clusters.size());
  for (std::size_t i = 0; i < one->clusters.size(); ++i)
    CHECK(values::pack(one->clusters[i]) == values::pack(three->clusters[i]));
}

TEST_CASE("values: Measured errors of prefixes are those of a decoder") {
  const Extent extent{96, 80, 64};
  const auto samples = ball_values(extent);
  const auto encoded = test::encode_samples(samples, extent, {});
  REQUIRE(encoded);
  REQUIRE(encoded->errors.size() > 2);
  for (const ValueError& error : encoded->errors) {
    const std::vector<Cluster> prefix(encoded->clusters.begin(), encoded->clusters.begin() + error.chunks);
    const auto decoded = decoded_values(extent, prefix);
    CHECK(error.most == static_cast<float>(values_apart(decoded, samples)));
    CHECK(error.rms == Approx(values_rms(decoded, samples)));
  }
}

TEST_CASE("values: has no larger error at any prefix than at an eighth of it") {
  const Extent extent{48, 40, 36};
  const auto samples = ball_values(extent);
  const auto encoded = test::encode_samples(samples, extent, {});
  REQUIRE(encoded);
  ValuesDecoder decoder(extent);
  std::vector<double> errors{values_rms(decoder.samples(), samples)};
  for (const Cluster& cluster : encoded->clusters) {
    CHECK(values::pack(cluster).size() <= values::kMaxClusterBytes);
    REQUIRE(decoder.add(cluster) == values::Added::taken);
    errors.push_back(values_rms(decoder.samples(), samples));
    CHECK(errors.back() <= errors[errors.size() / 8]);
  }
  CHECK(errors.back() == 0);
}

TEST_CASE("values: Clusters in reverse order give the same samples") {
  const Extent extent{40, 40, 40};
  const auto samples = ball_values(extent);
  auto encoded = test::encode_samples(samples, extent, {});
  REQUIRE(encoded);
  std::ranges::reverse(encoded->clusters);
  CHECK(decoded_values(extent, encoded->clusters) == samples);
}

TEST_CASE("values: A lost cluster changes only a neighbourhood of its box") {
  const Extent extent{96, 80, 64};
  const auto samples = ball_values(extent);
  const auto encoded = test::encode_samples(samples, extent, {});
  REQUIRE(encoded);
  const values::BlockLayout layout(extent, values::level_count(extent));
  const auto lost =
      std::ranges::find_if(encoded->clusters, [&](const Cluster& c) { return layout.place(c.block).level == 1; });
  REQUIRE(lost != encoded->clusters.end());
  const values::BlockPlace place = layout.place(lost->block);
  auto kept = encoded->clusters;
  kept.erase(kept.begin() + (lost - encoded->clusters.begin()));
  const auto decoded = decoded_values(extent, kept);
  bool same = true;
  std::size_t i = 0;
  for (std::uint32_t z = 0; z < extent[2]; ++z)
    for (std::uint32_t y = 0; y < extent[1]; ++y)
      for (std::uint32_t x = 0; x < extent[0]; ++x, ++i) {
        const Extent at{x, y, z};
        bool near = true;
        for (std::size_t a = 0; a < 3; ++a)
          near = near && at[a] + 8 >= place.first[a] && at[a] < place.first[a] + place.size[a] + 8;
        same = same && (near || decoded[i] == samples[i]);
      }
  CHECK(same);
}

TEST_CASE("values: scales a constant volume by level_gain() at level 1") {
  const Extent extent{64, 64, 64};
  const std::vector<std::int32_t> samples(values::sample_count(extent), 1000);
  const auto encoded = test::encode_samples(samples, extent, {});
  REQUIRE(encoded);
  ValuesDecoder decoder(extent);
  for (const Cluster& cluster : encoded->clusters) decoder.add(cluster);
  const auto low = decoder.samples(1);
  REQUIRE(low.size() == 32 * 32 * 32);
  for (const std::int32_t value : {low.front(), low[16 * 32 * 32 + 16 * 32 + 16], low.back()})
    CHECK(value == Approx(1000 * values::level_gain(extent, 1)).epsilon(0.01));
}

TEST_CASE("values: decodes the same coarse samples when finer clusters are dropped") {
  const Extent extent{70, 33, 50};
  const auto encoded = test::encode_samples(ball_values(extent), extent, {});
  REQUIRE(encoded);
  const int levels = values::level_count(extent);
  ValuesDecoder all(extent);
  for (const Cluster& cluster : encoded->clusters) all.add(cluster);
  for (int level = 1; level <= levels; ++level) {
    ValuesDecoder coarse(extent, level);
    for (const Cluster& cluster : encoded->clusters) coarse.add(cluster);
    CHECK(coarse.samples(level) == all.samples(level));
    CHECK(coarse.level() >= level);
  }
}

TEST_CASE("values: Blocks cover all coefficients once") {
  for (const Extent extent : {Extent{1, 1, 1}, Extent{16, 16, 16}, Extent{17, 40, 3}, Extent{100, 70, 33}}) {
    const values::BlockLayout layout(extent, values::level_count(extent));
    std::vector<int> seen(values::sample_count(extent), 0);
    for (std::uint64_t i = 0; i < layout.count(); ++i) {
      const values::BlockPlace place = layout.place(i);
      for (std::uint32_t b = 0; b < place.band_count; ++b) {
        const values::BandPart& part = place.bands[b];
        for (std::uint32_t z = 0; z < part.size[2]; ++z)
          for (std::uint32_t y = 0; y < part.size[1]; ++y)
            for (std::uint32_t x = 0; x < part.size[0]; ++x)
              ++seen[((part.first[2] + z) * std::size_t{extent[1]} + part.first[1] + y) * extent[0] + part.first[0] +
                     x];
      }
    }
    CHECK(std::ranges::all_of(seen, [](int n) { return n == 1; }));
  }
}

TEST_CASE("values: Gaps and remainders of runs are restored") {
  const Extent extent{21, 10, 9};
  std::mt19937 random(5);
  std::vector<std::uint8_t> missing(values::sample_count(extent));
  std::vector<std::uint32_t> remainders(missing.size());
  for (std::size_t i = 0; i < missing.size(); ++i) {
    missing[i] = i % 21 > 15 || random() % 50 == 0 ? 1 : 0;
    remainders[i] = i % 7 < 3 ? 0 : random() >> random() % 32;
  }
  std::vector<std::uint8_t> gaps(missing.size());
  for (const values::CubeRun& run : values::encode_gaps(missing, extent)) {
    CHECK(values::pack(run).size() <= values::kMaxClusterBytes);
    const auto parsed = values::parse_run(values::pack(run));
    REQUIRE(parsed);
    CHECK(values::decode_gaps(*parsed, extent, gaps));
  }
  CHECK(gaps == missing);
  std::vector<std::uint32_t> codes(missing.size(), 7);
  const auto runs = values::encode_remainders(remainders, extent);
  CHECK(runs.size() > 3);
  for (const values::CubeRun& run : runs) {
    CHECK(values::pack(run).size() <= values::kMaxClusterBytes);
    CHECK(values::decode_remainders(run, extent, codes));
  }
  for (std::size_t i = 0; i < codes.size(); ++i) CHECK(codes[i] == remainders[i] + 7);
  CHECK_FALSE(values::decode_gaps({1000, 1, {}}, extent, gaps));
  CHECK_FALSE(values::decode_gaps({0, 1000, {}}, extent, gaps));
  CHECK_FALSE(values::parse_run(std::vector<std::byte>{std::byte{0}, std::byte{0}}));
}

TEST_CASE("values: Clusters of blocks without coefficients are refused") {
  // At level 1, the only block beyond x = 16 of the low band has no part of any high band.
  const Extent extent{33, 1, 1};
  const values::BlockLayout layout(extent, values::level_count(extent));
  std::size_t empty = 0;
  for (std::uint64_t i = 0; i < layout.count(); ++i) {
    if (layout.place(i).band_count > 0) continue;
    ++empty;
    ValuesDecoder decoder(extent);
    CHECK(decoder.add({static_cast<std::uint32_t>(i), 0, 5, 3, {std::byte{1}}}) == values::Added::refused);
  }
  CHECK(empty == 1);
}

TEST_CASE("values: Damaged clusters are refused or decode to something") {
  const Extent extent{40, 36, 30};
  const auto encoded = test::encode_samples(ball_values(extent), extent, {});
  REQUIRE(encoded);
  std::mt19937 random(11);
  for (int round = 0; round < 60; ++round) {
    ValuesDecoder decoder(extent);
    for (const Cluster& cluster : encoded->clusters) {
      auto bytes = values::pack(cluster);
      if (random() % 3 == 0) bytes[random() % std::min<std::size_t>(bytes.size(), 12)] ^= std::byte(1u << random() % 8);
      if (random() % 9 == 0) bytes.resize(random() % (bytes.size() + 1));
      if (const auto parsed = values::parse_cluster(bytes)) decoder.add(*parsed);
    }
    CHECK(decoder.samples().size() == values::sample_count(extent));
  }
}

TEST_CASE("values: Packed clusters parse, and wrong ones do not") {
  const Cluster cluster{300, 2, 70000, 0, {std::byte{1}, std::byte{2}}};
  const auto bytes = values::pack(cluster);
  CHECK(bytes == std::vector<std::byte>{std::byte{0xac}, std::byte{2}, std::byte{2}, std::byte{0xf0}, std::byte{0xa2},
                                        std::byte{4}, std::byte{1}, std::byte{2}});
  const auto parsed = values::parse_cluster(bytes);
  REQUIRE(parsed);
  CHECK(parsed->block == 300);
  CHECK(parsed->steps == 70000);
  CHECK(parsed->bytes == cluster.bytes);
  CHECK_FALSE(values::parse_cluster({}));
  CHECK_FALSE(values::parse_cluster(std::vector<std::byte>(2000)));
  CHECK_FALSE(values::parse_cluster(std::vector<std::byte>(30, std::byte{255})));
}

TEST_CASE("values: Unsupported extents are refused") {
  CHECK_FALSE(values::valid(Extent{0, 1, 1}));
  CHECK_FALSE(values::valid(Extent{0xffffffff, 0xffffffff, 0xffffffff}));
  CHECK_FALSE(values::valid(Extent{0x80000000, 0x80000000, 4}));
}

}  // namespace values_codec_test
}  // namespace gs::qnv
