#include "qnv/reader/step_order.h"

#include "qnv/codecs/octree/lod/lod_source.h"
#include "qnv/codecs/shared/volume_series.h"
#include "qnv/codecs/values/encode/values_stream.h"
#include "qnv/container/step_table.h"
#include "qnv/reader/directory_requests.h"
#include "qnv/reader/stream_decoder.h"
#include "tests/qnv/value_streams.h"
#include "tests/qnv/volume_sources.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

namespace gs::qnv {
namespace step_order_test {

TEST_CASE("step order: The direction of play follows from the steps that a view shows") {
  CHECK_FALSE(plays_backwards(3, 4, 20));
  CHECK(plays_backwards(4, 3, 20));
  CHECK_FALSE(plays_backwards(19, 0, 20));
  CHECK(plays_backwards(0, 19, 20));
  CHECK_FALSE(plays_backwards(2, 12, 20));
  CHECK(plays_backwards(12, 2, 20));
  CHECK_FALSE(plays_backwards(1, 0, 2));
  CHECK_FALSE(plays_backwards(0, 0, 0));
}

TEST_CASE("step order: Chains of shown steps come first, then the next steps, then the others") {
  const std::array<PlayedStep, 1> forwards{{{10, false}}}, backwards{{{10, true}}};
  const StepOrder on(40, forwards), back(40, backwards);
  for (std::uint32_t step = 0; step < 40; ++step) {
    INFO(step);
    const bool in_chain = step / kChainSteps == 1 && step <= 10;
    CHECK((on.rank(step, true) == 0) == in_chain);
    CHECK((back.rank(step, true) == 0) == in_chain);
    CHECK((on.rank(step, false) == 0) == (step == 10));
    const std::uint32_t ahead = step - 10, behind = 10 - step;  // wraps
    CHECK(on.rank(step, false) == (ahead <= StepOrder::kAhead ? ahead : StepOrder::kOther));
    CHECK(back.rank(step, false) == (behind <= StepOrder::kAhead ? behind : StepOrder::kOther));
  }
  // Step 16 begins a chain that the sixth next step needs. Step 7 needs its whole chain.
  CHECK(on.rank(16, true) == 6);
  CHECK(on.rank(19, true) == StepOrder::kOther);
  CHECK(back.rank(0, true) == 3);
  // Players begin again after the last step.
  const std::array<PlayedStep, 1> last{{{39, false}}};
  CHECK(StepOrder(40, last).rank(1, false) == 2);
  // Numbers beyond the steps are safe.
  const std::array<PlayedStep, 1> beyond{{{1000, true}}};
  CHECK(StepOrder(3, beyond).rank(2, true) == 0);
  CHECK(StepOrder(0, beyond).rank(0, true) == StepOrder::kOther);
  CHECK(on.rank(0xffffffff, true) == StepOrder::kOther);
}

TEST_CASE("step order: A view of a long series receives its step first") {
  constexpr std::uint32_t kSteps = 20, kShown = 10;
  VolumeSource source;
  for (std::uint32_t step = 0; step < kSteps; ++step) {
    source.steps.push_back(
        test::volume_of(test::oblique(24, 20, 16), [&](std::uint32_t x, std::uint32_t y, std::uint32_t z) {
          return static_cast<float>(std::sin(0.7 * x + 0.31 * step) + std::cos(0.9 * y * z + 0.17 * step * x));
        }));
    source.times.push_back(step);
  }
  source.layout = source.steps[0].layout;
  source.read = source.steps[0].read;
  EncodeOptions options;
  options.tolerance.error = 0.01;
  const EncodedStream stream = test::encoded_stream(encode_values(source, options));
  StreamHeader header = stream.header;
  header.directory = std::uint64_t{9} << 20;  // shorter streams keep their order
  DirectoryRequests requests(header);
  CHECK_FALSE(requests.in_stream_order());
  REQUIRE(requests.set_directory(std::span(stream.bytes).subspan(static_cast<std::size_t>(stream.header.directory))));
  const std::vector<ChunkRange> in_order = requests.wanted();
  LodView view;
  view.eye = glm::vec3(0, 0, -50);
  view.pixels = 1e6f;
  view.volume.step = kShown;
  requests.note(view);
  const std::vector<ChunkRange> by_view = requests.wanted();
  CHECK(by_view.size() == in_order.size());
  const auto offsets_of = [](const std::vector<ChunkRange>& ranges) {
    std::set<std::uint64_t> offsets;
    for (const ChunkRange& range : ranges) offsets.insert(range.offset);
    return offsets;
  };
  CHECK(offsets_of(by_view) == offsets_of(in_order));

  // Returns the largest error of a step after the first `most` bytes of these ranges.
  const auto error_after = [&](const std::vector<ChunkRange>& ranges, std::uint32_t step, std::uint64_t most) {
    StreamDecoder decoder;
    (void)decoder.push(encode_header(stream.header));
    std::uint64_t bytes = 0;
    for (const ChunkRange& range : ranges) {
      if ((bytes += range.bytes) > most) break;
      const auto chunk =
          sound_chunk(std::span(stream.bytes)
                          .subspan(static_cast<std::size_t>(range.offset), static_cast<std::size_t>(range.bytes)));
      REQUIRE(std::holds_alternative<SoundChunk>(chunk));
      const auto& sound = std::get<SoundChunk>(chunk);
      decoder.add(sound.type, sound.payload);
    }
    ShownComponent shown;
    shown.step.number = step;
    const Geometry geometry = decoder.geometry();
    const auto values = test::values_in(geometry.as<Volume>()->series->step(shown).as<Volume>()->values->source);
    const auto truth = test::values_in(source.steps[step]);
    float largest = 0;
    for (std::size_t i = 0; i < values.size(); ++i) largest = std::max(largest, std::abs(values[i] - truth[i]));
    return largest;
  };
  std::uint64_t all = 0;
  for (const ChunkRange& range : in_order) all += range.bytes;
  // The last corrections are exact only in a complete stream; before, the error is up to three times as large.
  constexpr float kError = 0.01f, kNearly = 3 * kError;
  CHECK(error_after(in_order, kShown, all) <= kError);
  const std::uint64_t part = all / 4;  // the chain has three of twenty steps
  CHECK(error_after(by_view, kShown, part) <= kNearly);
  CHECK(error_after(in_order, kShown, part) > 30 * kError);
  // Then come the next steps, in the direction of play.
  CHECK(error_after(by_view, kShown + 2, all / 2) <= kNearly);
  view.volume.step = kShown - 1;
  requests.note(view);
  const auto backwards = requests.wanted();
  CHECK(error_after(backwards, kShown - 2, part) <= kNearly);
  CHECK(error_after(backwards, kShown - 4, 3 * all / 4) <= kNearly);
  CHECK(error_after(backwards, kShown + 4, 3 * all / 4) > 3 * kError);
}

}  // namespace step_order_test
}  // namespace gs::qnv
