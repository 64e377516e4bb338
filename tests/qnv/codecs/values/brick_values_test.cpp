#include "qnv/codecs/values/bricks/brick_volume.h"
#include "qnv/codecs/values/decode/values_decoder.h"
#include "qnv/codecs/values/encode/values_stream.h"
#include "qnv/container/container.h"
#include "qnv/sampling/volume/volume_values.h"
#include "tests/qnv/volume_sources.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <random>
#include <span>
#include <type_traits>
#include <variant>
#include <vector>

namespace gs::qnv {
namespace brick_values_test {

using values::Extent;
using Bytes = std::vector<std::byte>;

/// Volume, and its stream.
struct Coded {
  Extent extent{};
  std::vector<double> numbers;  // a NaN for missing voxels
  EncodedStream stream;
};

// Cells of different values with noise. Voxels with u + v > `gaps`, from -1 to 1 each, are missing.
template <class Number>
Coded coded_cells(Extent extent, const ValueTolerance& tolerance, double gaps, double scale = 1) {
  VolumeLayout layout;
  layout.dimensions = extent;
  layout.type = std::is_same_v<Number, float>           ? VoxelType::f32
                : std::is_same_v<Number, std::uint16_t> ? VoxelType::u16
                                                        : VoxelType::u32;
  const auto none = static_cast<Number>(9999);
  if (gaps < 2) layout.missing = static_cast<double>(none);
  std::mt19937 random(7);
  Coded made;
  made.extent = extent;
  std::vector<Number> voxels;
  for (std::uint32_t z = 0; z < extent[2]; ++z)
    for (std::uint32_t y = 0; y < extent[1]; ++y)
      for (std::uint32_t x = 0; x < extent[0]; ++x) {
        const double u = 2.0 * x / extent[0] - 1, v = 2.0 * y / extent[1] - 1;
        const std::uint32_t cell = (x / 11) * 7 + (y / 11) * 5 + (z / 11) * 11;
        const double value = 300.0 * (cell * cell % 13) + static_cast<double>(random() % 60);
        voxels.push_back(u + v > gaps ? none : static_cast<Number>(value * scale));
        made.numbers.push_back(u + v > gaps ? std::nan("") : static_cast<double>(voxels.back()));
      }
  EncodeOptions options;
  options.tolerance = tolerance;
  auto encoded = encode_values(test::volume_of(layout, std::move(voxels)), options);
  REQUIRE(std::holds_alternative<EncodedStream>(encoded));
  made.stream = std::move(std::get<EncodedStream>(encoded));
  return made;
}

BrickLimits small_limits(const Extent& extent) {
  BrickLimits limits;
  limits.base_vectors = values::sample_count(extent) / 60 / values::kSamplesPerVector;
  return limits;
}

LodView reading_view(float pixels = 1e6f) {
  LodView view;
  view.eye = glm::vec3(-300, 20, 30);
  view.pixels = pixels;
  view.volume.exact = true;
  return view;
}

std::shared_ptr<const Volume> shown_by(BrickVolume& bricks, const LodView& view) {
  bool pending = false;
  auto volume = bricks.cut(view, pending);
  CHECK_FALSE(pending);
  return volume;
}

std::shared_ptr<BrickVolume> bricks_of(const Bytes& bytes, const Extent& extent) {
  auto opened = BrickVolume::open(memory_source(bytes), small_limits(extent));
  REQUIRE(std::holds_alternative<std::shared_ptr<BrickVolume>>(opened));
  return std::get<0>(opened);
}

/// Voxels of all bricks of level 0, without their margins.
struct Counts {
  std::size_t all = 0, bounded = 0, wrong = 0;
  double most = 0;  // error of the bounded ones
};
Counts count_errors(const Volume& volume, const Coded& source) {
  Counts counts;
  REQUIRE(volume.values);
  for (const ValueBrick& brick : volume.values->bricks) {
    if (brick.level != 0) continue;
    for (std::uint32_t z = brick.core_first[2]; z < brick.core_first[2] + brick.core_size[2]; ++z)
      for (std::uint32_t y = brick.core_first[1]; y < brick.core_first[1] + brick.core_size[1]; ++y)
        for (std::uint32_t x = brick.core_first[0]; x < brick.core_first[0] + brick.core_size[0]; ++x) {
          ++counts.all;
          const auto error = brick.error_of(x, y, z);
          if (!error) continue;
          ++counts.bounded;
          const double expected =
              source.numbers[(std::size_t{z} * source.extent[1] + y) * source.extent[0] + x];
          const auto value = static_cast<double>(brick.value(x, y, z));
          if (expected != expected) {
            counts.wrong += value == value ? 1 : 0;
            continue;
          }
          const double difference = std::abs(value - expected);
          counts.most = std::max(counts.most, difference);
          if (!(difference <= static_cast<double>(*error) * 1.0001)) ++counts.wrong;
        }
  }
  return counts;
}

ValueTolerance within(double error) {
  ValueTolerance tolerance;
  tolerance.error = error;
  return tolerance;
}
ValueTolerance no_loss() {
  ValueTolerance tolerance;
  tolerance.lossless = true;
  return tolerance;
}

TEST_CASE("bricks: Values that are read are within the error of the stream") {
  const Extent extent{150, 90, 70};
  for (const double gaps : {3.0, 1.2})
    for (const ValueTolerance& tolerance : {within(12), within(2), no_loss(), ValueTolerance()}) {
      const Coded source = coded_cells<std::uint16_t>(extent, tolerance, gaps);
      const auto bricks = bricks_of(source.stream.bytes, extent);
      const Counts counts = count_errors(*shown_by(*bricks, reading_view()), source);
      CHECK(counts.all > values::sample_count(extent) * 9 / 10);  // parts without vectors have no bricks
      CHECK(counts.bounded == counts.all);
      CHECK(counts.wrong == 0);
      if (tolerance.lossless) CHECK(counts.most == 0);
    }
}

TEST_CASE("bricks: Values of lossless streams of floats and wide integers are the stored ones") {
  const Extent extent{100, 90, 70};
  const Coded floats = coded_cells<float>(extent, no_loss(), 1.2, 1.0 / 7);
  const Counts of_floats = count_errors(*shown_by(*bricks_of(floats.stream.bytes, extent), reading_view()), floats);
  CHECK(of_floats.bounded == of_floats.all);
  CHECK(of_floats.all > values::sample_count(extent) / 2);
  CHECK(of_floats.wrong == 0);
  CHECK(of_floats.most == 0);
  const Coded wide = coded_cells<std::uint32_t>(extent, no_loss(), 3, 900'000);
  const Counts of_wide = count_errors(*shown_by(*bricks_of(wide.stream.bytes, extent), reading_view()), wide);
  CHECK(of_wide.bounded == values::sample_count(extent));
  // Values are floats, so that stored numbers of 32 bits are rounded.
  CHECK(of_wide.most <= 256);
}

TEST_CASE("bricks: Bricks at the border of a view keep the error, too") {
  const Extent extent{200, 150, 140};
  const Coded source = coded_cells<std::uint16_t>(extent, within(5), 3);
  const auto bricks = bricks_of(source.stream.bytes, extent);
  LodView near = reading_view(1100);
  near.eye = glm::vec3(0);
  near.planes[0] = glm::vec4(-1, 0, 0, 60);
  const Counts reading = count_errors(*shown_by(*bricks, near), source);
  CHECK(reading.all > 0);
  CHECK(reading.all < values::sample_count(extent) / 2);
  CHECK(reading.bounded == reading.all);
  CHECK(reading.wrong == 0);
  // A view that only draws needs no corrections, and promises nothing.
  near.volume.exact = false;
  const Counts drawing = count_errors(*shown_by(*bricks, near), source);
  CHECK(drawing.all == reading.all);
  CHECK(drawing.bounded == 0);
}

TEST_CASE("bricks: Without corrections, bricks state the error where all chunks were received") {
  const Extent extent{200, 150, 140};
  const Coded source = coded_cells<std::uint16_t>(extent, {}, 3);
  const auto bricks = bricks_of(source.stream.bytes, extent);
  LodView near = reading_view(1100);
  near.eye = glm::vec3(0);
  near.planes[0] = glm::vec4(-1, 0, 0, 60);
  near.volume.exact = false;
  const Counts drawing = count_errors(*shown_by(*bricks, near), source);
  CHECK(drawing.all > 0);
  CHECK(drawing.bounded > 0);
  CHECK(drawing.bounded < drawing.all);
  CHECK(drawing.wrong == 0);
}

TEST_CASE("bricks: Voxels of damaged chunks state no error") {
  const Extent extent{150, 90, 70};
  const Coded source = coded_cells<std::uint16_t>(extent, within(2), 3);
  for (const ChunkType damaged : {ChunkType::values, ChunkType::remainders}) {
    Bytes bytes = source.stream.bytes;
    std::mt19937 random(5);
    StreamReader reader;
    std::size_t count = 0;
    const auto take = [&](ChunkType type, std::span<const std::byte>, std::uint64_t offset) {
      if (type != damaged || offset < bytes.size() / 3 || random() % 30 != 0) return;
      bytes[static_cast<std::size_t>(offset) + kChunkHeaderBytes + 6] ^= std::byte{1};
      ++count;
    };
    reader.push(source.stream.bytes, take);
    reader.finish(take);
    REQUIRE(count > 0);
    const Counts counts = count_errors(*shown_by(*bricks_of(bytes, extent), reading_view()), source);
    CHECK(counts.bounded > 0);
    CHECK(counts.bounded < counts.all);
    CHECK(counts.wrong == 0);
    // Without the directory, nothing says which chunks are lost.
    bytes.resize(static_cast<std::size_t>(source.stream.header.directory));
    const Counts blind = count_errors(*shown_by(*bricks_of(bytes, extent), reading_view()), source);
    CHECK(blind.bounded == 0);
  }
}

TEST_CASE("bricks: Streams from servers get corrections only for values that are read") {
  const Extent extent{200, 150, 140};
  const Coded source = coded_cells<std::uint16_t>(extent, within(5), 3);
  const std::span<const std::byte> bytes = source.stream.bytes;
  BrickLimits limits = small_limits(extent);
  limits.arrived_bytes = 400'000;
  auto begun = BrickVolume::begin(bytes.first(8000), limits);
  REQUIRE(std::holds_alternative<std::shared_ptr<BrickVolume>>(begun));
  const auto bricks = std::get<0>(begun);
  REQUIRE(bricks->set_directory(bytes.subspan(static_cast<std::size_t>(bricks->directory()))));
  const auto receive = [&](const LodView& view) {
    std::size_t runs = 0;
    for (int round = 0; round < 100; ++round) {
      (void)shown_by(*bricks, view);
      const auto wanted = bricks->wanted();
      if (wanted.empty()) break;
      for (const ChunkRange& range : wanted) {
        const auto chunk =
            bytes.subspan(static_cast<std::size_t>(range.offset), static_cast<std::size_t>(range.bytes));
        if (chunk_head(chunk)->type == ChunkType::remainders) ++runs;
        bricks->add(range.offset, chunk);
      }
    }
    CHECK(bricks->wanted().empty());
    return runs;
  };
  LodView near = reading_view(1100);
  near.eye = glm::vec3(0);
  near.planes[0] = glm::vec4(0, 0, -1, 60);
  LodView drawing = near;
  drawing.volume.exact = false;
  CHECK(receive(drawing) == 0);
  CHECK(receive(near) > 0);
  const Counts counts = count_errors(*shown_by(*bricks, near), source);
  CHECK(counts.bounded == counts.all);
  CHECK(counts.wrong == 0);
  // A view of another part drops them, and gets them again.
  LodView far = near;
  far.eye = glm::vec3(199, 149, 139);
  far.planes[0] = glm::vec4(0, 0, 1, -130);
  CHECK(receive(far) > 0);
  CHECK(count_errors(*shown_by(*bricks, far), source).wrong == 0);
  CHECK(count_errors(*shown_by(*bricks, far), source).bounded > 0);
  CHECK(receive(near) > 0);
  CHECK(count_errors(*shown_by(*bricks, near), source).bounded == counts.bounded);
}

}  // namespace brick_values_test
}  // namespace gs::qnv
