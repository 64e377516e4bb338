#include "qnv/codecs/values/decode/values_slices.h"
#include "qnv/codecs/values/encode/values_stream.h"
#include "qnv/reader/stream_decoder.h"
#include "qnv/sampling/volume/color_voxels.h"
#include "qnv/sampling/volume/gradients.h"
#include "tests/qnv/pinned_vectors.h"
#include "tests/qnv/value_streams.h"
#include "tests/qnv/volume_sources.h"
#include "tests/watched.h"

#include <catch2/catch.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <random>
#include <sstream>
#include <string>
#include <variant>
#include <vector>

namespace gs::qnv {
namespace colors_test {

using test::oblique;
using test::values_in;
using test::volume_of;

// Soft ball: `together` 1 gives three colours that change together, 0 independent ones. The noise is the same
// in all colours.
VolumeSource painted(VolumeLayout layout, std::size_t count, double together, int noise = 0) {
  layout.type = VoxelType::u8;
  std::array<std::vector<std::uint8_t>, 4> planes;
  const auto [nx, ny, nz] = layout.dimensions;
  std::mt19937 random(3);
  for (std::uint32_t z = 0; z < nz; ++z)
    for (std::uint32_t y = 0; y < ny; ++y)
      for (std::uint32_t x = 0; x < nx; ++x) {
        const double u = 2.0 * x / nx - 1, v = 2.0 * y / ny - 1, w = 2.0 * z / nz - 1;
        const double ball = 1 / (1 + std::exp(12 * (std::sqrt(u * u + v * v + w * w) - 0.7)));
        const int grain = noise > 0 ? static_cast<int>(random() % static_cast<unsigned>(noise)) : 0;
        const std::array<double, 3> own{0.5 + 0.5 * std::sin(9 * u), 0.5 + 0.5 * std::sin(7 * v), 0.5 + 0.5 * w};
        for (std::size_t c = 0; c < 3; ++c) {
          const double color = ball * (together * 0.8 + (1 - together) * own[c]) * (1 - 0.1 * static_cast<double>(c));
          planes[c].push_back(static_cast<std::uint8_t>(std::clamp(static_cast<int>(color * 230) + grain, 0, 255)));
        }
        planes[3].push_back(static_cast<std::uint8_t>(255 * ball));
      }
  std::vector<VolumeSource> all;
  for (std::size_t c = 0; c < count; ++c) all.push_back(volume_of(layout, planes[c]));
  return color_source(std::move(all));
}

EncodedStream stream_of(const VolumeSource& source, const EncodeOptions& options = {}) {
  return test::encoded_stream(encode_values(source, options));
}
EncodeOptions within(double error) {
  EncodeOptions options;
  options.tolerance.error = error;
  return options;
}

Geometry decoded(std::span<const std::byte> bytes, const ShownComponent& shown = {}) {
  StreamDecoder decoder;
  decoder.show(shown);
  decoder.push(bytes);
  decoder.finish();
  REQUIRE(decoder.geometry().as<Volume>());
  REQUIRE(decoder.geometry().as<Volume>()->values);
  return decoder.geometry();
}

TEST_CASE("colors: Brightness and differences restore every colour") {
  for (int r = 0; r < 256; r += 5)
    for (int g = 0; g < 256; ++g)
      for (int b = 0; b < 256; b += 3) {
        const LumaColor luma = luma_of(r, g, b);
        REQUIRE_EACH(luma.y >= 0);
        REQUIRE_EACH(luma.y <= 255);
        REQUIRE_EACH(std::max(std::abs(luma.orange), std::abs(luma.green)) <= 255);
        REQUIRE_EACH(rgb_of(luma) == std::array{r, g, b});
      }
}

TEST_CASE("colors: A stream restores colours, and changes their form where that takes fewer bytes") {
  for (const std::size_t count : {std::size_t{3}, std::size_t{4}})
    for (const double together : {1.0, 0.0}) {
      const VolumeSource source = painted(oblique(40, 33, 21), count, together, together > 0 ? 9 : 0);
      const EncodedStream stream = stream_of(source);
      INFO(count << " " << together);
      CHECK(stream.header.grid.colors);
      CHECK(stream.header.grid.components == count);
      const Geometry geometry = decoded(stream.bytes);
      const VolumeValues& values = *geometry.as<Volume>()->values;
      CHECK(values.exact);
      REQUIRE(has_colors(values.source));
      REQUIRE(values.components.size() == count);
      const auto slices = test::slices_of(stream.bytes);
      REQUIRE(slices->components.size() == count);
      CHECK(values_in(values.source) == values_in(source));
      for (std::size_t c = 0; c < count; ++c) {
        CHECK(values_in(values.components[c]->source) == values_in(source.components[c]));
        CHECK(values_in(slices->components[c]->source) == values_in(source.components[c]));
      }
      if (together > 0) {
        VolumeSource plain = source;
        plain.layout.colors = false;
        CHECK(stream.header.grid.luma);
        CHECK(static_cast<double>(stream.bytes.size()) < 0.8 * static_cast<double>(stream_of(plain).bytes.size()));
      }
    }
}

TEST_CASE("colors: The permitted error holds for red, green, blue and opacity") {
  const VolumeSource source = painted(oblique(40, 33, 21), 4, 1, 30);
  for (const double error : {1.0, 2.0, 3.0, 4.0, 7.0, 20.0}) {
    const EncodedStream stream = stream_of(source, within(error));
    const Geometry geometry = decoded(stream.bytes);
    const VolumeValues& values = *geometry.as<Volume>()->values;
    INFO(error << " " << stream.header.grid.luma);
    REQUIRE(values.error);
    CHECK(*values.error <= static_cast<float>(error));
    const auto slices = test::slices_of(stream.bytes);
    for (std::size_t c = 0; c < 4; ++c) {
      const auto truth = values_in(source.components[c]), now = values_in(values.components[c]->source);
      for (std::size_t i = 0; i < truth.size(); ++i) REQUIRE_EACH(std::abs(truth[i] - now[i]) <= *values.error);
      CHECK(values_in(slices->components[c]->source) == now);
    }
  }
}

TEST_CASE("colors: Prefixes show all colours, and vectors have those of their voxels") {
  const VolumeSource source = painted(oblique(90, 80, 70), 3, 0.5);
  const EncodedStream stream = stream_of(source);
  for (const double part : {0.1, 0.4, 1.0}) {
    const auto bytes = static_cast<std::size_t>(part * static_cast<double>(stream.bytes.size()));
    StreamDecoder decoder;
    decoder.push(std::span(stream.bytes).first(bytes));
    const Geometry geometry = decoder.geometry();
    const Volume& volume = *geometry.as<Volume>();
    REQUIRE(volume.values);
    REQUIRE(volume.size() > 1000);
    REQUIRE(volume.colors.size() == volume.size());
    const VolumeLayout& layout = source.layout;
    std::array<std::vector<float>, 3> truth;
    for (std::size_t c = 0; c < 3; ++c) truth[c] = values_in(source.components[c]);
    const glm::dmat3 voxel_of =
        glm::inverse(glm::dmat3(glm::dvec3(layout.axes[0]), glm::dvec3(layout.axes[1]), glm::dvec3(layout.axes[2])));
    const double step =
        std::min({glm::length(layout.axes[0]), glm::length(layout.axes[1]), glm::length(layout.axes[2])});
    double squares = 0;
    for (std::size_t i = 0; i < volume.size(); ++i) {
      // The brightest voxel of three along the normal.
      std::array<double, 3> expected{};
      double most = -1;
      for (int k = 0; k < 3; ++k) {
        const glm::dvec3 place = glm::dvec3(volume.positions[i]) + glm::dvec3(volume.normals[i]) * (step * k);
        const glm::dvec3 at = glm::floor(voxel_of * (place - layout.origin) + 0.5);
        if (glm::any(glm::lessThan(at, glm::dvec3(0))) || at.x >= 90 || at.y >= 80 || at.z >= 70) continue;
        const auto voxel = static_cast<std::size_t>((at.z * 80 + at.y) * 90 + at.x);
        const auto number = [&](std::size_t c) { return static_cast<std::int32_t>(truth[c][voxel]); };
        const LumaColor luma = luma_of(number(0), number(1), number(2));
        if (luma.y <= most) continue;
        most = luma.y;
        for (std::size_t c = 0; c < 3; ++c) expected[c] = number(c);
      }
      const std::array<int, 3> color{volume.colors[i].r, volume.colors[i].g, volume.colors[i].b};
      for (std::size_t c = 0; c < 3; ++c) squares += std::pow(expected[c] - color[c], 2);
    }
    const double rms = std::sqrt(squares / static_cast<double>(3 * volume.size()));
    INFO(part << " " << rms);
    CHECK(rms <= (part == 1.0 ? 0.0 : part == 0.4 ? 6.0 : 25.0));
  }
}

TEST_CASE("colors: A chosen component is shown as numbers, and files have the colours of streams") {
  const VolumeSource source = painted(oblique(40, 33, 21), 3, 1);
  const EncodedStream stream = stream_of(source);
  for (std::uint32_t c = 0; c < 3; ++c) {
    const Geometry geometry = decoded(stream.bytes, {c, false, true});
    const Volume& volume = *geometry.as<Volume>();
    CHECK(volume.colors.empty());
    CHECK_FALSE(has_colors(volume.values->source));
    CHECK(values_in(volume.values->source) == values_in(source.components[c]));
  }
  const Geometry shown = decoded(stream.bytes);
  GradientOptions options;
  options.range = kColorRange;
  const auto found = gradient_vectors(source, options);
  const auto& vectors = std::get<Volume>(found);
  CHECK(vectors.colors.size() == vectors.size());
  CHECK(shown.size() == vectors.size());
  VolumeSource wide = source;
  wide.components.pop_back();
  CHECK_FALSE(has_colors(wide));
}

TEST_CASE("colors: Hostile headers and chunks give colours or are refused") {
  const EncodedStream stream = stream_of(painted(oblique(24, 20, 18), 3, 1, 9));
  const auto accepted = [](const StreamHeader& header) {
    std::size_t bytes = 0;
    bool more = false;
    return std::holds_alternative<StreamHeader>(decode_header(encode_header(header), bytes, more));
  };
  CHECK(accepted(stream.header));
  StreamHeader header = stream.header;
  header.grid.stored = VoxelType::u16;
  CHECK_FALSE(accepted(header));
  header = stream.header;
  header.grid.colors = false;
  CHECK_FALSE(accepted(header));
  header = stream.header;
  header.more_grids[0].colors = true;
  CHECK_FALSE(accepted(header));
  header = stream.header;
  header.grid.components = 2;
  header.more_grids.pop_back();
  CHECK_FALSE(accepted(header));
  std::mt19937 random(5);
  const std::size_t head = encode_header(stream.header).size();
  for (int round = 0; round < 60; ++round) {
    header = stream.header;
    ValueGrid& grid = random() % 2 == 0 ? header.grid : header.more_grids[random() % 2];
    grid.unit = std::ldexp(random() % 2 == 0 ? 1.0 : -1.0, static_cast<int>(random() % 2000) - 1000);
    grid.zero = std::ldexp(1.0, static_cast<int>(random() % 2000) - 1000);
    StreamDecoder decoder;
    (void)decoder.push(encode_header(header));
    std::vector<std::byte> bytes(stream.bytes.begin() + static_cast<std::ptrdiff_t>(head), stream.bytes.end());
    bytes[random() % bytes.size()] ^= std::byte{8};
    (void)decoder.push(bytes);
    decoder.finish();
    if (decoder.header()) CHECK(decoder.geometry().as<Volume>() != nullptr);
  }
  // A smaller stream, because each split point decodes all of it three times.
  const EncodedStream small = stream_of(painted(oblique(11, 9, 8), 3, 1, 9));
  for (std::size_t at = 0; at < small.bytes.size(); at += watched_step(53)) {
    StreamDecoder decoder;
    (void)decoder.push(std::span(small.bytes).first(at));
    (void)decoder.geometry();
    (void)decoder.push(std::span(small.bytes).subspan(at));
    decoder.finish();
    REQUIRE(decoder.geometry().as<Volume>()->values->exact);
  }
}

TEST_CASE("colors: FORMAT.md's stream decodes to the colours of an independent decoder") {
  const std::string name = "values_colors", expected = read_text(name + ".txt");
  REQUIRE(expected.size() > 5000);
  const Geometry geometry = decoded(read_bytes(name + ".qnv"));
  std::ostringstream out;
  REQUIRE(geometry.as<Volume>()->values->components.size() == 4);
  for (const auto& component : geometry.as<Volume>()->values->components)
    for (const float value : values_in(component->source)) out << value << '\n';
  CHECK(out.str() == expected);
  check_independent_decoder("values_decode.py", name, expected);
}

}  // namespace colors_test
}  // namespace gs::qnv
