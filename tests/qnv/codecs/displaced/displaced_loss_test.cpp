#include "qnv/codecs/displaced/encode/encode_displaced.h"
#include "qnv/reader/stream_decoder.h"
#include "tests/geometries.h"
#include "tests/qnv/codecs/displaced/displaced_shapes.h"
#include "tests/qnv/pinned_vectors.h"
#include "tests/watched.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <random>
#include <span>
#include <utility>
#include <variant>
#include <vector>

namespace gs::qnv::displaced::loss_test {
namespace {

using Bytes = std::vector<std::byte>;

struct Parts {
  Bytes head;
  std::vector<std::pair<ChunkType, Bytes>> chunks;
};

Parts parts_of(const Bytes& stream) {
  Parts parts;
  StreamReader reader;
  (void)reader.push(stream, [&](ChunkType type, std::span<const std::byte> payload, std::uint64_t) {
    if (type != ChunkType::directory) parts.chunks.emplace_back(type, Bytes(payload.begin(), payload.end()));
  });
  std::size_t bytes = 0;
  bool more = false;
  (void)decode_header(stream, bytes, more);
  parts.head.assign(stream.begin(), stream.begin() + static_cast<std::ptrdiff_t>(bytes));
  return parts;
}

StreamDecoder decoded(const Parts& parts, double lost, unsigned seed) {
  StreamDecoder decoder;
  (void)decoder.push(parts.head);
  std::mt19937 random(seed);
  for (const auto& [type, payload] : parts.chunks)
    if (static_cast<double>(random()) / 4294967296.0 >= lost) decoder.add(type, payload);
  CHECK(decoder.refused_chunks() == 0);
  return decoder;
}

}  // namespace

TEST_CASE("replaces parts with many sharp edges by an exact mesh that survives losses") {
  EncodeOptions options;
  options.only_if_suited = true;
  const Triangles source = wheel();
  const auto made = encode_displaced(source_of(source), options);
  REQUIRE(std::holds_alternative<EncodedStream>(made));
  const Bytes& stream = std::get<EncodedStream>(made).bytes;
  CHECK(stream.size() < 8 * source.size());
  const Parts parts = parts_of(stream);
  CHECK(parts.head.size() <= 1000);
  for (const auto& [type, payload] : parts.chunks) CHECK(payload.size() <= 1300);
  const StreamDecoder all = decoded(parts, 0, 1);
  CHECK(all.mesh().final);
  const IndexedMesh geometry = content_of<IndexedMesh>(all.geometry());
  CHECK(geometry.triangles.size() == 3 * source.size());
  CHECK(all.vectors() == geometry.size());
  std::size_t whole = 0;
  for (unsigned seed = 1; seed <= 40; ++seed) whole += decoded(parts, 0.3, seed).mesh().final ? 1 : 0;
  CHECK(whole >= 37);
  // A prefix shows as much as is received, from the header on.
  std::size_t before = 0;
  for (std::size_t n = 1000; n <= stream.size(); n += watched_step(7) * 500) {
    StreamDecoder decoder;
    REQUIRE(decoder.push(std::span(stream).first(n)));
    const std::size_t triangles = content_of<IndexedMesh>(decoder.geometry()).triangles.size();
    REQUIRE_EACH(triangles >= std::max<std::size_t>(before, 300));
    before = triangles;
  }
  // If only a part of the mesh fits, the stream ends with that part.
  options.max_bytes = parts.head.size() + 700;
  const auto smaller = encode_displaced(source_of(source), options);
  REQUIRE(std::holds_alternative<EncodedStream>(smaller));
  const Bytes& part = std::get<EncodedStream>(smaller).bytes;
  CHECK(part.size() <= options.max_bytes);
  CHECK(!decoded(parts_of(part), 0, 1).mesh().final);
  CHECK(content_of<IndexedMesh>(decoded(parts_of(part), 0, 1).geometry()).triangles.size() >= 300);
}

TEST_CASE("shows the last stage after the loss of a third of its pieces") {
  // tests/qnv/vectors/v1/displaced_pieces.qnv has two stages.
  const Parts parts = parts_of(read_bytes("displaced_pieces.qnv"));
  REQUIRE(std::ranges::count(parts.chunks, ChunkType::piece, &std::pair<ChunkType, Bytes>::first) > 5);
  const auto shown = [&](double lost, unsigned seed) {
    return content_of<IndexedMesh>(decoded(parts, lost, seed).geometry()).triangles.size();
  };
  Parts first = parts;
  std::erase_if(first.chunks, [](const auto& chunk) { return chunk.first == ChunkType::piece; });
  const std::size_t of_all = shown(0, 1),
                    of_first = content_of<IndexedMesh>(decoded(first, 0, 1).geometry()).triangles.size();
  REQUIRE(of_first != of_all);
  std::size_t last = 0;
  for (unsigned seed = 1; seed <= 40; ++seed) last += shown(0.3, seed) != of_first ? 1 : 0;
  CHECK(last >= 37);
}

}  // namespace gs::qnv::displaced::loss_test
