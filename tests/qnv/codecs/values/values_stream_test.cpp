#include "qnv/codecs/values/encode/values_stream.h"
#include "qnv/codecs/encode.h"
#include "qnv/reader/stream_decoder.h"
#include "qnv/sampling/volume/gradients.h"
#include "qnv/sampling/volume/volume_slices.h"
#include "qnv/sampling/volume/volume_values.h"
#include "tests/qnv/pinned_vectors.h"
#include "tests/qnv/value_streams.h"
#include "tests/qnv/volume_sources.h"

#include <catch2/catch.hpp>

#include <bit>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <random>
#include <sstream>
#include <string>
#include <variant>
#include <vector>

namespace gs::qnv {
namespace values_stream_test {

using test::bits_of;
using test::oblique;
using test::values_in;
using test::volume_of;
using Shown = test::ShownValues;

EncodedStream stream_of(const VolumeSource& source, const EncodeOptions& options = {}) {
  return test::encoded_stream(encode_values(source, options));
}

template <class T>
VolumeSource ball_of(VolumeLayout layout, double height, VoxelType type) {
  std::mt19937 random(9);
  std::vector<T> voxels;
  const auto [nx, ny, nz] = layout.dimensions;
  for (std::uint32_t z = 0; z < nz; ++z)
    for (std::uint32_t y = 0; y < ny; ++y)
      for (std::uint32_t x = 0; x < nx; ++x) {
        const double u = 2.0 * x / nx - 0.9, v = 2.0 * y / ny - 1, w = 2.0 * z / nz - 1.1, r = u * u + v * v + w * w;
        const double noise = static_cast<double>(random() % 100) / 5000;
        voxels.push_back(static_cast<T>(r > 0.7 ? 0 : height * (1 - r + noise)));
      }
  layout.type = type;
  return volume_of(std::move(layout), std::move(voxels));
}

double apart(const std::vector<float>& a, const std::vector<float>& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    CHECK((a[i] != a[i]) == (b[i] != b[i]));
    if (a[i] == a[i]) most = std::max(most, std::abs(static_cast<double>(a[i]) - static_cast<double>(b[i])));
  }
  return most;
}

TEST_CASE("values: A lossless stream restores volumes of every type") {
  EncodeOptions options;
  options.tolerance.lossless = true;
  const VolumeLayout layout = oblique(37, 20, 18);
  const std::vector<VolumeSource> sources{
      ball_of<std::uint8_t>(layout, 250, VoxelType::u8),      ball_of<std::int8_t>(layout, -120, VoxelType::i8),
      ball_of<std::uint16_t>(layout, 60'000, VoxelType::u16), ball_of<std::int16_t>(layout, -30'000, VoxelType::i16),
      ball_of<std::uint32_t>(layout, 4e9, VoxelType::u32),    ball_of<std::int32_t>(layout, -2e9, VoxelType::i32),
      ball_of<float>(layout, 1e-3, VoxelType::f32),           ball_of<float>(layout, 1e30, VoxelType::f32)};
  for (const VolumeSource& source : sources) {
    INFO(static_cast<int>(source.layout.type));
    const EncodedStream stream = stream_of(source, options);
    const Shown shown(stream.bytes);
    CHECK(shown.decoder.refused_chunks() == 0);
    CHECK(shown.values->exact);
    CHECK(shown.values->error == 0.0f);
    CHECK(shown.values->level == 0);
    CHECK(bits_of(values_in(shown.values->source)) == bits_of(values_in(source)));
    CHECK(shown.values->source.layout.axes == source.layout.axes);
    CHECK(shown.values->source.layout.origin == source.layout.origin);
  }
}

TEST_CASE("values: Missing voxels stay missing, and slope and intercept hold") {
  VolumeLayout layout = oblique(30, 22, 17);
  layout.slope = 0.5;
  layout.intercept = -1000;
  VolumeSource source = ball_of<std::int16_t>(layout, 2000, VoxelType::i16);
  source.layout.missing = 0;
  const EncodedStream stream = stream_of(source);
  const Shown shown(stream.bytes);
  CHECK(stream.header.grid.gaps);
  CHECK(shown.values->missing == 0.0);
  CHECK(bits_of(values_in(shown.values->source)) == bits_of(values_in(source)));

  const VolumeSource floats = volume_of(oblique(40, 21, 18), [](std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    if (x > 30 && y > 10) return test::kNaN;
    return std::sin(static_cast<float>(x + 2 * y) / 9) * static_cast<float>(z);
  });
  EncodeOptions options;
  options.tolerance.lossless = true;
  CHECK(bits_of(values_in(Shown(stream_of(floats, options).bytes).values->source)) == bits_of(values_in(floats)));
}

TEST_CASE("values: The permitted error holds for every voxel of integers and floats, and the stream states it") {
  const VolumeLayout layout = oblique(60, 50, 40);
  for (const double error : {0.0, 0.001, 0.3, 4.0, 40.0}) {
    EncodeOptions options;
    options.tolerance.error = error;
    for (const VolumeSource& source :
         {ball_of<std::uint16_t>(layout, 3000, VoxelType::u16), ball_of<float>(layout, 900, VoxelType::f32)}) {
      const EncodedStream stream = stream_of(source, options);
      const Shown shown(stream.bytes);
      const double measured = apart(values_in(shown.values->source), values_in(source));
      INFO(error << " " << static_cast<int>(source.layout.type));
      CHECK(measured <= error);
      REQUIRE(shown.values->error);
      CHECK(static_cast<double>(*shown.values->error) <= error);
      CHECK(measured <= static_cast<double>(*shown.values->error));
    }
  }
  EncodeOptions share;
  share.tolerance = {0.01, true, false};
  const VolumeSource source = ball_of<std::uint16_t>(layout, 3000, VoxelType::u16);
  const double measured = apart(values_in(Shown(stream_of(source, share).bytes).values->source), values_in(source));
  CHECK(measured > 1);
  CHECK(measured <= 31);
}

TEST_CASE("values: covers the volume at every prefix, with decreasing error") {
  const VolumeSource source = ball_of<std::uint16_t>(oblique(60, 50, 40), 3000, VoxelType::u16);
  const std::vector<float> truth = values_in(source);
  const EncodedStream stream = stream_of(source);
  double before = std::numeric_limits<double>::max();
  for (std::size_t bytes = encode_header(stream.header).size(); bytes < stream.bytes.size(); bytes += 1777) {
    const Shown shown(std::span(stream.bytes).first(bytes));
    REQUIRE(voxel_box(shown.values->source.layout).lower.x >= voxel_box(source.layout).lower.x - 1e-3f);
    if (shown.values->level > 0) continue;
    const std::vector<float> values = values_in(shown.values->source);
    double sum = 0;
    for (std::size_t i = 0; i < truth.size(); ++i) sum += std::pow(static_cast<double>(truth[i] - values[i]), 2);
    CHECK(sum <= before * 1.05);
    before = sum;
  }
  CHECK(before < 1e7);
}

TEST_CASE("values: A stream in pieces of any size gives the same values") {
  const EncodedStream stream = stream_of(ball_of<std::uint8_t>(oblique(40, 30, 20), 250, VoxelType::u8));
  const std::vector<float> whole = values_in(Shown(stream.bytes).values->source);
  for (const std::size_t piece : {1u, 7u, 997u}) {
    StreamDecoder decoder;
    for (std::size_t at = 0; at < stream.bytes.size(); at += piece)
      REQUIRE(decoder.push(std::span(stream.bytes).subspan(at, std::min(piece, stream.bytes.size() - at))));
    const Geometry geometry = decoder.geometry_to_draw();
    CHECK(values_in(geometry.as<Volume>()->values->source) == whole);
  }
}

TEST_CASE("values: keeps the RMS error below 200 when a tenth of the chunks is lost") {
  const VolumeSource source = ball_of<std::uint16_t>(oblique(100, 90, 80), 3000, VoxelType::u16);
  const std::vector<float> truth = values_in(source);
  EncodeOptions options;
  options.tolerance.error = 20;
  const EncodedStream stream = stream_of(source, options);
  StreamDecoder decoder;
  StreamReader reader;
  std::mt19937 random(4);
  (void)decoder.push(encode_header(stream.header));
  (void)reader.push(stream.bytes, [&](ChunkType type, std::span<const std::byte> payload, std::uint64_t) {
    if (random() % 10 != 0) decoder.add(type, payload);
  });
  const Geometry geometry = decoder.geometry();
  const auto& values = *geometry.as<Volume>()->values;
  CHECK_FALSE(values.exact);
  CHECK_FALSE(values.error);
  REQUIRE(values.level == 0);
  const std::vector<float> decoded = values_in(values.source);
  double sum = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) sum += std::pow(static_cast<double>(truth[i] - decoded[i]), 2);
  CHECK(std::sqrt(sum / static_cast<double>(truth.size())) < 200);
}

TEST_CASE("values: A reader with little memory shows coarse values") {
  const EncodedStream stream = stream_of(ball_of<std::uint8_t>(oblique(64, 64, 64), 250, VoxelType::u8));
  const Shown shown(stream.bytes, 1000);
  CHECK(shown.decoder.full());
  CHECK(shown.values->level >= 1);
  CHECK(voxel_count(shown.values->source.layout) <= 8000);
  CHECK(shown.geometry.size() <= 1000);
}

TEST_CASE("values: The size of a stream can be limited") {
  const VolumeSource source = ball_of<std::uint16_t>(oblique(64, 50, 40), 3000, VoxelType::u16);
  for (const std::size_t bytes : {4000u, 20'000u}) {
    EncodeOptions options;
    options.max_bytes = bytes;
    const EncodedStream stream = stream_of(source, options);
    CHECK(stream.bytes.size() <= bytes);
    CHECK(stream.bytes.size() > bytes / 2);
    const Shown shown(stream.bytes);
    REQUIRE(shown.values->error);
    if (shown.values->level == 0)
      CHECK(apart(values_in(shown.values->source), values_in(source)) <= static_cast<double>(*shown.values->error));
  }
}

TEST_CASE("values: Volumes that cannot be encoded are refused") {
  const auto problem = [](const VolumeSource& source) {
    const auto encoded = encode_values(source, {});
    const auto* error = std::get_if<EncodeError>(&encoded);
    return error ? error->message : "";
  };
  const VolumeSource empty = volume_of(oblique(3, 3, 3), [](auto, auto, auto) { return test::kNaN; });
  CHECK(problem(empty) == "every voxel of the volume is missing; expected values");
  VolumeSource broken = ball_of<std::uint8_t>(oblique(9, 9, 9), 250, VoxelType::u8);
  broken.read = [](std::uint32_t z, std::span<std::byte>) { return z < 3; };
  CHECK(problem(broken) == "slice 3 of the volume cannot be read");
  broken.layout.dimensions = {4096, 4096, 4096};
  CHECK(problem(broken) == "the volume has 68719476736 voxels; expected at most 2147483648");
  VolumeSource flat = ball_of<std::uint8_t>(oblique(9, 9, 9), 0, VoxelType::u8);
  CHECK(values_in(Shown(stream_of(flat).bytes).values->source) == std::vector<float>(729, 0));
}

TEST_CASE("values: Encoding stops when cancelled") {
  Progress progress;
  progress.cancelled = true;
  const auto encoded = encode_values(ball_of<std::uint8_t>(oblique(40, 40, 40), 250, VoxelType::u8), {}, &progress);
  REQUIRE(std::holds_alternative<EncodeError>(encoded));
  CHECK(std::get<EncodeError>(encoded).message == "cancelled");
}

TEST_CASE("values: encode() chooses the values of a volume") {
  const VolumeSource source = ball_of<std::uint8_t>(oblique(20, 20, 20), 250, VoxelType::u8);
  const auto encoded = encode(std::cref(source), {});
  REQUIRE(std::holds_alternative<Encoding>(encoded));
  CHECK(std::get<Encoding>(encoded).payload->name == "values");
  CHECK(std::get<Encoding>(encoded).why == "the source is the values of a volume");
}

TEST_CASE("values: Damaged headers and chunks are refused or decode to something") {
  const EncodedStream stream = stream_of(ball_of<float>(oblique(30, 20, 17), 90, VoxelType::f32));
  std::vector<std::vector<std::byte>> payloads;
  std::vector<ChunkType> types;
  StreamReader reader;
  (void)reader.push(stream.bytes, [&](ChunkType type, std::span<const std::byte> payload, std::uint64_t) {
    types.push_back(type);
    payloads.emplace_back(payload.begin(), payload.end());
  });
  std::mt19937 random(8);
  for (int round = 0; round < 40; ++round) {
    StreamHeader header = stream.header;
    header.grid.gaps = header.grid.exact = random() % 2 == 0;
    if (header.grid.exact) header.grid.correction = 0;
    if (random() % 3 == 0) header.grid.dimensions[random() % 3] = 1 + random() % 100;
    StreamDecoder decoder(5000);
    (void)decoder.push(encode_header(header));
    for (std::size_t i = 0; i < payloads.size(); ++i) {
      auto bytes = payloads[i];
      if (random() % 2 == 0) bytes[random() % std::min<std::size_t>(bytes.size(), 16)] ^= std::byte(1u << random() % 8);
      if (random() % 9 == 0) bytes.resize(random() % (bytes.size() + 1));
      constexpr ChunkType kTypes[] = {ChunkType::values, ChunkType::gaps, ChunkType::remainders};
      decoder.add(random() % 4 == 0 ? kTypes[random() % 3] : types[i], bytes);
    }
    CHECK(decoder.geometry().as<Volume>() != nullptr);
  }
  ValueGrid grid = stream.header.grid;
  grid.axes[1] = grid.axes[0];
  CHECK_FALSE(sound(grid));
  grid = stream.header.grid;
  grid.unit = std::numeric_limits<double>::infinity();
  CHECK_FALSE(decode_value_grid(encode_value_grid(grid)));
  grid = stream.header.grid;
  grid.dimensions = {0xffffffff, 0xffffffff, 2};
  CHECK_FALSE(decode_value_grid(encode_value_grid(grid)));
  const std::vector<std::byte> section = encode_value_grid(stream.header.grid);
  CHECK(decode_value_grid(section) == stream.header.grid);
  for (std::size_t size = 0; size < 120; ++size) CHECK_FALSE(decode_value_grid(std::span(section).first(size)));
}

// Prints the decoded numbers as FORMAT.md's decoder does: samples, or codes of exact voxels.
std::string printed(const Shown& shown, const StreamHeader& header) {
  std::ostringstream out;
  const VolumeSource& source = shown.values->source;
  const std::size_t slice = slice_voxels(source.layout);
  std::vector<std::byte> stored(slice * size_of(source.layout.type));
  std::vector<double> numbers(slice);
  for (std::uint32_t z = 0; z < source.layout.dimensions[2]; ++z) {
    REQUIRE(source.read(z, stored));
    stored_numbers(source.layout, stored, numbers);
    for (const double number : numbers) {
      if (number != number) {
        out << "-\n";
      } else if (header.grid.exact) {
        const auto bits = std::bit_cast<std::uint32_t>(static_cast<float>(number));
        out << ((bits >> 31) != 0 ? ~bits : bits | 0x80000000u) << '\n';
      } else {
        out << static_cast<std::int64_t>(number) << '\n';
      }
    }
  }
  return out.str();
}

TEST_CASE("values: FORMAT.md's streams decode to the numbers of an independent decoder") {
  for (const std::string name : {"values_ball", "values_bounded", "values_floats", "values_parity"}) {
    INFO(name);
    const std::vector<std::byte> bytes = read_bytes(name + ".qnv");
    const std::string expected = read_text(name + ".txt");
    REQUIRE(expected.size() > 5000);
    const Shown shown(bytes);
    CHECK(printed(shown, *shown.decoder.header()) == expected);
    check_independent_decoder("values_decode.py", name, expected);
  }
}

}  // namespace values_stream_test
}  // namespace gs::qnv
