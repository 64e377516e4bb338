#include "qnv/codecs/shared/ranks.h"
#include "qnv/codecs/values/encode/values_stream.h"
#include "qnv/codecs/values/labels/encode/label_stream.h"
#include "qnv/codecs/values/slices/slice_transform.h"
#include "tests/qnv/thread_ranks.h"
#include "tests/qnv/volume_sources.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <memory>
#include <random>
#include <string>
#include <thread>
#include <vector>

namespace gs::qnv {
namespace shared_encode_test {

using Result = std::variant<EncodedStream, EncodeError>;

Result encode_volume(const VolumeSource& volume, const EncodeOptions& options) {
  return volume.layout.labels ? encode_labels(volume, options) : encode_values(volume, options);
}

std::vector<Result> encode_with(SharedMemory& state, const VolumeSource& volume, const EncodeOptions& options,
                                std::uint64_t last_fails_at = 0) {
  const std::size_t count = state.stores.size();
  std::vector<Result> results(count, EncodeError{"not run"});
  std::vector<std::jthread> threads;
  for (std::uint32_t rank = 0; rank < count; ++rank)
    threads.emplace_back([&, rank] {
      ThreadRanks ranks(state, rank);
      RankStore store(state, rank);
      if (rank + 1 == count) store.fails_at = last_fails_at;
      RankSink sink(state);
      EncodeOptions own = options;
      own.ranks = &ranks;
      own.spill = &store;
      own.sink = &sink;
      own.threads = 1;
      results[rank] = encode_volume(volume, own);
    });
  return results;
}

std::vector<std::byte> encode_alone(const VolumeSource& volume, const EncodeOptions& options) {
  auto encoded = encode_volume(volume, options);
  REQUIRE(std::holds_alternative<EncodedStream>(encoded));
  return std::get<EncodedStream>(encoded).bytes;
}

VolumeLayout layout_of(std::uint32_t nx, std::uint32_t ny, std::uint32_t nz) {
  VolumeLayout layout;
  layout.dimensions = {nx, ny, nz};
  return layout;
}

float rough(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
  return 900 * std::sin(static_cast<float>(x * y) / 37) + 500 * std::cos(static_cast<float>(z) / 9) +
         static_cast<float>((x * 7 + y * 13 + z * 29) % 31);
}

VolumeSource floats(std::uint32_t nx, std::uint32_t ny, std::uint32_t nz, bool gaps) {
  return test::volume_of(layout_of(nx, ny, nz), [=](std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    return gaps && (x + y + z) % 50 < 20 ? test::kNaN : rough(x, y, z);
  });
}

VolumeSource integers(std::uint32_t nx, std::uint32_t ny, std::uint32_t nz) {
  VolumeLayout layout = layout_of(nx, ny, nz);
  layout.type = VoxelType::i16;
  std::vector<std::int16_t> voxels;
  for (std::uint32_t z = 0; z < nz; ++z)
    for (std::uint32_t y = 0; y < ny; ++y)
      for (std::uint32_t x = 0; x < nx; ++x) voxels.push_back(static_cast<std::int16_t>(rough(x, y, z)));
  return test::volume_of(layout, std::move(voxels));
}

/// Returns labels: balls of many kinds in 0. The labels differ between the first and the last slices.
VolumeSource labels(std::uint32_t nx, std::uint32_t ny, std::uint32_t nz, std::uint32_t shift = 0) {
  VolumeLayout layout = layout_of(nx, ny, nz);
  layout.type = VoxelType::u16;
  layout.labels = true;
  std::vector<std::uint16_t> voxels;
  for (std::uint32_t z = 0; z < nz; ++z)
    for (std::uint32_t y = 0; y < ny; ++y)
      for (std::uint32_t x = 0; x < nx; ++x) {
        const std::uint32_t a = (x + shift) % 24, b = y % 22, c = z % 20;
        const bool inside = (a - 12) * (a - 12) + (b - 11) * (b - 11) + (c - 10) * (c - 10) < 70;
        voxels.push_back(static_cast<std::uint16_t>(inside ? 1 + x / 24 + 40 * (y / 22) + 700 * (z / 20) : 0));
      }
  return test::volume_of(layout, std::move(voxels));
}

void check_equal(const VolumeSource& volume, const EncodeOptions& options,
                 std::initializer_list<std::uint32_t> counts) {
  const std::vector<std::byte> alone = encode_alone(volume, options);
  for (const std::uint32_t count : counts) {
    INFO(count << " ranks");
    SharedMemory state(count);
    for (const Result& result : encode_with(state, volume, options)) {
      REQUIRE(std::holds_alternative<EncodedStream>(result));
      CHECK(std::get<EncodedStream>(result).size() == alone.size());
    }
    CHECK(state.stream == alone);
  }
}

TEST_CASE("shared encoding: Any number of ranks gives the bytes of one process") {
  EncodeOptions options;
  SECTION("default error") { check_equal(integers(50, 37, 143), options, {1, 2, 3, 4, 7}); }
  SECTION("lossless integers") {
    options.tolerance.lossless = true;
    check_equal(integers(33, 40, 100), options, {3});
  }
  SECTION("lossless floats with missing voxels") {
    options.tolerance.lossless = true;
    check_equal(floats(30, 35, 97, true), options, {3});
  }
  SECTION("floats with missing voxels") { check_equal(floats(40, 20, 130, true), options, {4}); }
  SECTION("a limited size") {
    options.max_bytes = 20'000;
    check_equal(integers(50, 37, 143), options, {2});
  }
  SECTION("labels") { check_equal(labels(70, 45, 67), options, {1, 2, 3, 5}); }
  SECTION("labels of a large slice, which have several segments") { check_equal(labels(1030, 520, 6), options, {3}); }
  SECTION("labels with a limited size") {
    options.max_bytes = 3'000;
    check_equal(labels(70, 45, 67), options, {3});
  }
  SECTION("labels of a time series") {
    VolumeSource series = labels(50, 40, 30);
    series.steps = {labels(50, 40, 30), labels(50, 40, 30), labels(50, 40, 30, 1)};
    series.times = {0, 1, 2};
    check_equal(series, options, {4});
  }
  SECTION("equal parity") {
    options.parity = 0.1;
    check_equal(integers(40, 40, 96), options, {3});
  }
  SECTION("volumes with few slices") {
    check_equal(integers(100, 90, 1), options, {3});
    check_equal(integers(9, 7, 5), options, {3});
    check_equal(integers(1, 1, 200), options, {3});
  }
  SECTION("few slices with more blocks than a piece has") { check_equal(integers(2112, 520, 2), options, {2, 3}); }
}

TEST_CASE("shared encoding: Components and time series have the same bytes, too") {
  VolumeSource vectors = floats(25, 30, 70, false);
  vectors.components = {floats(25, 30, 70, false), floats(25, 30, 70, true)};
  check_equal(vectors, {}, {3});
  VolumeSource series = integers(30, 30, 66);
  for (int step = 0; step < 3; ++step) {
    series.steps.push_back(integers(30, 30, 66));
    series.times.push_back(step);
  }
  check_equal(series, {}, {3});
}

TEST_CASE("shared encoding: A later run uses the rows that an earlier run has finished") {
  const bool flat = GENERATE(false, true);  // in a flat volume, ranks share the blocks of a row
  const VolumeSource volume = flat ? integers(2112, 520, 2) : integers(40, 33, 150);
  const std::vector<std::byte> alone = encode_alone(volume, {});
  SharedMemory first(3);
  (void)encode_with(first, volume, {});
  REQUIRE(first.finished.size() > 5);
  CHECK(first.restored == 0);
  // Rows of all kinds are missing, as after an end at any moment.
  std::size_t i = 0;
  std::erase_if(first.finished, [&](const auto&) { return i++ % 3 == 0; });
  const std::size_t kept = first.finished.size();
  // The encoder must reject a result of another row or piece.
  std::swap(first.finished.begin()->second, std::next(first.finished.begin())->second);
  first.stream.clear();
  for (const Result& result : encode_with(first, volume, {})) CHECK(std::holds_alternative<EncodedStream>(result));
  CHECK(first.restored >= kept);
  CHECK(first.stream == alone);
}

TEST_CASE("shared encoding: All ranks report the error of one") {
  const VolumeSource volume = integers(40, 33, 150);
  SharedMemory state(3);
  for (const Result& result : encode_with(state, volume, {}, 3000)) {
    REQUIRE(std::holds_alternative<EncodeError>(result));
    CHECK_THAT(std::get<EncodeError>(result).message, Catch::Contains("cannot keep the clusters"));
  }
  VolumeSource broken = integers(40, 33, 150);
  broken.read = [read = broken.read](std::uint32_t z, std::span<std::byte> to) { return z != 120 && read(z, to); };
  SharedMemory other(4);
  for (const Result& result : encode_with(other, broken, {})) {
    REQUIRE(std::holds_alternative<EncodeError>(result));
    CHECK_THAT(std::get<EncodeError>(result).message, Catch::Contains("slice 120"));
  }
}

TEST_CASE("shared encoding: All ranks report numbers that are not labels") {
  // The last slice alone has a fraction. The other ranks cannot know that.
  VolumeLayout layout = layout_of(20, 20, 12);
  layout.labels = true;
  const VolumeSource volume = test::volume_of(
      layout, [](std::uint32_t x, std::uint32_t, std::uint32_t z) { return z == 11 ? 0.5f : static_cast<float>(x); });
  SharedMemory state(3);
  for (const Result& result : encode_with(state, volume, {})) {
    REQUIRE(std::holds_alternative<EncodeError>(result));
    CHECK(std::get<EncodeError>(result).message.starts_with("slice 11 of the label volume has numbers"));
  }
}

TEST_CASE("shared encoding: The inverse transform gives any window of slices") {
  const values::Extent extent{21, 18, 150};
  const values::BlockLayout layout(extent, values::level_count(extent));
  std::vector<std::int32_t> samples(values::sample_count(extent));
  for (std::size_t i = 0; i < samples.size(); ++i) samples[i] = static_cast<std::int32_t>(i * 2654435761u >> 20);
  std::vector<std::int32_t> bands = samples;
  values::transform(bands, extent, values::level_count(extent));
  const std::size_t slice = std::size_t{extent[0]} * extent[1];
  for (const auto& [first, end] : {std::pair(0u, 32u), {32u, 64u}, {96u, 150u}, {64u, 65u}, {0u, 150u}}) {
    values::SliceRestorer restorer(extent, 1,
                                   [&](std::uint64_t, const values::BlockPlace& place, const values::BlockBands& to) {
                                     const values::BlockBands from = bands_in_volume(place, bands, extent);
                                     for (std::uint32_t b = 0; b < place.band_count; ++b)
                                       for (std::uint32_t z = 0; z < place.bands[b].size[2]; ++z)
                                         for (std::uint32_t y = 0; y < place.bands[b].size[1]; ++y)
                                           std::copy_n(from.parts[b][z] + y * from.row, place.bands[b].size[0],
                                                       to.parts[b][z] + y * to.row);
                                   },
                                   {first, end});
    std::vector<std::int32_t> restored(slice * (end - first));
    std::vector<values::SliceRows> rows;
    for (std::uint32_t z = 0; z < end - first; ++z) rows.push_back({restored.data() + z * slice, extent[0]});
    restorer.next(rows);
    CHECK(std::equal(restored.begin(), restored.end(), samples.begin() + static_cast<std::ptrdiff_t>(first * slice)));
  }
}

}  // namespace shared_encode_test
}  // namespace gs::qnv
