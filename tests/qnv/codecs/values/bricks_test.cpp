#include "qnv/codecs/values/bricks/brick_volume.h"
#include "qnv/codecs/values/decode/sample_limits.h"
#include "qnv/codecs/values/decode/values_decoder.h"
#include "qnv/codecs/values/encode/values_stream.h"
#include "qnv/reader/stream_decoder.h"
#include "qnv/sampling/volume/volume_slices.h"
#include "qnv/sampling/volume/volume_values.h"
#include "tests/qnv/volume_sources.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <random>
#include <set>
#include <thread>
#include <vector>

namespace gs::qnv {
namespace bricks_test {

using values::Extent;
using Bytes = std::vector<std::byte>;

// Cells of different values with noise, so that every part has vectors. Voxels in a corner are missing: those with
// u + v > `gaps`, from -1 to 1 each.
EncodedStream noisy_cells(Extent extent, double gaps = 3) {
  VolumeLayout layout;
  layout.dimensions = extent;
  std::mt19937 random(7);
  std::vector<std::uint16_t> voxels;
  for (std::uint32_t z = 0; z < extent[2]; ++z)
    for (std::uint32_t y = 0; y < extent[1]; ++y)
      for (std::uint32_t x = 0; x < extent[0]; ++x) {
        const double u = 2.0 * x / extent[0] - 1, v = 2.0 * y / extent[1] - 1;
        const std::uint32_t cell = (x / 11) * 7 + (y / 11) * 5 + (z / 11) * 11;
        const std::uint32_t value = 300 * (cell * cell % 13) + static_cast<std::uint32_t>(random() % 60);
        voxels.push_back(static_cast<std::uint16_t>(u + v > gaps ? 9999 : value));
      }
  layout.type = VoxelType::u16;
  if (gaps < 2) layout.missing = 9999;
  auto made = encode_values(test::volume_of(layout, std::move(voxels)), EncodeOptions{});
  REQUIRE(std::holds_alternative<EncodedStream>(made));
  return std::move(std::get<EncodedStream>(made));
}

LodView view_of_all(std::uint32_t viewport = 0) {
  LodView view;
  view.eye = glm::vec3(-300, 20, 30);
  view.pixels = 1e6f;
  view.viewport = viewport;
  return view;
}
LodView view_at(const glm::vec3& eye, float pixels) {
  LodView view = view_of_all();
  view.eye = eye;
  view.pixels = pixels;
  return view;
}

BrickLimits limits_for(std::size_t base_samples, std::size_t brick_bytes = std::size_t{1} << 30) {
  BrickLimits limits;
  limits.base_vectors = base_samples / values::kSamplesPerVector;
  limits.brick_bytes = brick_bytes;
  return limits;
}

std::shared_ptr<BrickVolume> open_bricks(Bytes bytes, const BrickLimits& limits) {
  auto opened = BrickVolume::open(memory_source(std::move(bytes)), limits);
  REQUIRE(std::holds_alternative<std::shared_ptr<BrickVolume>>(opened));
  return std::get<0>(opened);
}

std::shared_ptr<const Volume> cut_now(BrickVolume& bricks, const LodView& view) {
  bool pending = false;
  auto volume = bricks.cut(view, pending);
  CHECK_FALSE(pending);
  return volume;
}

// Samples of the intact clusters of a stream, decoded as a whole. Voxels are limited to the value range.
std::vector<std::int32_t> whole_samples(const Bytes& bytes, const Extent& extent, int level) {
  values::ValuesDecoder decoder(extent);
  StreamReader reader;
  const auto take = [&](ChunkType type, std::span<const std::byte> payload, std::uint64_t) {
    if (type == ChunkType::values)
      if (const auto cluster = values::parse_cluster(payload)) decoder.add(*cluster);
  };
  reader.push(bytes, take);
  reader.finish(take);
  std::vector<std::int32_t> samples = decoder.samples(level);
  const StreamHeader& header = *reader.header();
  if (level == 0)
    values::sample_limits(header.description.value_range, header.grid.unit, header.grid.zero).apply(samples);
  return samples;
}

// Compares all bricks with the samples of the whole volume. Returns the number of samples of level 0.
std::size_t check_bricks(const Volume& volume, const Bytes& bytes, const Extent& extent) {
  std::size_t finest = 0;
  std::map<int, std::vector<std::int32_t>> whole;
  for (const ValueBrick& brick : volume.values->bricks) {
    auto& samples = whole[brick.level];
    if (samples.empty()) samples = whole_samples(bytes, extent, brick.level);
    const Extent part = values::low_extent(extent, brick.level);
    std::size_t different = 0, i = 0;
    for (std::uint32_t z = brick.first[2]; z < brick.first[2] + brick.size[2]; ++z)
      for (std::uint32_t y = brick.first[1]; y < brick.first[1] + brick.size[1]; ++y)
        for (std::uint32_t x = brick.first[0]; x < brick.first[0] + brick.size[0]; ++x)
          if ((*brick.samples)[i++] != samples[(std::size_t{z} * part[1] + y) * part[0] + x]) ++different;
    INFO("level " << brick.level << " at " << brick.first[0] << " " << brick.first[1] << " " << brick.first[2]);
    CHECK(different == 0);
    if (brick.level == 0) finest += std::size_t{brick.core_size[0]} * brick.core_size[1] * brick.core_size[2];
  }
  return finest;
}

TEST_CASE("bricks: Samples with their margins equal those of the whole volume at every level") {
  for (const Extent extent : {Extent{150, 90, 70}, Extent{83, 145, 64}, Extent{1, 190, 122}, Extent{300, 1, 1}}) {
    const EncodedStream stream = noisy_cells(extent);
    const std::size_t all = values::sample_count(extent);
    for (const std::size_t part : {2, 30}) {
      const auto bricks = open_bricks(stream.bytes, limits_for(std::max<std::size_t>(all / part, 4096)));
      if (bricks->statistics().base == 0) continue;
      const auto volume = cut_now(*bricks, view_of_all());
      REQUIRE(volume->values);
      CHECK(check_bricks(*volume, stream.bytes, extent) == all);
      CHECK(bricks->statistics().finest == 0);
    }
  }
}

TEST_CASE("bricks: Lost clusters cost the same samples as in the whole volume") {
  const Extent extent{150, 90, 70};
  EncodedStream stream = noisy_cells(extent);
  std::mt19937 random(4);
  StreamReader reader;
  Bytes damaged = stream.bytes;
  const auto take = [&](ChunkType type, std::span<const std::byte>, std::uint64_t offset) {
    if (type == ChunkType::values && offset > stream.bytes.size() / 3 && random() % 8 == 0)
      damaged[static_cast<std::size_t>(offset) + kChunkHeaderBytes + 5] ^= std::byte{1};
  };
  reader.push(stream.bytes, take);
  reader.finish(take);
  REQUIRE(damaged != stream.bytes);
  const auto bricks = open_bricks(damaged, limits_for(values::sample_count(extent) / 30));
  CHECK(check_bricks(*cut_now(*bricks, view_of_all()), damaged, extent) == values::sample_count(extent));
}

TEST_CASE("bricks: Without a usable directory, the whole stream is read once") {
  const Extent extent{150, 90, 70};
  EncodedStream stream = noisy_cells(extent);
  Bytes cut(stream.bytes.begin(), stream.bytes.begin() + static_cast<std::ptrdiff_t>(stream.header.directory));
  Bytes wrong = stream.bytes;
  wrong[static_cast<std::size_t>(stream.header.directory) + 20] ^= std::byte{4};
  const BrickLimits limits = limits_for(values::sample_count(extent) / 30);
  const auto expected = cut_now(*open_bricks(stream.bytes, limits), view_of_all());
  for (const Bytes& bytes : {cut, wrong}) {
    const auto volume = cut_now(*open_bricks(bytes, limits), view_of_all());
    CHECK(volume->positions == expected->positions);
    CHECK(volume->weights == expected->weights);
  }
}

TEST_CASE("bricks: Missing voxels are missing in bricks of the finest level") {
  const Extent extent{90, 80, 70};
  const EncodedStream stream = noisy_cells(extent, 1.6);
  const auto bricks = open_bricks(stream.bytes, limits_for(values::sample_count(extent) / 30));
  const auto volume = cut_now(*bricks, view_of_all());
  StreamDecoder decoder;
  decoder.push(stream.bytes);
  decoder.finish();
  const Geometry whole = decoder.geometry();
  const auto& source = whole.as<Volume>()->values->source;
  std::vector<float> slice(slice_voxels(source.layout));
  std::vector<std::byte> scratch;
  std::size_t missing = 0, compared = 0, different = 0;
  for (const ValueBrick& brick : volume->values->bricks) {
    if (brick.level != 0) continue;
    for (std::uint32_t z = brick.core_first[2]; z < brick.core_first[2] + brick.core_size[2]; ++z) {
      REQUIRE(read_slice(source, z, scratch, slice));
      for (std::uint32_t y = brick.core_first[1]; y < brick.core_first[1] + brick.core_size[1]; ++y)
        for (std::uint32_t x = brick.core_first[0]; x < brick.core_first[0] + brick.core_size[0]; ++x) {
          const float a = brick.value(x, y, z), b = slice[std::size_t{y} * extent[0] + x];
          ++compared;
          if (a != a) ++missing;
          if ((a != a) != (b != b) || (a == a && a != b)) ++different;
        }
    }
  }
  CHECK(compared > 0);
  CHECK(missing > compared / 100);
  CHECK(different == 0);
}

TEST_CASE("bricks: Memory stays within the budget, and the nearest bricks are the finest") {
  const Extent extent{260, 260, 140};
  const EncodedStream stream = noisy_cells(extent);
  constexpr std::size_t kBudget = std::size_t{24} << 20;
  const auto bricks = open_bricks(stream.bytes, limits_for(values::sample_count(extent) / 60, kBudget));
  std::size_t least = ~std::size_t{0};
  std::set<std::size_t> sizes;
  for (int turn = 0; turn < 6; ++turn) {
    const glm::vec3 eye(turn < 3 ? 0 : 259, 40.0f * static_cast<float>(turn), 20);
    const auto volume = cut_now(*bricks, view_at(eye, 2000));
    const BrickStatistics counts = bricks->statistics();
    CHECK(counts.bytes <= kBudget + kBudget / 4);
    CHECK(counts.shown > 0);
    CHECK(counts.finest == 0);
    least = std::min(least, counts.computed);
    for (const ValueBrick& brick : volume->values->bricks) {
      if (brick.level != 0) continue;
      for (std::size_t a = 0; a < 3; ++a) {
        const float to = static_cast<float>(brick.core_first[a]), eye_at = eye[static_cast<int>(a)];
        CHECK(std::abs(to + 32 - eye_at) < 200);
      }
    }
  }
  // Bricks that two views share are not computed again.
  CHECK(least < bricks->statistics().shown);
}

TEST_CASE("bricks: The same view gives the same vectors, whatever was shown before") {
  const Extent extent{200, 150, 140};
  const EncodedStream stream = noisy_cells(extent);
  const BrickLimits limits = limits_for(values::sample_count(extent) / 60, std::size_t{20} << 20);
  const LodView first = view_at({0, 0, 0}, 3000), second = view_at({199, 149, 100}, 2000);
  const auto a = open_bricks(stream.bytes, limits), b = open_bricks(stream.bytes, limits);
  (void)cut_now(*a, second);
  (void)cut_now(*a, view_of_all());
  const auto one = cut_now(*a, first), other = cut_now(*b, first);
  CHECK(one->positions == other->positions);
  CHECK(one->normals == other->normals);
  CHECK(one->weights == other->weights);
  CHECK(one->classes == other->classes);
  CHECK(cut_now(*a, first) == one);
}

TEST_CASE("bricks: Vectors of all levels have the share of the coarse vectors, once per place") {
  const Extent extent{200, 150, 140};
  const EncodedStream stream = noisy_cells(extent);
  const auto bricks = open_bricks(stream.bytes, limits_for(values::sample_count(extent) / 60));
  const auto coarse = bricks->latest();
  const auto fine = cut_now(*bricks, view_of_all());
  const auto all = static_cast<double>(values::sample_count(extent));
  CHECK(static_cast<double>(fine->size()) / all == Approx(0.09).epsilon(0.15));
  CHECK(coarse->size() < fine->size());
  std::set<std::array<float, 3>> places;
  for (const glm::vec3& p : fine->positions) places.insert({p.x, p.y, p.z});
  CHECK(places.size() == fine->size());
  for (std::size_t i = 1; i < fine->size(); ++i)
    CHECK_FALSE(std::log2(fine->weights[i]) > std::log2(fine->weights[i - 1]) + 1.0f / 64);
  CHECK(fine->cells.size() == fine->size());
}

// Stream that is received by requests.
struct Received {
  explicit Received(const EncodedStream& from, const BrickLimits& limits) : stream(from) {
    constexpr std::size_t kFront = 8000;
    auto begun = BrickVolume::begin(std::span(stream.bytes).first(kFront), limits);
    REQUIRE(std::holds_alternative<std::shared_ptr<BrickVolume>>(begun));
    bricks = std::get<0>(begun);
    REQUIRE(bricks->directory() == stream.header.directory);
    REQUIRE(bricks->set_directory(std::span(stream.bytes).subspan(static_cast<std::size_t>(bricks->directory()))));
  }
  // Adds chunks until the view has all. Returns their bytes.
  std::uint64_t receive(const LodView& view) {
    std::uint64_t bytes = 0;
    for (int round = 0; round < 100; ++round) {
      bool pending = false;
      (void)bricks->cut(view, pending);
      const auto wanted = bricks->wanted();
      if (wanted.empty()) break;
      for (const ChunkRange& range : wanted) {
        CHECK((asked.insert(range.offset).second || range.again));
        bricks->add(range.offset,
                    std::span(stream.bytes)
                        .subspan(static_cast<std::size_t>(range.offset), static_cast<std::size_t>(range.bytes)));
        bytes += range.bytes;
      }
    }
    CHECK(bricks->wanted().empty());
    return bytes;
  }

  const EncodedStream& stream;
  std::shared_ptr<BrickVolume> bricks;
  std::set<std::uint64_t> asked;
};

TEST_CASE("bricks: Views request only what they need, and a turn only what is new") {
  const Extent extent{260, 260, 140};
  const EncodedStream stream = noisy_cells(extent);
  const BrickLimits limits = limits_for(values::sample_count(extent) / 60, std::size_t{24} << 20);
  Received received(stream, limits);
  const LodView near = view_at({0, 0, 0}, 2000), beside = view_at({20, 0, 0}, 2000),
                far = view_at({259, 259, 139}, 2000);
  const std::uint64_t first = received.receive(near), turn = received.receive(beside), move = received.receive(far);
  CHECK(first > 0);
  CHECK(first < stream.bytes.size() / 2);
  CHECK(turn < first / 3);
  CHECK(move > 0);
  CHECK(received.receive(near) == 0);
  // The picture is that of the file.
  const auto file = open_bricks(stream.bytes, limits);
  const auto expected = cut_now(*file, near), shown = cut_now(*received.bricks, near);
  CHECK(shown->positions == expected->positions);
  CHECK(shown->weights == expected->weights);
}

TEST_CASE("bricks: Received chunks beyond the limit are dropped and requested again") {
  const Extent extent{260, 260, 140};
  const EncodedStream stream = noisy_cells(extent);
  BrickLimits limits = limits_for(values::sample_count(extent) / 60, std::size_t{12} << 20);
  limits.arrived_bytes = 600'000;
  Received received(stream, limits);
  const LodView near = view_at({0, 0, 0}, 2000), far = view_at({259, 259, 139}, 2000);
  CHECK(received.receive(near) > 0);
  CHECK(received.receive(far) > 0);
  (void)received.receive(near);
  const auto expected = cut_now(*open_bricks(stream.bytes, limits), near);
  const auto shown = cut_now(*received.bricks, near);
  CHECK(shown->positions == expected->positions);
}

TEST_CASE("bricks: Every prefix and mutated stream is safe") {
  const Extent extent{150, 90, 70};
  const EncodedStream stream = noisy_cells(extent);
  const BrickLimits limits = limits_for(values::sample_count(extent) / 30, std::size_t{8} << 20);
  std::mt19937 random(9);
  for (int i = 0; i < 60; ++i) {
    Bytes bytes = stream.bytes;
    if (i % 2 == 0) bytes.resize(random() % bytes.size());
    for (int flips = i % 3; flips > 0 && !bytes.empty(); --flips)
      bytes[random() % bytes.size()] ^= static_cast<std::byte>(1 << random() % 8);
    // Damage to the directory with a correct checksum.
    if (i % 5 == 0 && i % 2 != 0) {
      bytes.resize(static_cast<std::size_t>(stream.header.directory));
      Bytes payload(2000);
      for (std::byte& byte : payload) byte = static_cast<std::byte>(random() % 256);
      payload[0] = std::byte{14};
      for (std::size_t at = 1; at < 6; ++at) payload[at] = std::byte{0};
      const Bytes chunk = encode_chunk(ChunkType::places, payload);
      bytes.insert(bytes.end(), chunk.begin(), chunk.end());
    }
    auto opened = BrickVolume::open(memory_source(bytes), limits);
    if (auto* const bricks = std::get_if<0>(&opened)) (void)cut_now(**bricks, view_of_all());
  }
}

TEST_CASE("bricks: While a window draws, another thread decodes") {
  const Extent extent{150, 90, 70};
  const EncodedStream stream = noisy_cells(extent);
  const auto bricks = open_bricks(stream.bytes, limits_for(values::sample_count(extent) / 30));
  LodView view = view_of_all();
  const auto expected = cut_now(*bricks, view)->size();
  view.most_decoded = 100;
  view.eye.x -= 1;
  bool pending = false;
  (void)bricks->cut(view, pending);
  CHECK(pending);
  std::shared_ptr<const Volume> volume;
  for (int i = 0; i < 10000 && pending; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    pending = false;
    volume = bricks->cut(view, pending);
  }
  CHECK_FALSE(pending);
  CHECK(volume->size() == expected);
}

}  // namespace bricks_test
}  // namespace gs::qnv
