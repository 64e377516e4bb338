#include "qnv/codecs/values/decode/values_slices.h"
#include "qnv/codecs/values/encode/values_stream.h"
#include "qnv/codecs/values/slices/slice_transform.h"
#include "qnv/reader/stream_decoder.h"
#include "qnv/sampling/volume/volume_slices.h"
#include "tests/qnv/value_samples.h"
#include "tests/qnv/volume_sources.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <random>
#include <string>
#include <vector>

namespace gs::qnv {
namespace values_slices_test {

using values::Extent;

const std::vector<Extent> kOddExtents{{1, 1, 1},    {1, 1, 40},   {40, 1, 1},   {1, 40, 1},   {17, 33, 65},
                                      {16, 16, 17}, {5, 40, 7},   {33, 34, 35}, {70, 50, 20}, {2, 100, 3},
                                      {3, 3, 130},  {65, 2, 131}, {16, 16, 16}, {1, 9, 258}};

std::vector<std::int32_t> rough_samples(Extent extent, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::vector<std::int32_t> samples(values::sample_count(extent));
  for (std::size_t i = 0; i < samples.size(); ++i)
    samples[i] = static_cast<std::int32_t>(2000 * std::sin(static_cast<double>(i) / 37)) +
                 static_cast<std::int32_t>(random() % 40);
  return samples;
}

std::vector<values::SliceRows> rows_of(std::vector<std::int32_t>& samples, Extent extent, std::uint32_t first,
                                       std::uint32_t count) {
  std::vector<values::SliceRows> rows;
  for (std::uint32_t z = first; z < first + count; ++z)
    rows.push_back({samples.data() + std::size_t{z} * extent[0] * extent[1], extent[0]});
  return rows;
}

TEST_CASE("values: The transform by slices gives the coefficients of the whole transform, and so does its inverse") {
  for (const Extent& extent : kOddExtents) {
    INFO(extent[0] << " x " << extent[1] << " x " << extent[2]);
    std::vector<std::int32_t> samples = rough_samples(extent, 3), whole = samples;
    const int levels = values::level_count(extent);
    values::transform(whole, extent, levels);
    const values::BlockLayout layout(extent, levels);
    std::vector<std::int32_t> bands(samples.size(), 0);
    std::size_t blocks = 0;
    values::SliceTransform transform(
        extent, 2, [&](std::uint64_t first, std::uint32_t count, values::LevelSlices& slices) {
          for (std::uint64_t i = first; i < first + count; ++i, ++blocks) {
            const values::BlockPlace place = layout.place(i);
            const values::BlockBands from = slices.bands_of(place), to = bands_in_volume(place, bands, extent);
            for (std::uint32_t b = 0; b < place.band_count; ++b)
              for (std::uint32_t z = 0; z < place.bands[b].size[2]; ++z)
                for (std::uint32_t y = 0; y < place.bands[b].size[1]; ++y)
                  std::copy_n(from.parts[b][z] + y * from.row, place.bands[b].size[0], to.parts[b][z] + y * to.row);
          }
          return true;
        });
    const std::vector<std::uint32_t> batches{1, 8, 3, 5};
    for (std::uint32_t z = 0, i = 0; z < extent[2]; ++i) {
      const std::uint32_t count = std::min(batches[i % 4], extent[2] - z);
      REQUIRE(transform.add(rows_of(samples, extent, z, count)));
      z += count;
    }
    CHECK(blocks == layout.count());
    CHECK(bands == whole);
    std::vector<std::int32_t> restored(samples.size());
    values::SliceRestorer restorer(
        extent, 2, [&](std::uint64_t, const values::BlockPlace& place, const values::BlockBands& to) {
          const values::BlockBands from = bands_in_volume(place, bands, extent);
          for (std::uint32_t b = 0; b < place.band_count; ++b)
            for (std::uint32_t z = 0; z < place.bands[b].size[2]; ++z)
              for (std::uint32_t y = 0; y < place.bands[b].size[1]; ++y)
                std::copy_n(from.parts[b][z] + y * from.row, place.bands[b].size[0], to.parts[b][z] + y * to.row);
        });
    for (std::uint32_t z = 0, i = 0; z < extent[2]; ++i) {
      const std::uint32_t count = std::min(batches[i % 4], extent[2] - z);
      restorer.next(rows_of(restored, extent, z, count));
      z += count;
    }
    CHECK(restored == samples);
  }
}

TEST_CASE("values: The clusters are those of blocks of the whole transform") {
  for (const Extent& extent : kOddExtents) {
    INFO(extent[0] << " x " << extent[1] << " x " << extent[2]);
    const std::vector<std::int32_t> samples = rough_samples(extent, 5);
    const auto encoded = test::encode_samples(samples, extent, {});
    REQUIRE(encoded);
    std::vector<std::int32_t> whole = samples;
    values::transform(whole, extent, values::level_count(extent));
    const values::BlockLayout layout(extent, values::level_count(extent));
    std::size_t found = 0;
    for (std::uint32_t i = 0; i < layout.count(); ++i) {
      const values::BlockPlace place = layout.place(i);
      values::BlockEncoder encoder;
      encoder.encode(i, place, bands_in_volume(place, whole, extent), values::CodedPlanes{});
      const auto expected = encoder.take();
      for (const values::StoredCluster& one : expected.clusters) {
        const auto same = std::ranges::find_if(encoded->clusters, [&](const values::Cluster& cluster) {
          return cluster.block == i && cluster.index == one.index;
        });
        REQUIRE(same != encoded->clusters.end());
        const std::vector<std::byte> bytes(
            expected.bytes.begin() + static_cast<std::ptrdiff_t>(one.offset),
            expected.bytes.begin() + static_cast<std::ptrdiff_t>(one.offset + one.bytes));
        CHECK(values::pack(*same) == bytes);
        ++found;
      }
    }
    CHECK(found == encoded->clusters.size());
  }
}

/// Store that fails at a size.
class SmallStore final : public SpillStore {
 public:
  explicit SmallStore(std::uint64_t most) : most_(most) {}
  bool append(std::span<const std::byte> bytes) override {
    return memory_.size() + bytes.size() <= most_ && memory_.append(bytes);
  }
  [[nodiscard]] std::uint64_t size() const override { return memory_.size(); }
  [[nodiscard]] bool read(std::uint64_t offset, std::span<std::byte> to) const override {
    return memory_.read(offset, to);
  }
  [[nodiscard]] std::string problem() const override { return "the disk is full"; }

 private:
  std::uint64_t most_;
  MemoryStore memory_;
};

template <class T>
VolumeSource rough_volume(Extent extent, VoxelType type, double height, bool gaps) {
  VolumeLayout layout = test::oblique(extent[0], extent[1], extent[2]);
  layout.type = type;
  if (gaps) layout.missing = 7;
  std::mt19937 random(2);
  std::vector<T> voxels;
  for (std::size_t i = 0; i < values::sample_count(extent); ++i)
    voxels.push_back(gaps && (i / 9 % 5 == 0 || random() % 30 == 0)
                         ? T{7}
                         : static_cast<T>(height * (1 + std::sin(static_cast<double>(i) / 40)) + random() % 5));
  return test::volume_of(std::move(layout), std::move(voxels));
}

std::vector<VolumeSource> rough_volumes() {
  return {rough_volume<std::uint16_t>({37, 20, 45}, VoxelType::u16, 3000, false),
          rough_volume<std::int16_t>({20, 37, 18}, VoxelType::i16, 900, true),
          rough_volume<float>({18, 19, 33}, VoxelType::f32, 1e3, true),
          rough_volume<std::uint32_t>({17, 5, 40}, VoxelType::u32, 2e9, true),
          rough_volume<std::uint8_t>({1, 1, 70}, VoxelType::u8, 100, false)};
}

std::vector<EncodeOptions> all_limits() {
  EncodeOptions lossless, bounded, small;
  lossless.tolerance.lossless = true;
  bounded.tolerance = {0.01, true, false};
  small.max_bytes = 5000;
  return {{}, lossless, bounded, small};
}

TEST_CASE("values: The bytes depend neither on threads nor on the store nor on the sink") {
  for (const VolumeSource& source : rough_volumes())
    for (EncodeOptions options : all_limits()) {
      options.threads = 1;
      auto plain = encode_values(source, options);
      REQUIRE(std::holds_alternative<EncodedStream>(plain));
      const std::vector<std::byte> expected = std::get<EncodedStream>(plain).bytes;
      SmallStore store(1 << 24);
      std::vector<std::byte> bytes;
      MemorySink sink(bytes);
      options.threads = 3;
      options.spill = &store;
      options.sink = &sink;
      auto other = encode_values(source, options);
      REQUIRE(std::holds_alternative<EncodedStream>(other));
      CHECK(bytes == expected);
      CHECK(std::get<EncodedStream>(other).size() == expected.size());
      CHECK(std::get<EncodedStream>(other).bytes.empty());
    }
}

TEST_CASE("values: A full disk is an error") {
  SmallStore store(3000);
  EncodeOptions options;
  options.spill = &store;
  const auto encoded = encode_values(rough_volume<std::uint16_t>({37, 20, 45}, VoxelType::u16, 3000, false), options);
  REQUIRE(std::holds_alternative<EncodeError>(encoded));
  CHECK(std::get<EncodeError>(encoded).message == "cannot keep the clusters: the disk is full");
}

StreamBytes bytes_in(const std::vector<std::byte>& stream) {
  return {stream.size(), [&stream](std::uint64_t offset, std::span<std::byte> to) {
            if (offset > stream.size() || to.size() > stream.size() - offset) return false;
            std::memcpy(to.data(), stream.data() + offset, to.size());
            return true;
          }};
}

std::vector<std::uint32_t> value_bits(const VolumeSource& source) {
  std::vector<std::uint32_t> bits;
  std::vector<std::byte> scratch;
  std::vector<float> slice(slice_voxels(source.layout));
  for (std::uint32_t z = 0; z < source.layout.dimensions[2]; ++z) {
    REQUIRE(read_slice(source, z, scratch, slice));
    for (const float value : slice) bits.push_back(value == value ? std::bit_cast<std::uint32_t>(value) : 0xffffffffu);
  }
  return bits;
}

TEST_CASE("values: Slices of a stream are those of the whole volume") {
  for (const VolumeSource& source : rough_volumes())
    for (const EncodeOptions& options : all_limits()) {
      const auto stream = std::get<EncodedStream>(encode_values(source, options)).bytes;
      StreamDecoder decoder;
      decoder.push(stream);
      decoder.finish();
      const Geometry geometry = decoder.geometry();
      const VolumeValues& whole = *geometry.as<Volume>()->values;
      const auto opened = open_values_slices(bytes_in(stream));
      REQUIRE(std::holds_alternative<std::shared_ptr<const VolumeValues>>(opened));
      const VolumeValues& slices = *std::get<std::shared_ptr<const VolumeValues>>(opened);
      CHECK(slices.exact == whole.exact);
      CHECK(slices.error == whole.error);
      CHECK(slices.stored == whole.stored);
      if (whole.level > 0) continue;
      CHECK(slices.source.layout.axes == whole.source.layout.axes);
      CHECK(value_bits(slices.source) == value_bits(whole.source));
      CHECK(value_bits(slices.source) == value_bits(whole.source));  // again from the first slice
    }
}

TEST_CASE("values: Damaged streams are refused, or all of their slices can be read") {
  const auto source = rough_volume<float>({18, 19, 33}, VoxelType::f32, 1e3, true);
  EncodeOptions options;
  options.tolerance.lossless = true;
  const auto stream = std::get<EncodedStream>(encode_values(source, options)).bytes;
  std::mt19937 random(1);
  for (int round = 0; round < 30; ++round) {
    std::vector<std::byte> damaged = stream;
    for (int i = 0; i < 5; ++i) damaged[random() % damaged.size()] ^= std::byte(1u << random() % 8);
    if (round % 3 == 0) damaged.resize(random() % damaged.size());
    const auto opened = open_values_slices(bytes_in(damaged));
    const auto* values = std::get_if<std::shared_ptr<const VolumeValues>>(&opened);
    if (values) CHECK(value_bits((*values)->source).size() == 18 * 19 * 33);
  }
  CHECK(std::holds_alternative<StreamProblem>(open_values_slices({})));
}

}  // namespace values_slices_test
}  // namespace gs::qnv
