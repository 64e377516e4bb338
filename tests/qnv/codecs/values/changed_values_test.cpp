#include "qnv/codecs/values/decode/cell_vectors.h"
#include "qnv/codecs/values/decode/values_decoder.h"
#include "qnv/codecs/values/encode/encode_values.h"
#include "qnv/codecs/values/encode/values_stream.h"
#include "qnv/reader/stream_decoder.h"
#include "qnv/sampling/volume/gradients.h"
#include "qnv/sampling/volume/volume_values.h"
#include "tests/qnv/value_samples.h"
#include "tests/qnv/volume_sources.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <random>
#include <tuple>
#include <vector>

namespace gs::qnv {
namespace changed_values_test {

using values::Cluster;
using values::Extent;
using values::SampleBox;
using values::SampleBricks;
using values::ValuesDecoder;

// Two bubbles with some noise.
std::vector<std::int32_t> bubbles(Extent extent) {
  std::mt19937 random(5);
  std::vector<std::int32_t> samples;
  for (std::uint32_t z = 0; z < extent[2]; ++z)
    for (std::uint32_t y = 0; y < extent[1]; ++y)
      for (std::uint32_t x = 0; x < extent[0]; ++x) {
        const double u = 2.0 * x / extent[0] - 0.9, v = 2.0 * y / extent[1] - 1, w = 2.0 * z / extent[2] - 1.1;
        const double r = u * u + v * v + w * w, s = (u - 0.5) * (u - 0.5) + v * v + w * w;
        const auto noise = static_cast<std::int32_t>(random() % 7);
        samples.push_back(r > 0.6 ? 0 : static_cast<std::int32_t>(2000 * (1 - r) + (s < 0.1 ? 900 : 0)) + noise);
      }
  return samples;
}

std::vector<std::int32_t> samples_in(const SampleBricks& bricks) {
  const Extent extent = bricks.extent();
  std::vector<std::int32_t> samples(values::sample_count(extent));
  bricks.read({{}, extent}, samples.data(), extent[0], std::size_t{extent[0]} * extent[1]);
  return samples;
}

constexpr std::array<Extent, 6> kExtents{Extent{1, 1, 1},    Extent{17, 1, 1},   Extent{5, 40, 7},
                                         Extent{70, 50, 20}, Extent{33, 66, 35}, Extent{1, 90, 33}};

TEST_CASE("values: Repeating only the changed samples gives the same samples at every step and level") {
  for (const Extent extent : kExtents) {
    const auto encoded = test::encode_samples(bubbles(extent), extent, {});
    REQUIRE(encoded);
    std::mt19937 random(3);
    for (const int order : {0, 1}) {
      std::vector<Cluster> clusters = encoded->clusters;
      if (order == 1) std::shuffle(clusters.begin(), clusters.end(), random);
      ValuesDecoder decoder(extent);
      std::vector<std::int32_t> before;
      int level_before = -1;
      for (std::size_t i = 0; i < clusters.size();) {
        // Some steps have many clusters, most have one, and in the second order a few are lost.
        for (std::size_t n = random() % 9 == 0 ? 20 : 1; n > 0 && i < clusters.size(); --n, ++i)
          if (order == 0 || random() % 20 != 0) decoder.add(clusters[i]);
        if (clusters.size() > 200 && random() % 4 != 0) continue;
        const int level = random() % 3 == 0 ? static_cast<int>(random() % 3) : 0;
        std::vector<SampleBox> changed;
        const SampleBricks bricks = decoder.bricks(level, changed);
        std::vector<std::int32_t> now = samples_in(bricks);
        REQUIRE(now == decoder.samples(level));
        // Samples outside of the boxes are as before.
        if (level == level_before) {
          const Extent part = bricks.extent();
          std::vector<std::int32_t> rest = now;
          for (const SampleBox& box : changed)
            for (std::uint32_t z = box.first[2]; z < box.first[2] + box.size[2]; ++z)
              for (std::uint32_t y = box.first[1]; y < box.first[1] + box.size[1]; ++y) {
                const std::size_t at = (std::size_t{z} * part[1] + y) * part[0] + box.first[0];
                std::copy_n(before.begin() + static_cast<std::ptrdiff_t>(at), box.size[0],
                            rest.begin() + static_cast<std::ptrdiff_t>(at));
              }
          REQUIRE(rest == before);
        }
        before = std::move(now);
        level_before = level;
      }
    }
  }
}

TEST_CASE("values: Returned samples never change") {
  const Extent extent{70, 50, 40};
  const auto encoded = test::encode_samples(bubbles(extent), extent, {});
  REQUIRE(encoded);
  ValuesDecoder decoder(extent);
  std::vector<SampleBox> changed;
  std::vector<std::pair<SampleBricks, std::vector<std::int32_t>>> kept;
  for (std::size_t i = 0; i < encoded->clusters.size(); ++i) {
    decoder.add(encoded->clusters[i]);
    if (i % 10 != 0) continue;
    SampleBricks bricks = decoder.bricks(0, changed);
    std::vector<std::int32_t> samples = samples_in(bricks);
    kept.emplace_back(std::move(bricks), std::move(samples));
  }
  REQUIRE(kept.size() > 3);
  for (const auto& [bricks, samples] : kept) CHECK(samples_in(bricks) == samples);
}

struct Sent {
  StreamHeader header;
  std::vector<std::pair<ChunkType, std::vector<std::byte>>> chunks;
};

Sent sent_of(const VolumeSource& source, double error) {
  EncodeOptions options;
  options.tolerance.error = error;
  auto encoded = encode_values(source, options);
  REQUIRE(std::holds_alternative<EncodedStream>(encoded));
  Sent sent{std::get<EncodedStream>(encoded).header, {}};
  StreamReader reader;
  (void)reader.push(std::get<EncodedStream>(encoded).bytes,
                    [&](ChunkType type, std::span<const std::byte> payload, std::uint64_t) {
                      if (type != ChunkType::directory)
                        sent.chunks.emplace_back(type, std::vector<std::byte>(payload.begin(), payload.end()));
                    });
  return sent;
}

bool equal_vectors(const Volume& a, const Volume& b) {
  return a.positions == b.positions && a.normals == b.normals && a.weights == b.weights && a.classes == b.classes &&
         a.description.total == b.description.total;
}

// Vectors by place, without those with about the length at which the selection ends.
using VectorsByPlace = std::map<std::tuple<float, float, float>, std::tuple<float, float, float, float, int>>;
VectorsByPlace by_place(const Volume& volume, float above) {
  VectorsByPlace all;
  for (std::size_t i = 0; i < volume.size(); ++i) {
    const glm::vec3 &p = volume.positions[i], &n = volume.normals[i];
    if (volume.weights[i] > above) all[{p.x, p.y, p.z}] = {n.x, n.y, n.z, volume.weights[i], volume.classes[i]};
  }
  return all;
}

TEST_CASE("values: Vectors of changed cells are the same as from scratch, and as those of all values") {
  const VolumeSource source =
      test::volume_of(test::oblique(66, 50, 40), [](std::uint32_t x, std::uint32_t y, std::uint32_t z) {
        const float u = static_cast<float>(x) / 30 - 1, v = static_cast<float>(y) / 30 - 1,
                    w = static_cast<float>(z) / 30 - 0.6f, r = u * u + v * v + w * w;
        if (x > 55 && y > 40) return test::kNaN;
        return r > 0.7f ? 0.0f : 100 * (1 - r) + 30 * std::sin(20 * u) * std::cos(17 * v + w);
      });
  const Sent sent = sent_of(source, 0.5);
  REQUIRE(sent.chunks.size() > 40);
  std::mt19937 random(1);
  StreamDecoder decoder;
  (void)decoder.push(encode_header(sent.header));
  std::size_t begun = 0;
  for (std::size_t i = 0; i < sent.chunks.size();) {
    const std::size_t end = std::min(i + 1 + (random() % 4 == 0 ? random() % 8 : 0), sent.chunks.size());
    for (; i < end; ++i) decoder.add(sent.chunks[i].first, sent.chunks[i].second);
    const Geometry now = decoder.geometry_to_draw();
    const Volume& shown = *now.as<Volume>();
    StreamDecoder fresh;
    (void)fresh.push(encode_header(sent.header));
    for (std::size_t k = 0; k < end; ++k) fresh.add(sent.chunks[k].first, sent.chunks[k].second);
    const Geometry scratch = fresh.geometry();
    CHECK(equal_vectors(shown, *scratch.as<Volume>()));
    // The longest vectors of all values are the same. At the end of the selection, equal lengths may differ.
    GradientOptions options;
    options.range = shown.description.value_range;
    const auto all = gradient_vectors(shown.values->source, options);
    REQUIRE(std::holds_alternative<Volume>(all));
    const Volume& expected = std::get<Volume>(all);
    REQUIRE(shown.size() == expected.size());
    if (shown.size() == 0) continue;
    ++begun;
    const float shortest = *std::ranges::min_element(shown.weights);
    CHECK(shortest == *std::ranges::min_element(expected.weights));
    CHECK(by_place(shown, shortest) == by_place(expected, shortest));
    CHECK(shown.description.total == Approx(expected.description.total));
    for (std::size_t k = 1; k < shown.size(); ++k) CHECK(shown.weights[k] <= shown.weights[k - 1] * 1.01f);
  }
  CHECK(begun > 10);
}

}  // namespace changed_values_test
}  // namespace gs::qnv
