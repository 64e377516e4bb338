#include "qnv/codecs/values/bricks/brick_series.h"
#include "qnv/codecs/values/bricks/brick_volume.h"
#include "qnv/codecs/values/chunk_places.h"
#include "qnv/codecs/values/decode/values_decoder.h"
#include "qnv/codecs/values/encode/values_stream.h"
#include "qnv/sampling/volume/volume_values.h"
#include "tests/qnv/value_streams.h"
#include "tests/qnv/volume_sources.h"

#include <catch2/catch.hpp>

#include <cstdint>
#include <memory>
#include <random>
#include <span>
#include <variant>
#include <vector>

namespace gs::qnv {
namespace brick_series_test {

using values::Extent;
using Bytes = std::vector<std::byte>;

constexpr Extent kExtent{110, 70, 50};
constexpr std::uint32_t kSteps = 11;

// Cells with noise, of which some change from step to step. Voxels with u + v > `gaps`, from -1 to 1 each, are missing,
// a little more of them in each step.
VolumeSource changing_cells(double gaps) {
  std::vector<VolumeSource> steps;
  for (std::uint32_t step = 0; step < kSteps; ++step) {
    VolumeLayout layout;
    layout.dimensions = kExtent;
    layout.type = VoxelType::u16;
    if (gaps < 2) layout.missing = 9999;
    std::mt19937 random(7);
    std::vector<std::uint16_t> voxels;
    for (std::uint32_t z = 0; z < kExtent[2]; ++z)
      for (std::uint32_t y = 0; y < kExtent[1]; ++y)
        for (std::uint32_t x = 0; x < kExtent[0]; ++x) {
          const double u = 2.0 * x / kExtent[0] - 1, v = 2.0 * y / kExtent[1] - 1;
          std::uint32_t cell = (x / 11) * 7 + (y / 11) * 5 + (z / 11) * 11;
          if (x < 40) cell += step * (y / 11);
          const auto noise = static_cast<std::uint32_t>(random() % 60);
          const std::uint32_t value = 300 * (cell * cell % 13) + (x > 90 ? noise * (step + 1) : noise);
          voxels.push_back(static_cast<std::uint16_t>(u + v > gaps - 0.02 * step ? 9999 : value));
        }
    steps.push_back(test::volume_of(std::move(layout), std::move(voxels)));
  }
  VolumeSource source = steps.front();
  source.steps = std::move(steps);
  for (std::uint32_t step = 0; step < kSteps; ++step) source.times.push_back(step);
  return source;
}

EncodedStream stream_of(const VolumeSource& source) {
  EncodeOptions options;
  options.tolerance.lossless = true;
  return test::encoded_stream(encode_values(source, options));
}

BrickLimits small_limits(std::size_t part = 1) {
  BrickLimits limits;
  limits.base_vectors = part * values::sample_count(kExtent) / 60 / values::kSamplesPerVector;
  return limits;
}

LodView view_of_all() {
  LodView view;
  view.eye = glm::vec3(-300, 20, 30);
  view.pixels = 1e6f;
  view.volume.values = view.volume.exact = true;
  return view;
}

/// Voxels of all bricks of level 0, without their margins.
struct Compared {
  std::size_t all = 0, wrong = 0;
};
Compared compared(const Volume& volume, const VolumeSource& truth) {
  Compared counts;
  const std::vector<float> expected = test::values_in(truth);
  REQUIRE(volume.values);
  for (const ValueBrick& brick : volume.values->bricks) {
    if (brick.level != 0) continue;
    for (std::uint32_t z = brick.core_first[2]; z < brick.core_first[2] + brick.core_size[2]; ++z)
      for (std::uint32_t y = brick.core_first[1]; y < brick.core_first[1] + brick.core_size[1]; ++y)
        for (std::uint32_t x = brick.core_first[0]; x < brick.core_first[0] + brick.core_size[0]; ++x) {
          const float should = expected[(std::size_t{z} * kExtent[1] + y) * kExtent[0] + x], is = brick.value(x, y, z);
          ++counts.all;
          if (should != is && !(should != should && is != is)) ++counts.wrong;
        }
  }
  return counts;
}

std::shared_ptr<const Volume> shown_by(VolumeDetail& detail) {
  bool pending = false;
  auto volume = detail.cut(view_of_all(), pending);
  CHECK_FALSE(pending);
  return volume;
}

TEST_CASE("brick series: bricks of each step have its values, with and without gaps") {
  for (const double gaps : {3.0, 1.2}) {
    const VolumeSource source = changing_cells(gaps);
    const EncodedStream stream = stream_of(source);
    CHECK(BrickVolume::suits(stream.header, small_limits().base_vectors));
    // With the directory of places, and without a directory.
    Bytes cut = stream.bytes;
    cut.resize(static_cast<std::size_t>(stream.header.directory));
    for (const Bytes& bytes : {stream.bytes, cut})
      for (const std::uint32_t step : {0u, 1u, 5u, 7u, 8u, 10u}) {
        INFO(gaps << " " << step);
        auto opened = BrickVolume::open(memory_source(bytes), small_limits(), {}, step);
        REQUIRE(std::holds_alternative<std::shared_ptr<BrickVolume>>(opened));
        BrickVolume& bricks = *std::get<0>(opened);
        const auto volume = shown_by(bricks);
        CHECK(volume->values->step == step);
        CHECK(volume->values->times.size() == kSteps);
        CHECK(bricks.statistics().finest == 0);
        const Compared counts = compared(*volume, source.steps[step]);
        CHECK(counts.all > values::sample_count(kExtent) / 2);
        CHECK(counts.wrong == 0);
      }
  }
}

TEST_CASE("brick series: shows any step, and shares one that is shown twice") {
  const VolumeSource source = changing_cells(3);
  const EncodedStream stream = stream_of(source);
  const auto series =
      std::make_shared<BrickSeries>(memory_source(stream.bytes), stream.header, small_limits(4), nullptr);
  CHECK(series->times().size() == kSteps);
  for (const std::uint32_t step : {3u, 9u, 4u}) {
    const Geometry geometry = series->step({0, false, false, {step, {}}}),
                   again = series->step({0, false, false, {0, static_cast<double>(step)}});
    const auto* const volume = geometry.as<Volume>();
    REQUIRE(volume);
    REQUIRE(volume->detail);
    CHECK(volume->series == series);
    CHECK(volume->values->step == step);
    CHECK(again.as<Volume>()->detail == volume->detail);
    CHECK(compared(*shown_by(*volume->detail), source.steps[step]).wrong == 0);
  }
  CHECK(std::holds_alternative<StreamProblem>(series->open(kSteps)));
}

TEST_CASE("brick series: the directory has the places of all steps") {
  const EncodedStream stream = stream_of(changing_cells(1.2));
  const auto chunks = std::span(stream.bytes).subspan(static_cast<std::size_t>(stream.header.directory));
  const auto places = values::places_of(chunks, stream.header);
  REQUIRE(places);
  std::vector<std::uint32_t> counts(kSteps);
  const values::PlaceEntries entry_of(stream.header.grid, true);
  for (const values::ChunkPlace& place : *places) {
    const DirectoryEntry entry = entry_of(place);
    REQUIRE(entry.parent < kSteps);
    CHECK_FALSE(entry.box.empty());
    ++counts[entry.parent];
  }
  CHECK(counts == stream.header.steps.chunks);
}

}  // namespace brick_series_test
}  // namespace gs::qnv
