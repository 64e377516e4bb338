#include "qnv/codecs/octree/lod/lod_source.h"
#include "qnv/codecs/payloads.h"
#include "qnv/codecs/shared/volume_series.h"
#include "qnv/codecs/values/decode/values_slices.h"
#include "qnv/codecs/values/labels/encode/label_stream.h"
#include "qnv/codecs/values/labels/label_runs.h"
#include "qnv/reader/directory_requests.h"
#include "qnv/reader/stream_decoder.h"
#include "qnv/sampling/volume/volume_slices.h"
#include "qnv/sampling/volume/volume_values.h"
#include "tests/qnv/pinned_vectors.h"
#include "tests/qnv/value_streams.h"
#include "tests/qnv/volume_sources.h"

#include <catch2/catch.hpp>

#include <cstdint>
#include <random>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace gs::qnv {
namespace label_series_test {

using test::oblique;
using test::volume_of;
using Shown = test::ShownValues;

/// Shape of a series: a still shell, with a ball of another label that moves in some steps.
struct MovingLabels {
  VolumeLayout layout = oblique(40, 28, 21);
  std::uint32_t steps = 10;
  bool moves = true;
  std::uint32_t scattered = 0;  // one of so many voxels has another label; 0 means none
};

VolumeSource series_of(const MovingLabels& shape) {
  std::vector<VolumeSource> steps;
  const auto [nx, ny, nz] = shape.layout.dimensions;
  for (std::uint32_t step = 0; step < shape.steps; ++step) {
    std::vector<std::uint8_t> voxels;
    const double place = shape.moves ? (step == 5 ? 4 : step) : 0;
    for (std::uint32_t z = 0; z < nz; ++z)
      for (std::uint32_t y = 0; y < ny; ++y)
        for (std::uint32_t x = 0; x < nx; ++x) {
          const double u = 2.0 * x / nx - 1, v = 2.0 * y / ny - 1, w = 2.0 * z / nz - 1;
          const double r = u * u + v * v + w * w,
                       ball = (u + 0.5 - 0.1 * place) * (u + 0.5 - 0.1 * place) + v * v + w * w;
          std::uint8_t label = ball < 0.08 ? 5 : r > 0.9 ? 0 : r > 0.7 ? 2 : 3;
          if (shape.scattered > 0 && (x * 7919 + y * 104729 + z * 1299709) % shape.scattered == 0) label = 9;
          voxels.push_back(label);
        }
    VolumeLayout layout = shape.layout;
    layout.type = VoxelType::u8;
    layout.labels = true;
    steps.push_back(volume_of(std::move(layout), std::move(voxels)));
  }
  VolumeSource source = steps.front();
  source.steps = std::move(steps);
  for (std::uint32_t step = 0; step < shape.steps; ++step) source.times.push_back(0.5 * step);
  return source;
}

EncodedStream stream_of(const VolumeSource& source) { return test::encoded_stream(encode_labels(source, {})); }

std::shared_ptr<const VolumeValues> shown_step(const StreamDecoder& decoder, std::uint32_t step) {
  const Geometry geometry = decoder.geometry();
  const auto* const volume = geometry.as<Volume>();
  REQUIRE(volume);
  REQUIRE(volume->series);
  const Geometry made = volume->series->step({0, false, false, {step, {}}});
  REQUIRE(made.as<Volume>()->values);
  return made.as<Volume>()->values;
}

TEST_CASE("label series: all steps are restored in any order") {
  for (const MovingLabels& shape :
       {MovingLabels{}, MovingLabels{oblique(40, 28, 21), 17, true, 11}, MovingLabels{oblique(5, 1, 1), 9, true, 0}}) {
    const VolumeSource source = series_of(shape);
    const EncodedStream stream = stream_of(source);
    CHECK(stream.header.steps.times.size() == shape.steps);
    StreamDecoder decoder(std::size_t{1} << 20);
    CHECK(decoder.push(stream.bytes));
    decoder.finish();
    CHECK(decoder.refused_chunks() == 0);
    std::vector<std::uint32_t> order{0, 1, 2, 5, 3, 8, 7, 0};
    if (shape.steps > 16) order.push_back(16);
    for (const std::uint32_t step : order) {
      INFO(step);
      const auto values = shown_step(decoder, step);
      CHECK(values->step == step);
      CHECK(values->exact);
      CHECK(values->wrong == 0.0f);
      CHECK(test::values_in(values->source) == test::values_in(source.steps[step]));
    }
    const auto slices = test::slices_of(stream.bytes);
    REQUIRE(slices->steps.size() == shape.steps);
    for (std::uint32_t step = 0; step < shape.steps; ++step) {
      INFO(step);
      CHECK(slices->steps[step]->exact);
      CHECK(test::values_in(slices->steps[step]->source) == test::values_in(source.steps[step]));
    }
  }
}

TEST_CASE("label series: labels that do not change cost almost nothing") {
  MovingLabels still;
  still.moves = false;
  still.scattered = 41;
  still.steps = 8;
  VolumeSource one = series_of(still).steps.front();
  const std::size_t alone = stream_of(one).bytes.size(), all = stream_of(series_of(still)).bytes.size();
  CHECK(all < alone + 500);
  // A ball that moves costs less than its surroundings.
  still.moves = true;
  CHECK(stream_of(series_of(still)).bytes.size() < 4 * alone);
}

TEST_CASE("label series: a lost chunk costs one box at one level, up to the end of its chain") {
  const VolumeSource source = series_of({oblique(40, 28, 21), 10, true, 41});
  const EncodedStream stream = stream_of(source);
  const auto chunks = test::content_chunks(stream.bytes);
  REQUIRE(chunks.size() > 20);
  for (std::size_t lost = 0; lost < chunks.size(); lost += 7) {
    INFO(lost);
    const auto run = values::parse_label_run(chunks[lost].second);
    REQUIRE(run);
    auto decoder = row_of(stream.header).decoder(stream.header, std::size_t{1} << 20);
    for (std::size_t i = 0; i < chunks.size(); ++i)
      if (i != lost) decoder->add(chunks[i].first, chunks[i].second, {});
    const Geometry geometry = decoder->geometry({stream.header.description, {}});
    const auto series = geometry.as<Volume>()->series;
    REQUIRE(series);
    std::size_t exact = 0;
    for (std::uint32_t step = 0; step < 10; ++step) {
      const auto values = series->step({0, false, false, {step, {}}}).as<Volume>()->values;
      REQUIRE(values);
      if (!values->exact) continue;
      ++exact;
      CHECK(test::values_in(values->source) == test::values_in(source.steps[step]));
    }
    CHECK(exact >= 2);
    CHECK(exact < 10);
    // The chunk may come later.
    decoder->add(chunks[lost].first, chunks[lost].second, {});
    for (const std::uint32_t step : {9u, 3u}) {
      const auto values = series->step({0, false, false, {step, {}}}).as<Volume>()->values;
      CHECK(values->exact);
      CHECK(test::values_in(values->source) == test::values_in(source.steps[step]));
    }
  }
}

TEST_CASE("label series: one step needs only the chunks of its chain") {
  const EncodedStream stream = stream_of(series_of({oblique(40, 28, 21), 10, true, 41}));
  const auto directory = std::span(stream.bytes).subspan(static_cast<std::size_t>(stream.header.directory));
  for (const std::uint32_t step : {0u, 3u, 9u}) {
    DirectoryRequests requests(stream.header, step);
    REQUIRE(requests.set_directory(directory));
    auto decoder = row_of(stream.header).decoder(stream.header, std::size_t{1} << 20);
    std::uint32_t expected = 0;
    for (std::uint32_t s = step / 8 * 8; s <= step; ++s) expected += stream.header.steps.chunks[s];
    const auto wanted = requests.wanted();
    CHECK(wanted.size() == expected);
    for (const ChunkRange& range : wanted) {
      const auto chunk =
          sound_chunk(std::span(stream.bytes)
                          .subspan(static_cast<std::size_t>(range.offset), static_cast<std::size_t>(range.bytes)));
      REQUIRE(std::holds_alternative<SoundChunk>(chunk));
      decoder->add(std::get<SoundChunk>(chunk).type, std::get<SoundChunk>(chunk).payload, {});
    }
    const Geometry geometry = decoder->geometry({stream.header.description, {}});
    const Geometry shown = geometry.as<Volume>()->series->step({0, false, false, {step, {}}});
    CHECK(shown.as<Volume>()->values->exact);
  }
}

TEST_CASE("label series: mutated streams leave the decoder in a valid state") {
  const EncodedStream stream = stream_of(series_of({oblique(21, 18, 9), 10, true, 31}));
  std::mt19937 random(5);
  for (const auto& [type, payload] : test::content_chunks(stream.bytes)) {
    auto decoder = row_of(stream.header).decoder(stream.header, std::size_t{1} << 16);
    for (int i = 0; i < 8; ++i) {
      std::vector<std::byte> wrong = payload;
      wrong[random() % std::min<std::size_t>(wrong.size(), i < 4 ? 6 : wrong.size())] ^=
          static_cast<std::byte>(1u << random() % 8);
      decoder->add(type, wrong, {});
    }
    const Geometry geometry = decoder->geometry({stream.header.description, {}});
    for (const std::uint32_t step : {0u, 9u})
      CHECK(geometry.as<Volume>()->series->step({0, false, false, {step, {}}}).as<Volume>()->values);
  }
}

TEST_CASE("label series: refuses steps of different sizes") {
  VolumeSource source = series_of({});
  source.steps[3] = series_of({oblique(40, 28, 20)}).steps[3];
  const auto encoded = encode_labels(source, {});
  REQUIRE(std::holds_alternative<EncodeError>(encoded));
  CHECK(std::get<EncodeError>(encoded).message.find("different sizes") != std::string::npos);
}

TEST_CASE("label series: FORMAT.md's stream decodes to the codes of an independent decoder") {
  const std::string name = "values_label_series";
  const std::string expected = read_text(name + ".txt");
  REQUIRE(expected.size() > 5000);
  const std::vector<std::byte> bytes = read_bytes(name + ".qnv");
  const auto slices = test::slices_of(bytes);
  REQUIRE(slices->steps.size() == 10);
  std::ostringstream out;
  for (const auto& step : slices->steps) {
    CHECK(step->exact);
    for (const float number : test::values_in(step->source)) out << static_cast<std::uint32_t>(number) << '\n';
  }
  CHECK(out.str() == expected);
  check_independent_decoder("values_decode.py", name, expected);
}

}  // namespace label_series_test
}  // namespace gs::qnv
