#include "qnv/codecs/payloads.h"
#include "qnv/codecs/values/component_number.h"
#include "qnv/codecs/values/decode/values_slices.h"
#include "qnv/codecs/values/encode/values_stream.h"
#include "qnv/reader/stream_decoder.h"
#include "qnv/sampling/volume/volume_slices.h"
#include "qnv/sampling/volume/volume_values.h"
#include "tests/qnv/pinned_vectors.h"
#include "tests/qnv/value_streams.h"
#include "tests/qnv/volume_sources.h"
#include "tests/watched.h"

#include <catch2/catch.hpp>

#include <bit>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <random>
#include <sstream>
#include <string>
#include <variant>
#include <vector>

namespace gs::qnv {
namespace components_test {

using test::bits_of;
using test::oblique;
using test::values_in;
using test::volume_of;

// Whirl around an axis: component c of the voxel. Component 3 and more are smaller.
double whirl(const VolumeLayout& layout, std::size_t c, std::uint32_t x, std::uint32_t y, std::uint32_t z) {
  const auto [nx, ny, nz] = layout.dimensions;
  const double u = 2.0 * x / nx - 1, v = 2.0 * y / ny - 1, w = 2.0 * z / nz - 1, r = u * u + v * v + 0.2;
  return c == 0 ? -v / r : c == 1 ? u / r : c == 2 ? 0.3 * w : 0.01 * (u + v * static_cast<double>(c));
}

template <class T>
VolumeSource whirl_of(VolumeLayout layout, VoxelType type, std::size_t components, double scale, double shift = 0) {
  layout.type = type;
  std::vector<VolumeSource> all;
  for (std::size_t c = 0; c < components; ++c) {
    std::vector<T> voxels;
    for (std::uint32_t z = 0; z < layout.dimensions[2]; ++z)
      for (std::uint32_t y = 0; y < layout.dimensions[1]; ++y)
        for (std::uint32_t x = 0; x < layout.dimensions[0]; ++x)
          voxels.push_back(static_cast<T>(whirl(layout, c, x, y, z) * scale + shift));
    all.push_back(volume_of(layout, std::move(voxels)));
  }
  VolumeSource source = all.front();
  source.components = std::move(all);
  return source;
}

EncodedStream stream_of(const VolumeSource& source, const EncodeOptions& options = {}) {
  return test::encoded_stream(encode_values(source, options));
}

std::shared_ptr<const VolumeValues> values_of(const Geometry& geometry) {
  const auto* volume = geometry.as<Volume>();
  REQUIRE(volume);
  REQUIRE(volume->values);
  return volume->values;
}
std::shared_ptr<const VolumeValues> decoded(std::span<const std::byte> bytes, const ShownComponent& shown = {}) {
  StreamDecoder decoder;
  decoder.show(shown);
  decoder.push(bytes);
  decoder.finish();
  return values_of(decoder.geometry());
}

TEST_CASE("components: A lossless stream restores all numbers of every type") {
  EncodeOptions options;
  options.tolerance.lossless = true;
  const VolumeLayout layout = oblique(37, 20, 18);
  VolumeSource gaps = whirl_of<float>(layout, VoxelType::f32, 3, 10);
  gaps.components[1] = volume_of(layout, [&](std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    return x > 30 ? test::kNaN : static_cast<float>(whirl(layout, 1, x, y, z) * 10);
  });
  const std::vector<VolumeSource> sources{whirl_of<std::uint8_t>(layout, VoxelType::u8, 3, 100, 120),
                                          whirl_of<std::int16_t>(layout, VoxelType::i16, 2, 10'000),
                                          whirl_of<std::uint32_t>(layout, VoxelType::u32, 4, 1e8, 2e9),
                                          whirl_of<float>(layout, VoxelType::f32, 9, 1e-3),
                                          whirl_of<float>(layout, VoxelType::f32, 16, 1e9),
                                          gaps};
  for (const VolumeSource& source : sources) {
    INFO(static_cast<int>(source.layout.type) << " " << source.components.size());
    const EncodedStream stream = stream_of(source, options);
    const auto values = decoded(stream.bytes);
    REQUIRE(values->components.size() == source.components.size());
    const auto opened = open_values_slices({stream.bytes.size(), [&](std::uint64_t offset, std::span<std::byte> to) {
                                              std::memcpy(to.data(), stream.bytes.data() + offset, to.size());
                                              return true;
                                            }});
    const auto* slices = std::get_if<std::shared_ptr<const VolumeValues>>(&opened);
    REQUIRE(slices);
    REQUIRE((*slices)->components.size() == source.components.size());
    for (std::size_t c = 0; c < source.components.size(); ++c) {
      CHECK(values->components[c]->exact);
      CHECK((*slices)->components[c]->exact);
      const auto truth = bits_of(values_in(source.components[c]));
      CHECK(bits_of(values_in(values->components[c]->source)) == truth);
      CHECK(bits_of(values_in((*slices)->components[c]->source)) == truth);
    }
  }
}

TEST_CASE("components: The permitted error holds for each component, and the stream states it") {
  const VolumeSource source = whirl_of<float>(oblique(50, 40, 30), VoxelType::f32, 3, 100);
  EncodeOptions options;
  options.tolerance.error = 0.25;
  const auto values = decoded(stream_of(source, options).bytes);
  for (std::size_t c = 0; c < 3; ++c) {
    const auto truth = values_in(source.components[c]), now = values_in(values->components[c]->source);
    REQUIRE(values->components[c]->error);
    CHECK(*values->components[c]->error <= 0.25f);
    for (std::size_t i = 0; i < truth.size(); ++i)
      REQUIRE_EACH(std::abs(static_cast<double>(truth[i]) - static_cast<double>(now[i])) <= 0.25);
  }
}

TEST_CASE("components: Prefixes have all components, the most important parts first") {
  const VolumeSource source = whirl_of<std::int16_t>(oblique(80, 70, 60), VoxelType::i16, 4, 10'000);
  const EncodedStream stream = stream_of(source);
  const auto errors = [&](std::size_t bytes) {
    StreamDecoder decoder;
    decoder.push(std::span(stream.bytes).first(bytes));
    const auto values = values_of(decoder.geometry());
    std::vector<double> squares;
    for (std::size_t c = 0; c < 4; ++c) {
      REQUIRE(values->components[c]->level == 0);
      const auto truth = values_in(source.components[c]), now = values_in(values->components[c]->source);
      double sum = 0;
      for (std::size_t i = 0; i < truth.size(); ++i) sum += std::pow(static_cast<double>(truth[i] - now[i]), 2);
      squares.push_back(std::sqrt(sum / static_cast<double>(truth.size())));
    }
    return squares;
  };
  const auto early = errors(stream.bytes.size() / 10), late = errors(stream.bytes.size() / 2);
  // Errors have one unit, so that the large components do not wait for the small one.
  for (std::size_t c = 0; c < 4; ++c) CHECK(early[c] < 700);
  CHECK(late[0] + late[1] < 0.7 * (early[0] + early[1]));
  EncodeOptions small;
  small.max_bytes = 9000;
  const EncodedStream cut = stream_of(source, small);
  CHECK(cut.bytes.size() <= 9000);
  CHECK(decoded(cut.bytes)->components.size() == 4);
}

TEST_CASE("components: Readers show one component, or the length of the vector") {
  const VolumeSource source = whirl_of<std::int16_t>(oblique(40, 30, 20), VoxelType::i16, 3, 9000);
  EncodeOptions options;
  options.tolerance.lossless = true;
  const EncodedStream stream = stream_of(source, options);
  for (std::uint32_t c = 0; c < 3; ++c) {
    const auto values = decoded(stream.bytes, {c, false});
    CHECK(values_in(values->source) == values_in(source.components[c]));
    CHECK(values->components.size() == 3);
  }
  CHECK(values_in(decoded(stream.bytes, {77, false})->source) == values_in(source.components[2]));
  const auto length = decoded(stream.bytes, {0, true});
  const auto x = values_in(source.components[0]), y = values_in(source.components[1]),
             z = values_in(source.components[2]), now = values_in(length->source);
  for (std::size_t i = 0; i < now.size(); ++i)
    REQUIRE_EACH(now[i] == Approx(std::sqrt(x[i] * x[i] + y[i] * y[i] + z[i] * z[i])));
  CHECK(length->exact);
  // The choice may change while the stream arrives.
  StreamDecoder decoder;
  (void)decoder.push(std::span(stream.bytes).first(stream.bytes.size() / 2));
  CHECK(decoder.geometry().size() > 0);
  decoder.show({2, false});
  (void)decoder.push(std::span(stream.bytes).subspan(stream.bytes.size() / 2));
  CHECK(values_in(values_of(decoder.geometry())->source) == z);
}

TEST_CASE("components: Every prefix, split point and flipped bit leaves a valid volume") {
  const VolumeSource source = whirl_of<std::uint8_t>(oblique(9, 6, 5), VoxelType::u8, 3, 100, 120);
  const EncodedStream stream = stream_of(source);
  const auto truth = values_in(source.components[1]);
  for (std::size_t at = 0; at <= stream.bytes.size(); at += watched_step(7)) {
    StreamDecoder decoder;
    (void)decoder.push(std::span(stream.bytes).first(at));
    (void)decoder.geometry();
    (void)decoder.push(std::span(stream.bytes).subspan(at));
    decoder.finish();
    const auto values = values_of(decoder.geometry());
    REQUIRE(values->components.size() == 3);
    REQUIRE(values_in(values->components[1]->source) == truth);
  }
  const std::size_t head = encode_header(stream.header).size();
  for (std::size_t bit = head * 8; bit < stream.header.directory * 8; bit += watched_step(31)) {
    std::vector<std::byte> bytes = stream.bytes;
    bytes[bit / 8] ^= std::byte(1u << bit % 8);
    StreamDecoder decoder;
    (void)decoder.push(bytes);
    decoder.finish();
    REQUIRE(values_of(decoder.geometry())->components.size() == 3);
  }
}

TEST_CASE("components: Hostile payloads and headers are refused") {
  const EncodedStream stream = stream_of(whirl_of<std::int16_t>(oblique(40, 30, 20), VoxelType::i16, 3, 9000));
  const auto chunks = test::content_chunks(stream.bytes);
  std::mt19937 random(8);
  for (int round = 0; round < 40; ++round) {
    StreamHeader header = stream.header;
    header.grid.exact = random() % 2 == 0;
    if (header.grid.exact) header.grid.correction = 0;
    if (random() % 3 == 0) {
      header.grid.dimensions[random() % 3] = 1 + random() % 100;
      for (ValueGrid& grid : header.more_grids) grid.dimensions = header.grid.dimensions;
    }
    StreamDecoder decoder(5000);
    (void)decoder.push(encode_header(header));
    for (auto [type, bytes] : chunks) {
      if (random() % 2 == 0) bytes[random() % std::min<std::size_t>(bytes.size(), 12)] ^= std::byte(1u << random() % 8);
      if (random() % 9 == 0) bytes.resize(random() % (bytes.size() + 1));
      constexpr ChunkType kTypes[] = {ChunkType::values, ChunkType::gaps, ChunkType::remainders, ChunkType::labels};
      decoder.add(random() % 4 == 0 ? kTypes[random() % 4] : type, bytes);
    }
    CHECK(decoder.geometry().as<Volume>() != nullptr);
  }
  const auto accepted = [](const StreamHeader& header) {
    std::size_t bytes = 0;
    bool more = false;
    return std::holds_alternative<StreamHeader>(decode_header(encode_header(header), bytes, more));
  };
  CHECK(accepted(stream.header));
  StreamHeader header = stream.header;
  header.more_grids.pop_back();
  CHECK_FALSE(accepted(header));
  header = stream.header;
  header.grid.components = 17;
  CHECK_FALSE(accepted(header));
  header = stream.header;
  header.more_grids[1].dimensions[0] += 1;
  CHECK_FALSE(accepted(header));
  header = stream.header;
  header.grid.components = 0;
  CHECK_FALSE(accepted(header));
  CHECK_FALSE(values::without_component({}, 5));
  const auto encoded = encode_values(whirl_of<float>(oblique(5, 5, 5), VoxelType::f32, 17, 1), {});
  REQUIRE(std::holds_alternative<EncodeError>(encoded));
  CHECK(std::get<EncodeError>(encoded).message.find("at most 16") != std::string::npos);
}

TEST_CASE("components: FORMAT.md's stream decodes to the numbers of an independent decoder") {
  const std::string name = "values_components", expected = read_text(name + ".txt");
  REQUIRE(expected.size() > 5000);
  const auto values = decoded(read_bytes(name + ".qnv"));
  std::ostringstream out;
  REQUIRE(values->components.size() == 3);
  for (const auto& component : values->components) {
    CHECK(component->exact);
    for (const float value : values_in(component->source)) {
      const auto bits = std::bit_cast<std::uint32_t>(value);
      out << ((bits >> 31) != 0 ? ~bits : bits | 0x80000000u) << '\n';
    }
  }
  CHECK(out.str() == expected);
  check_independent_decoder("values_decode.py", name, expected);
}

}  // namespace components_test
}  // namespace gs::qnv
