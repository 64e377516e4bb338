#include "qnv/codecs/payloads.h"
#include "qnv/codecs/values/cluster.h"
#include "qnv/codecs/values/decode/values_slices.h"
#include "qnv/codecs/values/labels/decode/label_levels.h"
#include "qnv/codecs/values/labels/encode/label_stream.h"
#include "qnv/reader/stream_decoder.h"
#include "qnv/sampling/volume/label_vectors.h"
#include "qnv/sampling/volume/volume_slices.h"
#include "qnv/sampling/volume/volume_values.h"
#include "tests/qnv/pinned_vectors.h"
#include "tests/qnv/value_streams.h"
#include "tests/qnv/volume_sources.h"
#include "tests/watched.h"

#include <catch2/catch.hpp>
#include <glm/geometric.hpp>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <map>
#include <random>
#include <sstream>
#include <string>
#include <variant>
#include <vector>

namespace gs::qnv {
namespace labels_test {

using test::oblique;
using test::volume_of;
using Shown = test::ShownValues;

template <class T>
VolumeSource labels_of(VolumeLayout layout, VoxelType type,
                       const std::function<double(std::uint32_t, std::uint32_t, std::uint32_t)>& label) {
  std::vector<T> voxels;
  const auto [nx, ny, nz] = layout.dimensions;
  for (std::uint32_t z = 0; z < nz; ++z)
    for (std::uint32_t y = 0; y < ny; ++y)
      for (std::uint32_t x = 0; x < nx; ++x) voxels.push_back(static_cast<T>(label(x, y, z)));
  layout.type = type;
  layout.labels = true;
  return volume_of(std::move(layout), std::move(voxels));
}

// Two balls in a shell, with a few stray voxels.
double organ(const VolumeLayout& layout, std::uint32_t x, std::uint32_t y, std::uint32_t z) {
  const auto [nx, ny, nz] = layout.dimensions;
  const double u = 2.0 * x / nx - 1, v = 2.0 * y / ny - 1, w = 2.0 * z / nz - 1;
  const double r = u * u + v * v + w * w, left = (u + 0.3) * (u + 0.3) + v * v + w * w;
  if ((x * 7919 + y * 104729 + z * 1299709) % 1013 == 0) return 9;
  return r > 0.9 ? 0 : r > 0.7 ? 2 : left < 0.1 ? 5 : u > 0.2 && r < 0.4 ? 7 : 3;
}
template <class T>
VolumeSource organs(const VolumeLayout& layout, VoxelType type, double scale = 1, double shift = 0) {
  return labels_of<T>(layout, type, [=](std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    return organ(layout, x, y, z) * scale + shift;
  });
}

EncodedStream stream_of(const VolumeSource& source, const EncodeOptions& options = {}) {
  return test::encoded_stream(encode_labels(source, options));
}

std::vector<double> numbers_in(const VolumeSource& source) {
  const std::size_t slice = slice_voxels(source.layout);
  std::vector<std::byte> stored(slice * size_of(source.layout.type));
  std::vector<double> all(voxel_count(source.layout));
  for (std::uint32_t z = 0; z < source.layout.dimensions[2]; ++z) {
    REQUIRE(source.read(z, stored));
    stored_numbers(source.layout, stored, std::span(all).subspan(z * slice, slice));
  }
  return all;
}

// Returns the share of voxels of the source with another label. `values` may be coarse.
double wrong_in(const VolumeSource& values, int level, const VolumeSource& source) {
  const std::vector<double> all = numbers_in(values), truth = numbers_in(source);
  const auto [nx, ny, nz] = source.layout.dimensions;
  const auto coarse = values.layout.dimensions;
  std::size_t wrong = 0, i = 0;
  for (std::uint32_t z = 0; z < nz; ++z)
    for (std::uint32_t y = 0; y < ny; ++y)
      for (std::uint32_t x = 0; x < nx; ++x) {
        const double label = all[(std::size_t{z >> level} * coarse[1] + (y >> level)) * coarse[0] + (x >> level)];
        wrong += label != truth[i++] ? 1 : 0;
      }
  return static_cast<double>(wrong) / static_cast<double>(truth.size());
}

TEST_CASE("labels: A stream restores labels of every type") {
  const VolumeLayout layout = oblique(37, 20, 18);
  const std::vector<VolumeSource> sources{organs<std::uint8_t>(layout, VoxelType::u8),
                                          organs<std::int8_t>(layout, VoxelType::i8, 13, -60),
                                          organs<std::uint16_t>(layout, VoxelType::u16, 7000),
                                          organs<std::int16_t>(layout, VoxelType::i16, -3000),
                                          organs<std::uint32_t>(layout, VoxelType::u32, 400'000'001),
                                          organs<std::int32_t>(layout, VoxelType::i32, -200'000'003),
                                          organs<float>(layout, VoxelType::f32, 1000),
                                          organs<double>(layout, VoxelType::f64, 300'000'001)};
  for (const VolumeSource& source : sources) {
    INFO(static_cast<int>(source.layout.type));
    const EncodedStream stream = stream_of(source);
    const Shown shown(stream.bytes);
    CHECK(shown.decoder.refused_chunks() == 0);
    CHECK(shown.values->exact);
    CHECK(shown.values->wrong == 0.0f);
    CHECK(shown.values->level == 0);
    CHECK(shown.values->source.layout.labels);
    CHECK(numbers_in(shown.values->source) == numbers_in(source));
    CHECK(shown.values->source.layout.axes == source.layout.axes);
    CHECK(shown.values->source.layout.origin == source.layout.origin);
    CHECK(stream.header.grid.palette.size() == 6);
    const auto opened = open_values_slices({stream.bytes.size(), [&](std::uint64_t offset, std::span<std::byte> to) {
                                              std::memcpy(to.data(), stream.bytes.data() + offset, to.size());
                                              return true;
                                            }});
    const auto* values = std::get_if<std::shared_ptr<const VolumeValues>>(&opened);
    REQUIRE(values);
    CHECK((*values)->exact);
    CHECK(numbers_in((*values)->source) == numbers_in(source));
  }
}

TEST_CASE("labels: restores volumes of any shape, with one label, and with a label for each voxel") {
  for (const std::array<std::uint32_t, 3> size :
       {std::array{1u, 1u, 1u}, {5u, 1u, 1u}, {1u, 33u, 2u}, {130u, 3u, 1u}, {17u, 17u, 17u}, {4u, 64u, 5u}}) {
    INFO(size[0] << " " << size[1] << " " << size[2]);
    VolumeLayout layout;
    layout.dimensions = size;
    std::mt19937 random(3);
    for (const std::uint32_t count : {1u, 2u, 3u, 100'000u}) {
      const VolumeSource source =
          labels_of<std::uint32_t>(layout, VoxelType::u32, [&](auto, auto, auto) { return random() % count; });
      const EncodedStream stream = stream_of(source);
      const Shown shown(stream.bytes);
      CHECK(shown.values->exact);
      CHECK(numbers_in(shown.values->source) == numbers_in(source));
    }
  }
}

TEST_CASE("labels: Each prefix states its share of wrong labels, and never shows other labels") {
  const VolumeSource source = organs<std::uint16_t>(oblique(90, 80, 70), VoxelType::u16, 11);
  EncodeOptions options;
  options.parity = 0;
  const EncodedStream stream = stream_of(source, options);
  std::vector<std::size_t> ends;
  StreamReader reader;
  (void)reader.push(stream.bytes, [&](ChunkType type, std::span<const std::byte> payload, std::uint64_t offset) {
    if (type == ChunkType::labels) ends.push_back(offset + kChunkHeaderBytes + payload.size());
    CHECK(payload.size() <= (type == ChunkType::labels ? values::kMaxClusterBytes : kMaxChunkBytes));
  });
  REQUIRE(ends.size() > 6);
  double before = 1;
  for (std::size_t i = 0; i < ends.size(); ++i) {
    const Shown shown(std::span(stream.bytes).first(ends[i]));
    const double wrong = wrong_in(shown.values->source, shown.values->level, source);
    CHECK(wrong <= before + 1e-9);
    before = wrong;
    for (const ValueError& error : stream.header.grid.errors)
      if (error.chunks == i + 1) {
        REQUIRE(shown.values->wrong);
        CHECK(*shown.values->wrong == error.most);
        if (shown.values->level == 0) CHECK(wrong == Approx(error.most).margin(1e-6));
      }
    for (const double number : numbers_in(shown.values->source)) REQUIRE_EACH(std::fmod(number, 11) == 0);
  }
  CHECK(before == 0);
}

TEST_CASE("labels: Every byte prefix and split point decodes") {
  const VolumeSource source = organs<std::uint8_t>(oblique(16, 13, 9), VoxelType::u8);
  const EncodedStream stream = stream_of(source);
  const std::vector<double> whole = numbers_in(Shown(stream.bytes).values->source);
  for (std::size_t at = 0; at <= stream.bytes.size(); at += watched_step(7)) {
    StreamDecoder decoder;
    (void)decoder.push(std::span(stream.bytes).first(at));
    CHECK(decoder.geometry().size() < 10'000);
    (void)decoder.push(std::span(stream.bytes).subspan(at));
    decoder.finish();
    const Geometry geometry = decoder.geometry();
    REQUIRE(geometry.as<Volume>());
    CHECK(numbers_in(geometry.as<Volume>()->values->source) == whole);
  }
}

TEST_CASE("labels: A flipped bit costs at most its chunk") {
  const VolumeSource source = organs<std::uint8_t>(oblique(16, 13, 9), VoxelType::u8);
  EncodeOptions options;
  options.parity = 0;
  const EncodedStream stream = stream_of(source, options);
  const std::size_t head = encode_header(stream.header).size();
  for (std::size_t bit = head * 8; bit < stream.header.directory * 8; bit += watched_step(13)) {
    std::vector<std::byte> bytes = stream.bytes;
    bytes[bit / 8] ^= std::byte(1u << bit % 8);
    const Shown shown(bytes);
    CHECK_FALSE(shown.values->wrong.value_or(1) < 0);
    for (const double number : numbers_in(shown.values->source)) REQUIRE_EACH(number >= 0 && number <= 9);
  }
}

TEST_CASE("labels: A lost chunk costs one box at one level") {
  const VolumeSource source = organs<std::uint16_t>(oblique(90, 80, 70), VoxelType::u16);
  EncodeOptions options;
  options.parity = 0;
  const EncodedStream stream = stream_of(source, options);
  std::vector<std::vector<std::byte>> payloads;
  StreamReader reader;
  (void)reader.push(stream.bytes, [&](ChunkType type, std::span<const std::byte> payload, std::uint64_t) {
    if (type == ChunkType::labels) payloads.emplace_back(payload.begin(), payload.end());
  });
  for (std::size_t lost = 0; lost < payloads.size(); ++lost) {
    StreamDecoder decoder;
    (void)decoder.push(encode_header(stream.header));
    for (std::size_t i = 0; i < payloads.size(); ++i)
      if (i != lost) decoder.add(ChunkType::labels, payloads[i]);
    const Geometry geometry = decoder.geometry();
    const auto& values = *geometry.as<Volume>()->values;
    const double wrong = wrong_in(values.source, values.level, source);
    const bool finest = payloads[lost].front() == std::byte{0};
    CHECK((finest ? wrong < 0.04 : wrong == 0));
    CHECK(values.exact == !finest);
  }
  // Without all of the finest level, the next one shows.
  StreamDecoder decoder;
  (void)decoder.push(encode_header(stream.header));
  for (const auto& payload : payloads)
    if (payload.front() != std::byte{0}) decoder.add(ChunkType::labels, payload);
  const Geometry geometry = decoder.geometry();
  CHECK(wrong_in(geometry.as<Volume>()->values->source, geometry.as<Volume>()->values->level, source) < 0.12);
}

TEST_CASE("labels: Parity restores lost chunks by default") {
  const VolumeSource source = organs<std::uint16_t>(oblique(90, 80, 70), VoxelType::u16);
  EncodeOptions options;
  options.parity = 0.3;
  const EncodedStream stream = stream_of(source, options);
  StreamDecoder decoder;
  StreamReader reader;
  std::mt19937 random(5);
  (void)decoder.push(encode_header(stream.header));
  (void)reader.push(stream.bytes, [&](ChunkType type, std::span<const std::byte> payload, std::uint64_t) {
    if (random() % 4 != 0) decoder.add(type, payload);
  });
  const Geometry geometry = decoder.geometry();
  CHECK(geometry.as<Volume>()->values->exact);
  CHECK(stream_of(source).header.parity);
}

TEST_CASE("labels: Thin sheets remain in coarse levels") {
  VolumeLayout layout;
  layout.dimensions = {64, 64, 64};
  const VolumeSource source = labels_of<std::uint8_t>(
      layout, VoxelType::u8, [](std::uint32_t x, std::uint32_t, std::uint32_t) { return x == 21 ? 1 : 0; });
  EncodeOptions options;
  options.parity = 0;
  const EncodedStream stream = stream_of(source, options);
  StreamDecoder decoder;
  StreamReader reader;
  (void)decoder.push(encode_header(stream.header));
  (void)reader.push(stream.bytes, [&](ChunkType type, std::span<const std::byte> payload, std::uint64_t) {
    if (type == ChunkType::labels && payload.front() == std::byte{2}) decoder.add(type, payload);
  });
  const Geometry geometry = decoder.geometry();
  std::size_t ones = 0;
  for (const double number : numbers_in(geometry.as<Volume>()->values->source)) ones += number == 1 ? 1 : 0;
  CHECK(ones > 0);
}

TEST_CASE("labels: Coarse voxels lie in the middle of those that they stand for") {
  VolumeLayout layout;
  layout.dimensions = {64, 32, 1};
  layout.axes[0] *= 2.0f;
  const EncodedStream stream =
      stream_of(labels_of<std::uint8_t>(layout, VoxelType::u8, [](std::uint32_t x, auto, auto) { return x / 32; }));
  const Shown shown(stream.bytes, 1);
  REQUIRE(shown.values->level == 0);
  StreamDecoder few(20);
  (void)few.push(stream.bytes);
  CHECK(few.full() == false);
  const Shown coarse(stream_of(labels_of<std::uint8_t>(oblique(128, 128, 4), VoxelType::u8,
                                                       [](std::uint32_t x, auto, auto) { return x / 32; }))
                         .bytes,
                     512);
  REQUIRE(coarse.values->level == 2);
  CHECK(coarse.decoder.full());
  const VolumeLayout& now = coarse.values->source.layout;
  CHECK(now.dimensions == std::array{32u, 32u, 1u});
  const glm::dvec3 middle = glm::dvec3(10, -20, 30) + glm::dvec3(oblique(1, 1, 1).axes[0]) * 1.5 +
                            glm::dvec3(oblique(1, 1, 1).axes[1]) * 1.5 + glm::dvec3(oblique(1, 1, 1).axes[2]) * 1.5;
  CHECK(glm::length(now.origin - middle) < 1e-6);
}

TEST_CASE("labels: Vectors lie on the surfaces of labels, in their colours, and their normals are smooth") {
  VolumeLayout layout;
  layout.dimensions = {40, 40, 40};
  const auto ball = [](std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    const double r = std::hypot(x - 20.0, y - 20.0, z - 20.0);
    return r < 12 ? 3.0 : 0.0;
  };
  const auto found = label_vectors(labels_of<std::uint8_t>(layout, VoxelType::u8, ball), {});
  const auto* volume = std::get_if<Volume>(&found);
  REQUIRE(volume);
  REQUIRE(volume->size() > 1000);
  CHECK(volume->colors.empty());
  for (std::size_t i = 0; i < volume->size(); ++i) {
    const glm::vec3 out = volume->positions[i] - glm::vec3(20);
    CHECK(std::abs(glm::length(out) - 12) < 0.75f);
    CHECK(std::abs(glm::dot(glm::normalize(out), volume->normals[i])) > 0.96f);
    CHECK(volume->classes[i] == 255);
  }
  CHECK(volume->description.transfer.back().color == label_color(3));
  // Labels that share a class have colours of their own.
  const auto far = label_vectors(labels_of<std::uint32_t>(layout, VoxelType::u32,
                                                          [&](auto x, auto y, auto z) {
                                                            return ball(x, y, z) > 0 ? 1 + (x > 20) : y > 37 ? 4e9 : 0;
                                                          }),
                                 {});
  REQUIRE(std::get_if<Volume>(&far));
  CHECK(std::get<Volume>(far).colors.size() == std::get<Volume>(far).size());
  // A smaller number of vectors is spread over the whole surface.
  GradientOptions few;
  few.vectors = 100;
  const auto some = label_vectors(labels_of<std::uint8_t>(layout, VoxelType::u8, ball), few);
  glm::vec3 mean(0);
  for (const glm::vec3& p : std::get<Volume>(some).positions) mean += p / 100.0f;
  CHECK(std::get<Volume>(some).size() == 100);
  CHECK(glm::length(mean - glm::vec3(20)) < 3);
}

TEST_CASE("labels: Hostile streams leave the decoder in a valid state") {
  const EncodedStream stream = stream_of(organs<std::uint16_t>(oblique(60, 50, 40), VoxelType::u16, 9));
  std::vector<std::vector<std::byte>> payloads;
  StreamReader reader;
  (void)reader.push(stream.bytes, [&](ChunkType type, std::span<const std::byte> payload, std::uint64_t) {
    if (type != ChunkType::directory) payloads.emplace_back(payload.begin(), payload.end());
  });
  std::mt19937 random(8);
  for (int round = 0; round < 60; ++round) {
    StreamHeader header = stream.header;
    if (random() % 3 == 0) header.grid.dimensions[random() % 3] = 1 + random() % 100;
    if (random() % 3 == 0) header.grid.palette = LabelPalette(std::vector<std::uint32_t>{5, 0xffffffff});
    if (random() % 4 == 0) header.grid.stored = static_cast<VoxelType>(random() % 7);
    StreamDecoder decoder(5000);
    (void)decoder.push(encode_header(header));
    for (auto bytes : payloads) {
      if (random() % 2 == 0) bytes[random() % std::min<std::size_t>(bytes.size(), 16)] ^= std::byte(1u << random() % 8);
      if (random() % 9 == 0) bytes.resize(random() % (bytes.size() + 1));
      constexpr ChunkType kTypes[] = {ChunkType::values, ChunkType::gaps, ChunkType::remainders};
      decoder.add(random() % 4 == 0 ? kTypes[random() % 3] : ChunkType::labels, bytes);
    }
    CHECK(decoder.geometry().as<Volume>() != nullptr);
  }
}

TEST_CASE("labels: Headers with invalid palettes and grids are rejected") {
  const EncodedStream stream = stream_of(organs<std::uint16_t>(oblique(20, 20, 20), VoxelType::u16));
  const auto accepted = [](const StreamHeader& header) {
    std::size_t bytes = 0;
    bool more = false;
    return std::holds_alternative<StreamHeader>(decode_header(encode_header(header), bytes, more));
  };
  CHECK(accepted(stream.header));
  StreamHeader header = stream.header;
  header.grid.palette = {};
  CHECK_FALSE(accepted(header));
  header = stream.header;
  header.grid.gaps = true;
  CHECK_FALSE(accepted(header));
  header = stream.header;
  header.grid.dimensions = {(1u << 20) + 1, 1, 1};
  CHECK_FALSE(accepted(header));
  const std::vector<std::vector<std::uint32_t>> sets{
      {0}, {0xffffffff}, {0, 1, 2, 3}, {1, 5, 6, 7, 0x80000000, 0xffffffff}};
  for (const auto& codes : sets) {
    const LabelPalette palette(codes);
    const std::vector<std::byte> section = encode_label_palette(palette);
    CHECK(decode_label_palette(section) == palette);
    for (std::size_t i = 0; i < codes.size(); ++i) {
      CHECK(palette.code(static_cast<std::uint32_t>(i)) == codes[i]);
      CHECK(palette.index(codes[i]) == i);
    }
    CHECK_FALSE(palette.index(4));
    CHECK_FALSE(decode_label_palette(std::span(section).first(section.size() - 1)));
  }
  CHECK_FALSE(decode_label_palette({}));
  std::vector<std::byte> beyond = encode_label_palette(LabelPalette(std::vector<std::uint32_t>{0xffffffff}));
  beyond.push_back(std::byte{0});
  beyond.push_back(std::byte{0});
  CHECK_FALSE(decode_label_palette(beyond));
}

/// Store that fails after some bytes.
class FullStore final : public SpillStore {
 public:
  explicit FullStore(std::uint64_t most) : most_(most) {}
  bool append(std::span<const std::byte> bytes) override {
    return memory_.size() + bytes.size() <= most_ && memory_.append(bytes);
  }
  [[nodiscard]] std::uint64_t size() const override { return memory_.size(); }
  bool read(std::uint64_t offset, std::span<std::byte> to) const override { return memory_.read(offset, to); }
  [[nodiscard]] std::string problem() const override { return "the disk is full"; }

 private:
  MemoryStore memory_;
  std::uint64_t most_;
};

TEST_CASE("labels: Encodes equal bytes with any number of threads and any store") {
  const VolumeSource source = organs<std::uint16_t>(oblique(150, 70, 67), VoxelType::u16, 7);
  EncodeOptions options;
  options.threads = 1;
  const EncodedStream stream = stream_of(source, options);
  FullStore store(std::uint64_t{1} << 30);
  options.spill = &store;
  options.threads = 3;
  CHECK(stream_of(source, options).bytes == stream.bytes);
  CHECK(store.size() > 0);
  for (const std::uint64_t most : {std::uint64_t{0}, store.size() / 3, store.size() - 1}) {
    FullStore full(most);
    options.spill = &full;
    const auto encoded = encode_labels(source, options);
    REQUIRE(std::holds_alternative<EncodeError>(encoded));
    CHECK(std::get<EncodeError>(encoded).message.find("the disk is full") != std::string::npos);
  }
}

TEST_CASE("labels: Returns slices with the finest received labels") {
  const VolumeSource source = organs<std::uint16_t>(oblique(150, 70, 67), VoxelType::u16, 7);
  const EncodedStream stream = stream_of(source);
  const auto all = test::slices_of(stream.bytes);
  CHECK(all->exact);
  CHECK(all->wrong == 0.0f);
  CHECK(numbers_in(all->source) == numbers_in(source));
  for (const std::size_t part : {8u, 3u, 2u}) {
    INFO(part);
    const std::vector<std::byte> cut(stream.bytes.begin(),
                                     stream.bytes.begin() + static_cast<std::ptrdiff_t>(stream.bytes.size() / part));
    const Shown shown(cut);
    const auto slices = test::slices_of(cut);
    CHECK_FALSE(slices->exact);
    REQUIRE(shown.values->level == 0);
    CHECK(numbers_in(slices->source) == numbers_in(shown.values->source));
  }
  // Slices in any order are the same.
  std::vector<std::byte> last(slice_voxels(all->source.layout) * 4), again(last.size());
  CHECK(all->source.read(66, last));
  CHECK(all->source.read(0, again));
  CHECK(all->source.read(66, again));
  CHECK(last == again);
  CHECK_FALSE(all->source.read(67, again));
}

TEST_CASE("labels: refuses numbers with a fraction") {
  const auto encoded = encode_labels(organs<float>(oblique(9, 9, 9), VoxelType::f32, 0.3), {});
  REQUIRE(std::holds_alternative<EncodeError>(encoded));
  CHECK(std::get<EncodeError>(encoded).message.find("whole numbers") != std::string::npos);
}

TEST_CASE("labels: FORMAT.md's stream decodes to the codes of an independent decoder") {
  const std::string name = "values_labels";
  const std::string expected = read_text(name + ".txt");
  REQUIRE(expected.size() > 5000);
  const Shown shown(read_bytes(name + ".qnv"));
  CHECK(shown.values->exact);
  std::ostringstream out;
  for (const double number : numbers_in(shown.values->source))
    out << static_cast<std::uint32_t>(static_cast<std::int32_t>(number)) << '\n';
  CHECK(out.str() == expected);
  check_independent_decoder("values_decode.py", name, expected);
}

}  // namespace labels_test
}  // namespace gs::qnv
