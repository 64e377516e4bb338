#include "qnv/codecs/values/decode/sample_limits.h"

#include "qnv/codecs/values/encode/values_stream.h"
#include "qnv/reader/stream_decoder.h"
#include "qnv/sampling/volume/volume_slices.h"
#include "qnv/sampling/volume/volume_values.h"
#include "tests/qnv/volume_sources.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <variant>
#include <vector>

namespace gs::qnv {
namespace sample_limits_test {

constexpr float kUnlimited = std::numeric_limits<float>::infinity(), kNotANumber = std::numeric_limits<float>::quiet_NaN();

// A ball of 255 in zeros. Truncated wavelets overshoot at its border.
VolumeSource step_volume() {
  VolumeLayout layout;
  layout.dimensions = {48, 40, 36};
  layout.type = VoxelType::u8;
  std::vector<std::uint8_t> voxels;
  for (int z = 0; z < 36; ++z)
    for (int y = 0; y < 40; ++y)
      for (int x = 0; x < 48; ++x) {
        const int u = x - 22, v = y - 19, w = z - 18;
        voxels.push_back(u * u + v * v + w * w < 200 ? 255 : 0);
      }
  return test::volume_of(std::move(layout), std::move(voxels));
}

}  // namespace sample_limits_test

using namespace sample_limits_test;

TEST_CASE("limits of samples are the ends of the value range") {
  CHECK(values::sample_limits({0, 255}, 1, 0) == values::SampleLimits{0, 255});
  CHECK(values::sample_limits({-1024, 3071}, 0.5, 0) == values::SampleLimits{-2048, 6142});
  CHECK(values::sample_limits({-1024, 3071}, -1, 0) == values::SampleLimits{-3071, 1024});
  CHECK(values::sample_limits({10, 20}, 2, 4) == values::SampleLimits{3, 8});
  // Numbers beyond the precision of float are not cut.
  CHECK(values::sample_limits({0, 2e9f}, 1, 0).most >= 2'000'000'000);
}

TEST_CASE("invalid value ranges do not limit samples") {
  const values::SampleLimits none;
  for (const auto& range :
       {std::pair{1.0f, 0.0f}, std::pair{kNotANumber, 1.0f}, std::pair{0.0f, kNotANumber}, std::pair{-kUnlimited, 1.0f},
        std::pair{0.0f, kUnlimited}})
    CHECK(values::sample_limits(range, 1, 0) == none);
  CHECK(values::sample_limits({0, 1}, 0, 0) == none);
  CHECK(values::sample_limits({0, 1}, std::nan(""), 0) == none);
  CHECK(values::sample_limits({0, 1}, 1, std::nan("")) == none);
  // Samples beyond 32 bits.
  CHECK(values::sample_limits({-3e38f, 3e38f}, 1, 0) == none);
  std::array<std::int32_t, 2> samples{std::numeric_limits<std::int32_t>::min(), std::numeric_limits<std::int32_t>::max()};
  const auto before = samples;
  none.apply(samples);
  CHECK(samples == before);
}

TEST_CASE("values of truncated streams stay in the range of their volume") {
  const auto encoded = encode_values(step_volume(), {});
  const auto* stream = std::get_if<EncodedStream>(&encoded);
  REQUIRE(stream);
  bool touched = false;
  for (std::size_t bytes = 1500; bytes < stream->bytes.size(); bytes += 1500) {
    StreamDecoder decoder;
    decoder.push(std::span(stream->bytes).first(bytes));
    const Geometry geometry = decoder.geometry();
    const auto* volume = geometry.as<Volume>();
    if (!volume || !volume->values) continue;
    const VolumeSource& source = volume->values->source;
    std::vector<std::byte> scratch;
    std::vector<float> slice(slice_voxels(source.layout));
    for (std::uint32_t z = 0; z < source.layout.dimensions[2]; ++z) {
      REQUIRE(read_slice(source, z, scratch, slice));
      const auto [least, most] = std::ranges::minmax(slice);
      REQUIRE(least >= 0);
      REQUIRE(most <= 255);
      touched = touched || (least == 0 && most == 255);
    }
  }
  CHECK(touched);
}

}  // namespace gs::qnv
