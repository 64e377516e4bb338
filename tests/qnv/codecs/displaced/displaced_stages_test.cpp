#include "qnv/codecs/displaced/encode/encode_displaced.h"
#include "qnv/codecs/displaced/surface.h"
#include "qnv/container/piece_group.h"
#include "qnv/reader/stream_decoder.h"
#include "tests/geometries.h"
#include "tests/qnv/codecs/displaced/displaced_shapes.h"
#include "tests/qnv/pinned_vectors.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cstddef>
#include <map>
#include <random>
#include <span>
#include <utility>
#include <variant>
#include <vector>

namespace gs::qnv::displaced::stages_test {
namespace {

using Bytes = std::vector<std::byte>;

struct Parts {
  Bytes head;
  std::vector<Bytes> chunks;
};

Parts parts_of(const Bytes& stream) {
  Parts parts;
  std::map<int, PieceGroup> groups;
  StreamReader reader;
  (void)reader.push(stream, [&](ChunkType type, std::span<const std::byte> payload, std::uint64_t) {
    if (type == ChunkType::displaced) parts.chunks.emplace_back(payload.begin(), payload.end());
    if (type != ChunkType::piece) return;
    // A chunk in pieces counts like a whole chunk.
    const auto piece = read_piece_header(payload);
    REQUIRE(piece);
    (void)groups[piece->group].add(*piece, payload);
    for (Bytes& each : groups[piece->group].take()) parts.chunks.push_back(std::move(each));
  });
  std::size_t bytes = 0;
  bool more = false;
  (void)decode_header(stream, bytes, more);
  parts.head.assign(stream.begin(), stream.begin() + static_cast<std::ptrdiff_t>(bytes));
  return parts;
}

StreamDecoder decoded(const Parts& parts, const std::vector<Bytes>& chunks) {
  StreamDecoder decoder;
  (void)decoder.push(parts.head);
  for (const Bytes& chunk : chunks) decoder.add(ChunkType::displaced, chunk);
  return decoder;
}

bool same(const IndexedMesh& a, const IndexedMesh& b) {
  return a.positions == b.positions && a.normals == b.normals && a.weights == b.weights && a.colors == b.colors &&
         a.triangles == b.triangles;
}

int kind_of(const Bytes& chunk) { return std::to_integer<int>(chunk[0]) & 15; }
int stage_of(const Bytes& chunk) { return std::to_integer<int>(chunk[0]) >> 4; }

std::vector<Corners> welded(const IndexedMesh& geometry) {
  Triangles triangles;
  for (std::size_t i = 0; i < geometry.triangles.size(); i += 3)
    triangles.push_back(triangle_of(geometry.positions[geometry.triangles[i]],
                                    geometry.positions[geometry.triangles[i + 1]],
                                    geometry.positions[geometry.triangles[i + 2]]));
  return mesh_of(triangles).triangles;
}

}  // namespace

TEST_CASE("switches to a later stage whatever the order of its chunks is") {
  const Parts parts = parts_of(read_bytes("displaced_stages.qnv"));
  const IndexedMesh wanted = content_of<IndexedMesh>(decoded(parts, parts.chunks).geometry());
  std::mt19937 random(2);
  std::vector<Bytes> chunks = parts.chunks;
  for (int round = 0; round < 12; ++round) {
    std::shuffle(chunks.begin(), chunks.end(), random);
    const StreamDecoder decoder = decoded(parts, chunks);
    CHECK(same(content_of<IndexedMesh>(decoder.geometry()), wanted));
    CHECK(decoder.refused_chunks() == 0);
  }
  // Moves the second stage's base after all others.
  std::stable_partition(chunks.begin(), chunks.end(), [](const Bytes& chunk) { return kind_of(chunk) != 0; });
  CHECK(same(content_of<IndexedMesh>(decoded(parts, chunks).geometry()), wanted));
}

TEST_CASE("keeps the previous stage if the base mesh of a stage is lost") {
  const Parts parts = parts_of(read_bytes("displaced_stages.qnv"));
  std::vector<Bytes> without, first;
  for (const Bytes& chunk : parts.chunks) {
    if (kind_of(chunk) != 0) without.push_back(chunk);
    if (stage_of(chunk) == 0) first.push_back(chunk);
  }
  REQUIRE(without.size() + 1 == parts.chunks.size());
  const IndexedMesh geometry = content_of<IndexedMesh>(decoded(parts, without).geometry());
  CHECK(same(geometry, content_of<IndexedMesh>(decoded(parts, first).geometry())));
  CHECK(!same(geometry, content_of<IndexedMesh>(decoded(parts, parts.chunks).geometry())));
  // A stream with a damaged first stage is shown from its second stage on.
  StreamReader reader;
  (void)reader.push(parts.head, [](ChunkType, std::span<const std::byte>, std::uint64_t) {});
  StreamHeader header = *reader.header();
  header.base.assign(header.base.size(), std::byte{0xff});
  StreamDecoder decoder;
  REQUIRE(decoder.push(encode_header(header)));
  CHECK(decoder.refused_chunks() == 1);
  CHECK(decoder.vectors() == 0);
  CHECK(decoder.geometry().size() == 0);
  for (const Bytes& chunk : parts.chunks) decoder.add(ChunkType::displaced, chunk);
  CHECK(same(content_of<IndexedMesh>(decoder.geometry()),
             content_of<IndexedMesh>(decoded(parts, parts.chunks).geometry())));
}

TEST_CASE("shows small parts beside the others as soon as their chunk is received") {
  Triangles all = ball(20);
  for (int i = 0; i < 3; ++i)
    for (Triangle t : ball(2)) {
      for (glm::vec3& p : t.positions) p = 0.004f * p + glm::vec3(1.5f, i, 0);
      all.push_back(t);
    }
  const auto made = encode_displaced(source_of(all), {});
  REQUIRE(std::holds_alternative<EncodedStream>(made));
  const Parts parts = parts_of(std::get<EncodedStream>(made).bytes);
  CHECK(components_of(welded(content_of<IndexedMesh>(decoded(parts, {}).geometry()))) == 1);
  const StreamDecoder whole = decoded(parts, parts.chunks);
  const IndexedMesh geometry = content_of<IndexedMesh>(whole.geometry());
  CHECK(whole.vectors() == geometry.size());
  const std::vector<Corners> triangles = welded(geometry);
  CHECK(components_of(triangles) == 4);
  CHECK(rims_of(triangles) == 0);
  CHECK(euler_characteristic(triangles) == 8);
  std::vector<Bytes> turned(parts.chunks.rbegin(), parts.chunks.rend());
  CHECK(same(content_of<IndexedMesh>(decoded(parts, turned).geometry()), geometry));
}

TEST_CASE("limits memory however many stages a stream claims") {
  const Parts parts = parts_of(read_bytes("displaced_stages.qnv"));
  const auto base =
      std::find_if(parts.chunks.begin(), parts.chunks.end(), [](const Bytes& chunk) { return kind_of(chunk) == 0; });
  REQUIRE(base != parts.chunks.end());
  constexpr std::size_t kMax = 1 << 17;
  for (const int flags : {1, 3}) {
    StreamDecoder decoder(kMax);
    REQUIRE(decoder.push(parts.head));
    for (int stage = 1; stage < 16; ++stage) {
      Bytes chunk = *base;
      chunk[0] = static_cast<std::byte>(stage << 4);
      chunk[1] = std::byte{8};
      chunk[3] = static_cast<std::byte>(flags);
      chunk[4] = std::byte{200};
      decoder.add(ChunkType::displaced, chunk);
      // Decodes clusters of all levels, down to the deepest.
      for (int level = 1; level <= 8; ++level) {
        ClusterHeader cluster{ClusterHeader::Kind::displacement, stage, level, 0, 0, 40, 0};
        Bytes payload = encode_cluster_header(cluster);
        payload.resize(payload.size() + 300, std::byte{0x5a});
        decoder.add(ChunkType::displaced, payload);
      }
    }
    CHECK(decoder.full());
    CHECK(decoder.vectors() <= kMax);
    CHECK(decoder.geometry().size() == decoder.vectors());
  }
}

}  // namespace gs::qnv::displaced::stages_test
