#include "qnv/codecs/displaced/encode/encode_displaced.h"
#include "qnv/codecs/encode.h"
#include "qnv/codecs/values/encode/values_stream.h"
#include "qnv/reader/loss.h"
#include "qnv/reader/stream_decoder.h"
#include "qnv/sampling/volume/volume_slices.h"
#include "qnv/sampling/volume/volume_values.h"
#include "tests/qnv/surface_shapes.h"
#include "tests/qnv/volume_sources.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <random>
#include <variant>
#include <vector>

namespace gs::qnv::values_loss_test {
namespace {

using Bytes = std::vector<std::byte>;

VolumeSource rippled(std::uint32_t edge) {
  std::mt19937 random(7);
  VolumeLayout layout = test::oblique(edge, edge - 3, edge - 7);
  std::vector<std::uint8_t> voxels;
  for (std::uint32_t z = 0; z < edge - 7; ++z)
    for (std::uint32_t y = 0; y < edge - 3; ++y)
      for (std::uint32_t x = 0; x < edge; ++x)
        voxels.push_back(static_cast<std::uint8_t>(120 + 60 * std::sin(x / 5.0 + y / 9.0) * std::cos(z / 4.0) +
                                                   (x * y > z * 40 ? 50 : 0) + static_cast<double>(random() % 8)));
  layout.type = VoxelType::u8;
  return test::volume_of(std::move(layout), std::move(voxels));
}

EncodedStream stream_with(const VolumeSource& source, std::optional<double> parity, std::size_t max_bytes = 0) {
  EncodeOptions options;
  options.parity = parity;
  options.max_bytes = max_bytes;
  auto encoded = encode_values(source, options);
  REQUIRE(std::holds_alternative<EncodedStream>(encoded));
  return std::get<EncodedStream>(std::move(encoded));
}

std::vector<std::pair<ChunkType, Bytes>> chunks_in(std::span<const std::byte> bytes) {
  std::vector<std::pair<ChunkType, Bytes>> chunks;
  StreamReader reader;
  (void)reader.push(bytes, [&](ChunkType type, std::span<const std::byte> payload, std::uint64_t) {
    chunks.emplace_back(type, Bytes(payload.begin(), payload.end()));
  });
  return chunks;
}

struct Decoded {
  std::vector<float> values;
  bool exact = false;
  std::size_t restored = 0;
};

Decoded decoded(const StreamDecoder& decoder) {
  const Geometry geometry = decoder.geometry();
  const auto* volume = geometry.as<Volume>();
  REQUIRE(volume);
  REQUIRE(volume->values);
  const VolumeSource& source = volume->values->source;
  Decoded out{std::vector<float>(voxel_count(source.layout)), volume->values->exact, decoder.restored_chunks()};
  Bytes scratch;
  const std::size_t slice = slice_voxels(source.layout);
  for (std::uint32_t z = 0; z < source.layout.dimensions[2]; ++z)
    REQUIRE(read_slice(source, z, scratch, std::span(out.values).subspan(z * slice, slice)));
  return out;
}

// Decodes a stream of which any chunk may be lost, but the header is not.
Decoded after_loss(const EncodedStream& stream, double loss, unsigned seed, std::size_t prefix = ~std::size_t{0}) {
  std::mt19937 random(seed);
  StreamDecoder decoder;
  (void)decoder.push(encode_header(stream.header));
  for (const auto& [type, payload] : chunks_in(std::span(stream.bytes).first(std::min(prefix, stream.bytes.size()))))
    if (random() >= loss * 4294967296.0) decoder.add(type, payload);
  CHECK(decoder.refused_chunks() == 0);
  return decoded(decoder);
}

double rms(const std::vector<float>& a, const std::vector<float>& b) {
  REQUIRE(a.size() == b.size());
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += std::pow(static_cast<double>(a[i]) - static_cast<double>(b[i]), 2);
  return std::sqrt(sum / static_cast<double>(a.size()));
}

}  // namespace

TEST_CASE("losses: Parity restores values bit for bit after the stated loss") {
  const VolumeSource source = rippled(60);
  const Decoded truth = after_loss(stream_with(source, 0.0), 0, 0);
  REQUIRE(truth.exact);
  CHECK(truth.restored == 0);
  for (const double loss : {0.1, 0.3}) {
    const EncodedStream stream = stream_with(source, loss);
    CHECK(stream.header.parity);
    int whole = 0;
    for (unsigned seed = 1; seed <= 8; ++seed) {
      const Decoded found = after_loss(stream, loss, seed);
      whole += found.exact && found.values == truth.values && found.restored > 0 ? 1 : 0;
    }
    INFO("loss " << loss);
    CHECK(whole >= 7);
    // The losses of --loss, in file order, and damaged chunks.
    StreamDecoder lossy;
    (void)lossy.push(drop_packets(stream.bytes, loss, 3));
    lossy.finish();
    CHECK(decoded(lossy).values == truth.values);
    Bytes damaged = stream.bytes;
    std::mt19937 random(4);
    for (std::size_t at = 2000; at < damaged.size(); at += 8000) damaged[at + random() % 500] ^= std::byte{64};
    StreamDecoder repaired;
    (void)repaired.push(damaged);
    repaired.finish();
    CHECK(decoded(repaired).values == truth.values);
    CHECK(repaired.restored_chunks() > 3);
  }
}

TEST_CASE("losses: A prefix with parity loses little") {
  const VolumeSource source = rippled(60);
  const Decoded truth = after_loss(stream_with(source, 0.0), 0, 0);
  const EncodedStream plain = stream_with(source, 0.0), some = stream_with(source, std::nullopt),
                      much = stream_with(source, 0.3);
  CHECK(static_cast<double>(some.bytes.size()) < 1.03 * static_cast<double>(plain.bytes.size()) + 2000);
  const auto error = [&](const EncodedStream& stream, double loss) {
    double sum = 0;
    for (unsigned seed = 1; seed <= 6; ++seed) sum += rms(after_loss(stream, loss, seed, 40'000).values, truth.values);
    return sum / 6;
  };
  // The default: coarse chunks survive, at little cost.
  CHECK(error(some, 0) < 1.1 * error(plain, 0));
  CHECK(error(some, 0.1) < 0.75 * error(plain, 0.1));
  CHECK(error(much, 0.3) < 1.19 * error(much, 0));  // 1.5 dB
  CHECK(error(plain, 0.3) > 2 * error(much, 0.3));
}

TEST_CASE("losses: The directory omits parity, and a stream of limited size has room for it") {
  const VolumeSource source = rippled(50);
  for (const std::optional<double> parity : {std::optional<double>(), std::optional<double>(0.2)})
    for (const std::size_t bytes : {std::size_t{6000}, std::size_t{30'000}, std::size_t{0}}) {
      const EncodedStream stream = stream_with(source, parity, bytes);
      INFO("limit " << bytes << ", " << stream.bytes.size() << " bytes");
      if (bytes > 0) {
        CHECK(stream.bytes.size() <= bytes);
        CHECK(stream.bytes.size() > bytes / 2);
      }
      StreamDecoder decoder;
      (void)decoder.push(stream.bytes);
      decoder.finish();
      CHECK(decoder.problems().empty());
      const auto all = chunks_in(stream.bytes);
      const auto of_parity =
          static_cast<std::size_t>(std::ranges::count(all, ChunkType::parity, &std::pair<ChunkType, Bytes>::first));
      CHECK(of_parity > 0);
      CHECK(decoder.directory().size() == stream.header.chunks);
      CHECK(all.size() == stream.header.chunks + of_parity + 1);
      for (const DirectoryEntry& entry : decoder.directory())
        CHECK(chunk_head(std::span(stream.bytes).subspan(entry.offset))->type == ChunkType::values);
      // The last error holds: no counted chunk was dropped for parity.
      CHECK(stream.header.grid.errors.back().chunks == stream.header.chunks);
    }
}

TEST_CASE("losses: Readers ignore parity that the header does not announce") {
  EncodedStream stream = stream_with(rippled(30), 0.3);
  stream.header.parity = false;
  StreamDecoder decoder;
  (void)decoder.push(encode_header(stream.header));
  std::size_t number = 0;
  for (const auto& [type, payload] : chunks_in(stream.bytes))
    if (++number != 3) decoder.add(type, payload);
  CHECK(decoder.restored_chunks() == 0);
  CHECK(decoder.refused_chunks() == 0);
}

TEST_CASE("losses: Parity restores the clusters of a displaced mesh, and other payloads refuse it") {
  EncodeOptions options;
  options.parity = 0.3;
  const auto triangles = sphere(30);
  const TriangleSource surface = source_of(triangles);
  const auto made = encode_displaced(surface, options);
  REQUIRE(std::holds_alternative<EncodedStream>(made));
  const auto& stream = std::get<EncodedStream>(made);
  CHECK(stream.header.parity);
  StreamDecoder whole, lossy;
  (void)whole.push(stream.bytes);
  (void)lossy.push(drop_packets(stream.bytes, 0.2, 5));
  CHECK(lossy.refused_chunks() == 0);
  CHECK(whole.geometry().size() == lossy.geometry().size());
  EncodeRequest request{Payload::packed, options};
  const auto octree = encode(std::cref(surface), request);
  REQUIRE(std::holds_alternative<EncodeError>(octree));
  CHECK(std::get<EncodeError>(octree).message.starts_with("--parity protects displaced meshes, values and Gaussians;"));
}

}  // namespace gs::qnv::values_loss_test
