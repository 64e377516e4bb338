#include "qnv/codecs/shared/volume_series.h"
#include "qnv/codecs/values/cluster.h"
#include "qnv/codecs/values/component_number.h"
#include "qnv/codecs/values/decode/values_slices.h"
#include "qnv/codecs/values/encode/values_stream.h"
#include "qnv/reader/loss.h"
#include "qnv/reader/stream_decoder.h"
#include "qnv/sampling/volume/color_voxels.h"
#include "tests/qnv/pinned_vectors.h"
#include "tests/qnv/value_streams.h"
#include "tests/qnv/volume_sources.h"
#include "tests/watched.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <sstream>
#include <string>
#include <variant>
#include <vector>

namespace gs::qnv {
namespace series_test {

using test::bits_of;
using test::oblique;
using test::values_in;
using test::volume_of;

// Two soft balls, of which one moves; with gaps where x is large at odd steps.
VolumeSource balls_at(VolumeLayout layout, std::size_t step, bool gaps, double noise = 0) {
  const auto [nx, ny, nz] = layout.dimensions;
  const auto ball = [](double u, double v, double w, double x) {
    return 1 / (1 + std::exp(14 * (std::sqrt((u - x) * (u - x) + v * v + w * w) - 0.4)));
  };
  std::mt19937 random(static_cast<unsigned>(step) + 1);
  std::uniform_real_distribution<double> grain(-noise, noise);
  return volume_of(layout, [&, nx = nx, ny = ny, nz = nz](std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    if (gaps && step % 2 == 1 && x + 4 > nx) return test::kNaN;
    const double u = 2.0 * x / nx - 1, v = 2.0 * y / ny - 1, w = 2.0 * z / nz - 1;
    const double moved = -0.5 + 0.1 * static_cast<double>(step);
    return static_cast<float>(100 * (ball(u, v, w, 0.5) + ball(u, v, w, moved)) + grain(random));
  });
}

template <class T>
VolumeSource whole_numbers(const VolumeSource& floats, VoxelType type) {
  std::vector<T> voxels;
  for (const float value : values_in(floats)) voxels.push_back(static_cast<T>(std::lround(value)));
  VolumeLayout layout = floats.layout;
  layout.type = type;
  return volume_of(std::move(layout), std::move(voxels));
}

VolumeSource series_of(std::vector<VolumeSource> steps, double first = 0, double apart = 1) {
  VolumeSource source = steps.front();
  for (std::size_t i = 0; i < steps.size(); ++i) source.times.push_back(first + apart * static_cast<double>(i));
  source.steps = std::move(steps);
  return source;
}
VolumeSource moving(const VolumeLayout& layout, std::size_t count, bool gaps = false, double noise = 0) {
  std::vector<VolumeSource> steps;
  for (std::size_t i = 0; i < count; ++i) steps.push_back(balls_at(layout, i, gaps, noise));
  return series_of(std::move(steps));
}
VolumeSource moving_numbers(const VolumeLayout& layout, std::size_t count, double noise = 0) {
  std::vector<VolumeSource> steps;
  for (std::size_t i = 0; i < count; ++i)
    steps.push_back(whole_numbers<std::int16_t>(balls_at(layout, i, false, noise), VoxelType::i16));
  return series_of(std::move(steps), 2.5, 0.25);
}

EncodedStream stream_of(const VolumeSource& source, const EncodeOptions& options = {}) {
  return test::encoded_stream(encode_values(source, options));
}
EncodeOptions lossless() {
  EncodeOptions options;
  options.tolerance.lossless = true;
  return options;
}
EncodeOptions within(double error) {
  EncodeOptions options;
  options.tolerance.error = error;
  return options;
}
EncodeOptions bytes_of(std::size_t bytes) {
  EncodeOptions options;
  options.max_bytes = bytes;
  return options;
}

std::shared_ptr<const VolumeValues> values_of(const Geometry& geometry) {
  const auto* volume = geometry.as<Volume>();
  REQUIRE(volume);
  REQUIRE(volume->values);
  return volume->values;
}

/// Steps of a stream.
struct SeriesSteps {
  explicit SeriesSteps(std::span<const std::byte> bytes) {
    decoder.push(bytes);
    decoder.finish();
    first = decoder.geometry();
    REQUIRE(first.as<Volume>());
    REQUIRE(first.as<Volume>()->series);
  }
  std::shared_ptr<const VolumeValues> values(std::uint32_t step, ShownComponent shown = {}) {
    shown.step.number = step;
    return values_of(first.as<Volume>()->series->step(shown));
  }
  StreamDecoder decoder;
  Geometry first;
};
double rms_of(const std::vector<float>& a, const std::vector<float>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += std::pow(static_cast<double>(a[i]) - static_cast<double>(b[i]), 2);
  return std::sqrt(sum / static_cast<double>(a.size()));
}

TEST_CASE("series: A lossless stream restores every step in any order") {
  const VolumeLayout layout = oblique(37, 30, 18);
  for (const VolumeSource& source : {moving_numbers(layout, 11, 3), moving(layout, 10, true, 0.5)}) {
    const EncodedStream stream = stream_of(source, lossless());
    CHECK(stream.header.steps.times == source.times);
    SeriesSteps steps(stream.bytes);
    const auto slices = test::slices_of(stream.bytes);
    REQUIRE(slices->steps.size() == source.steps.size());
    // Forwards, backwards and across chains.
    for (const std::uint32_t step : {0u, 1u, 2u, 9u, 8u, 7u, 3u, 4u, 0u, 6u}) {
      INFO(step);
      const auto truth = bits_of(values_in(source.steps[step]));
      const auto values = steps.values(step);
      CHECK(values->step == step);
      CHECK(values->times == source.times);
      CHECK(values->exact);
      CHECK(bits_of(values_in(values->source)) == truth);
      CHECK(slices->steps[step]->exact);
      CHECK(slices->steps[step]->step == step);
      CHECK(bits_of(values_in(slices->steps[step]->source)) == truth);
    }
  }
}

TEST_CASE("series: Differences to the step before take fewer bytes, and new scenes do not") {
  const VolumeLayout layout = oblique(50, 40, 30);
  for (const EncodeOptions& options : {lossless(), within(0.5)}) {
    const VolumeSource source = moving_numbers(layout, 8);
    std::size_t alone = 0;
    for (const VolumeSource& step : source.steps) alone += stream_of(step, options).bytes.size();
    const std::size_t together = stream_of(source, options).bytes.size();
    INFO(together << " of " << alone);
    CHECK(static_cast<double>(together) < 0.85 * static_cast<double>(alone));
    // Steps without relation.
    std::vector<VolumeSource> strangers;
    std::mt19937 random(4);
    for (std::size_t s = 0; s < 4; ++s) {
      std::vector<std::int16_t> voxels(voxel_count(layout));
      for (auto& voxel : voxels) voxel = static_cast<std::int16_t>(random() % 100);
      VolumeLayout own = layout;
      own.type = VoxelType::i16;
      strangers.push_back(volume_of(own, std::move(voxels)));
    }
    std::size_t apart = 0;
    for (const VolumeSource& step : strangers) apart += stream_of(step, options).bytes.size();
    CHECK(static_cast<double>(stream_of(series_of(strangers), options).bytes.size()) <
          1.03 * static_cast<double>(apart));
  }
}

TEST_CASE("series: Every step keeps the permitted error, and the stream states it") {
  const VolumeLayout layout = oblique(50, 40, 30);
  for (const VolumeSource& source : {moving(layout, 10, false, 1), moving(layout, 9, true, 1)})
    for (const double error : {0.1, 1.0, 5.0}) {
      const EncodedStream stream = stream_of(source, within(error));
      SeriesSteps steps(stream.bytes);
      const auto slices = test::slices_of(stream.bytes);
      for (std::uint32_t s = 0; s < source.steps.size(); ++s) {
        const auto truth = values_in(source.steps[s]);
        const auto values = steps.values(s);
        INFO(error << " " << s);
        REQUIRE(values->error);
        CHECK(static_cast<double>(*values->error) <= error);
        const auto now = values_in(values->source);
        for (std::size_t i = 0; i < truth.size(); ++i) {
          REQUIRE_EACH((truth[i] == truth[i]) == (now[i] == now[i]));
          if (truth[i] == truth[i]) REQUIRE_EACH(std::abs(truth[i] - now[i]) <= *values->error * 1.00001f);
        }
        REQUIRE(slices->steps[s]->error);
        CHECK(bits_of(values_in(slices->steps[s]->source)) == bits_of(now));
      }
    }
}

TEST_CASE("series: Every prefix has all steps, and states its error") {
  const VolumeSource source = moving(oblique(90, 80, 70), 8, false, 1);
  for (const EncodeOptions& options : {within(0.2), bytes_of(15'000)}) {
    const EncodedStream stream = stream_of(source, options);
    if (options.max_bytes != 0) CHECK(stream.bytes.size() <= options.max_bytes);
    double before = 200;
    for (const double part : {0.05, 0.2, 0.5, 1.0}) {
      const auto bytes = static_cast<std::size_t>(part * static_cast<double>(stream.bytes.size()));
      SeriesSteps steps(std::span(stream.bytes).first(bytes));
      double worst = 0, most = 0;
      std::optional<float> stated;
      for (std::uint32_t s = 0; s < 8; ++s) {
        const auto values = steps.values(s);
        if (values->level > 0) continue;
        const auto truth = values_in(source.steps[s]), now = values_in(values->source);
        worst = std::max(worst, rms_of(truth, now));
        for (std::size_t i = 0; i < truth.size(); ++i)
          most = std::max(most, std::abs(static_cast<double>(truth[i]) - static_cast<double>(now[i])));
        stated = values->error;
      }
      INFO(part << " of " << stream.bytes.size() << " " << worst << " " << most);
      if (stated) CHECK(most <= static_cast<double>(*stated) * 1.0001);
      if (part == 1.0 || (part == 0.5 && options.max_bytes == 0)) CHECK(stated);
      CHECK(worst < before);
      before = worst + 0.01;
    }
    CHECK(before < (options.max_bytes != 0 ? 6.0 : 0.2));
  }
}

TEST_CASE("series: A lost cluster changes one box of the steps of its chain") {
  const VolumeSource source = moving_numbers(oblique(70, 60, 50), 12, 2);
  const EncodedStream stream = stream_of(source, lossless());
  const values::ComponentCounts counts = values::component_counts(stream.header.grid);
  std::vector<std::pair<ChunkType, std::vector<std::byte>>> chunks;
  StreamReader reader;
  (void)reader.push(stream.bytes, [&](ChunkType type, std::span<const std::byte> payload, std::uint64_t) {
    if (type == ChunkType::values) chunks.emplace_back(type, std::vector(payload.begin(), payload.end()));
  });
  const values::BlockLayout layout(stream.header.grid.dimensions, values::level_count(stream.header.grid.dimensions));
  int tried = 0;
  for (std::size_t lost = 0; lost < chunks.size() && tried < 6; lost += chunks.size() / 9 + 1) {
    const auto split = values::without_component(chunks[lost].second, counts.blocks);
    const auto block = layout.place(values::parse_cluster(split->payload, true)->block);
    if (block.level > 2) continue;
    ++tried;
    StreamHeader header = stream.header;
    header.parity = false;
    StreamDecoder decoder;
    (void)decoder.push(encode_header(header));
    for (std::size_t i = 0; i < chunks.size(); ++i)
      if (i != lost) decoder.add(chunks[i].first, chunks[i].second);
    const Geometry first = decoder.geometry();
    const std::size_t step = split->component, chain = step / kChainSteps;
    for (std::uint32_t s = 0; s < 12; ++s) {
      ShownComponent shown;
      shown.step.number = s;
      const auto values = values_of(first.as<Volume>()->series->step(shown));
      const auto truth = values_in(source.steps[s]), now = values_in(values->source);
      const std::int64_t reach = 6 << block.level;
      INFO(step << " " << s);
      for (std::size_t i = 0; i < truth.size(); ++i) {
        if (truth[i] == now[i]) continue;
        REQUIRE_EACH(s >= step);
        REQUIRE_EACH(s / kChainSteps == chain);
        const std::array<std::int64_t, 3> at{static_cast<std::int64_t>(i % 70), static_cast<std::int64_t>(i / 70 % 60),
                                             static_cast<std::int64_t>(i / 4200)};
        for (std::size_t a = 0; a < 3; ++a) {
          REQUIRE_EACH(at[a] >= std::int64_t{block.first[a]} - reach);
          REQUIRE_EACH(at[a] < std::int64_t{block.first[a]} + block.size[a] + reach);
        }
      }
    }
  }
  CHECK(tried >= 3);
  const auto dropped = drop_packets(stream.bytes, 0.1, 5);
  SeriesSteps steps(dropped);
  for (std::uint32_t s = 0; s < 12; ++s)
    CHECK(rms_of(values_in(source.steps[s]), values_in(steps.values(s)->source)) < 12);
}

TEST_CASE("series: Steps appear while the stream arrives, as from the whole stream") {
  const VolumeSource source = moving(oblique(60, 50, 40), 10, false, 1);
  const EncodedStream stream = stream_of(source, within(0.3));
  StreamDecoder decoder;
  std::size_t at = 0;
  std::uint32_t step = 0;
  for (const double part : {0.1, 0.3, 0.35, 0.6, 0.8, 1.0}) {
    const auto to = static_cast<std::size_t>(part * static_cast<double>(stream.bytes.size()));
    (void)decoder.push(std::span(stream.bytes).subspan(at, to - at));
    at = to;
    StreamDecoder fresh;
    (void)fresh.push(std::span(stream.bytes).first(to));
    for (const std::uint32_t shown : {step, step + 1, 9u, step / 2}) {
      ShownComponent wish;
      wish.step.number = shown;
      decoder.show(wish);
      fresh.show(wish);
      const auto now = values_of(decoder.geometry()), then = values_of(fresh.geometry());
      INFO(part << " " << shown);
      REQUIRE(now->level == then->level);
      CHECK(bits_of(values_in(now->source)) == bits_of(values_in(then->source)));
    }
    step += 2;
  }
}

TEST_CASE("series: Components and colours have steps, too, chosen by number or time") {
  VolumeLayout layout = oblique(30, 26, 20);
  std::vector<VolumeSource> vectors, colors;
  for (std::size_t s = 0; s < 9; ++s) {
    VolumeSource step = balls_at(layout, s, false);
    step.components = {balls_at(layout, s, false), balls_at(layout, s + 2, false)};
    vectors.push_back(std::move(step));
    std::vector<VolumeSource> planes;
    for (std::size_t c = 0; c < 3; ++c)
      planes.push_back(whole_numbers<std::uint8_t>(balls_at(layout, s + c, false), VoxelType::u8));
    colors.push_back(color_source(std::move(planes)));
  }
  for (const auto& all : {vectors, colors}) {
    const VolumeSource source = series_of(all, 10, 5);
    const EncodedStream stream = stream_of(source, lossless());
    SeriesSteps steps(stream.bytes);
    const auto slices = test::slices_of(stream.bytes);
    for (std::uint32_t s = 0; s < 9; ++s) {
      const auto values = steps.values(s);
      REQUIRE(values->components.size() == source.steps[s].components.size());
      for (std::size_t c = 0; c < values->components.size(); ++c) {
        const auto truth = values_in(source.steps[s].components[c]);
        CHECK(values_in(values->components[c]->source) == truth);
        CHECK(values_in(slices->steps[s]->components[c]->source) == truth);
      }
    }
    const std::vector<double>& times = source.times;
    CHECK(step_number({0, 22.0}, times) == 2);
    CHECK(step_number({0, 23.0}, times) == 3);
    CHECK(step_number({0, -1e30}, times) == 0);
    CHECK(step_number({0, 1e30}, times) == 8);
    CHECK(step_number({77, {}}, times) == 8);
  }
}

TEST_CASE("series: Unfit steps are refused") {
  const VolumeLayout layout = oblique(12, 10, 8);
  const auto refusal = [](const VolumeSource& source) {
    const auto made = encode_values(source, {});
    const auto* problem = std::get_if<EncodeError>(&made);
    return problem ? problem->message : std::string();
  };
  VolumeSource source = moving(layout, 3);
  CHECK(refusal(source).empty());
  source.times[2] = source.times[1];
  CHECK(refusal(source).find("ascend") != std::string::npos);
  source = moving(layout, 3);
  source.steps[1] = balls_at(oblique(12, 10, 9), 1, false);
  CHECK(refusal(source).find("step 1 differs") != std::string::npos);
  source = moving(layout, 3);
  source.times.pop_back();
  CHECK_FALSE(refusal(source).empty());
  source = moving(layout, 1);
  CHECK(refusal(source).find("expected 2 to 4096") != std::string::npos);
}

TEST_CASE("series: Every prefix, split point and flipped bit leaves valid steps") {
  // A small volume, because each split point decodes all steps three times.
  const VolumeSource source = moving_numbers(oblique(9, 7, 5), 10, 1);
  const EncodedStream stream = stream_of(source, lossless());
  const auto truth = values_in(source.steps[9]);
  for (std::size_t at = 0; at <= stream.bytes.size(); at += watched_step(17)) {
    StreamDecoder decoder;
    ShownComponent shown;
    shown.step.number = 9;
    decoder.show(shown);
    (void)decoder.push(std::span(stream.bytes).first(at));
    (void)decoder.geometry();
    (void)decoder.push(std::span(stream.bytes).subspan(at));
    decoder.finish();
    REQUIRE(values_in(values_of(decoder.geometry())->source) == truth);
  }
  const std::size_t head = encode_header(stream.header).size();
  for (std::size_t bit = head * 8; bit < stream.header.directory * 8; bit += watched_step(233)) {
    std::vector<std::byte> bytes = stream.bytes;
    bytes[bit / 8] ^= std::byte(1u << bit % 8);
    SeriesSteps steps(bytes);
    REQUIRE(steps.values(static_cast<std::uint32_t>(bit % 10))->times.size() == 10);
  }
}

TEST_CASE("series: Hostile headers and chunks are refused") {
  const EncodedStream stream = stream_of(moving_numbers(oblique(40, 30, 20), 10), within(1));
  const auto accepted = [](const StreamHeader& header) {
    std::size_t bytes = 0;
    bool more = false;
    return std::holds_alternative<StreamHeader>(decode_header(encode_header(header), bytes, more));
  };
  CHECK(accepted(stream.header));
  const auto changed = [&](auto change) {
    StreamHeader header = stream.header;
    change(header.steps);
    return accepted(header);
  };
  CHECK_FALSE(changed([](StepTable& steps) { steps.times[3] = std::numeric_limits<double>::quiet_NaN(); }));
  CHECK_FALSE(changed([](StepTable& steps) { steps.times[3] = steps.times[2]; }));
  CHECK_FALSE(changed([](StepTable& steps) { steps.chunks.pop_back(); }));
  CHECK_FALSE(changed([](StepTable& steps) { steps.times.resize(kMaxSteps + 1); }));
  CHECK(changed([](StepTable& steps) { steps.times.back() = 1e9; }));
  const auto table = encode_step_table(stream.header.steps);
  for (std::size_t size = 0; size < table.size(); ++size)
    CHECK_FALSE(decode_step_table(std::span(table).first(size), 1));
  CHECK_FALSE(decode_step_table(table, 4000));
  const auto chunks = test::content_chunks(stream.bytes);
  std::mt19937 random(8);
  for (int round = 0; round < 30; ++round) {
    StreamHeader header = stream.header;
    if (random() % 3 == 0) header.grid.dimensions[random() % 3] = 1 + random() % 100;
    if (random() % 3 == 0) std::ranges::fill(header.steps.chunks, static_cast<std::uint32_t>(random() % 9));
    StreamDecoder decoder(20'000);
    (void)decoder.push(encode_header(header));
    for (auto [type, bytes] : chunks) {
      if (random() % 2 == 0) bytes[random() % std::min<std::size_t>(bytes.size(), 12)] ^= std::byte(1u << random() % 8);
      if (random() % 9 == 0) bytes.resize(random() % (bytes.size() + 1));
      constexpr ChunkType kTypes[] = {ChunkType::values, ChunkType::gaps, ChunkType::remainders, ChunkType::labels};
      decoder.add(random() % 4 == 0 ? kTypes[random() % 4] : type, bytes);
      if (random() % 90 == 0) {
        ShownComponent shown;
        shown.step.number = static_cast<std::uint32_t>(random() % 12);
        decoder.show(shown);
        (void)decoder.geometry();
      }
    }
    CHECK(decoder.geometry().as<Volume>() != nullptr);
  }
  // A difference in a step that starts a chain.
  const auto first =
      values::without_component(chunks.front().second, values::component_counts(stream.header.grid).blocks);
  CHECK(values::parse_cluster(first->payload, false));
}

TEST_CASE("series: FORMAT.md's stream decodes to the steps of an independent decoder") {
  const std::string name = "values_series", expected = read_text(name + ".txt");
  REQUIRE(expected.size() > 5000);
  const std::vector<std::byte> bytes = read_bytes(name + ".qnv");
  SeriesSteps steps(bytes);
  std::ostringstream out;
  const auto times = steps.values(0)->times;
  for (std::uint32_t s = 0; s < times.size(); ++s) {
    const auto values = steps.values(s);
    CHECK(values->exact);
    // The independent decoder prints samples.
    const VolumeLayout& layout = values->source.layout;
    for (const float value : values_in(values->source))
      out << std::lround((static_cast<double>(value) - layout.intercept) / layout.slope) << '\n';
  }
  CHECK(out.str() == expected);
  check_independent_decoder("values_decode.py", name, expected);
}

}  // namespace series_test
}  // namespace gs::qnv
