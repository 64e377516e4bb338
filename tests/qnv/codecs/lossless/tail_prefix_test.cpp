#include "qnv/codecs/displaced/encode/encode_displaced.h"
#include "qnv/codecs/lossless/cover.h"
#include "qnv/codecs/lossless/decode/tail_reader.h"
#include "qnv/codecs/payloads.h"
#include "qnv/container/piece_group.h"
#include "qnv/reader/loss.h"
#include "qnv/reader/stream_decoder.h"
#include "tests/geometries.h"
#include "tests/qnv/codecs/lossless/exact_shapes.h"
#include "tests/watched.h"

#include <catch2/catch.hpp>

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <span>
#include <variant>

// Tests of the picture of a partly received tail.
namespace gs::qnv::exact::prefix_test {
namespace {

using Bytes = std::vector<std::byte>;

constexpr std::size_t kMax = std::size_t{1} << 20;

/// Returns mixed ranks, so that a mesh grows in several areas.
TailRanks some_ranks() {
  TailRanks ranks{3, std::vector<std::uint8_t>(512)};
  std::mt19937 random(5);
  for (std::uint8_t& rank : ranks.of) rank = static_cast<std::uint8_t>(random() % 8);
  return ranks;
}

Triangles bumpy_ball() {
  Triangles ball = displaced::ball(24);
  for (Triangle& t : ball)
    for (glm::vec3& p : t.positions)
      p *= 1 + 0.05f * std::sin(7 * p.x) * std::cos(5 * p.y) + 0.01f * std::sin(60 * p.z) * std::sin(55 * p.x);
  return ball;
}

/// Returns a stream of default options: in pieces, with low bits and parity.
const Bytes& stream() {
  static const Bytes bytes = [] {
    EncodeOptions options;
    options.exact_bits = kExactWherePays;
    auto made = encode_displaced(source_of(bumpy_ball()), options);
    REQUIRE(std::holds_alternative<EncodedStream>(made));
    return std::get<EncodedStream>(made).bytes;
  }();
  return bytes;
}

struct Chunk {
  ChunkType type = ChunkType::displaced;
  Bytes payload;
};
/// Returns the chunks of the stream, with pieces joined.
std::vector<Chunk> chunks_whole() {
  std::vector<Chunk> chunks;
  std::map<int, PieceGroup> groups;
  StreamReader reader;
  (void)reader.push(stream(), [&](ChunkType type, std::span<const std::byte> payload, std::uint64_t) {
    const auto piece = type == ChunkType::piece ? read_piece_header(payload) : std::nullopt;
    if (!piece) {
      chunks.push_back({type, Bytes(payload.begin(), payload.end())});
      return;
    }
    REQUIRE(groups[piece->group].add(*piece, payload));
    for (Bytes& each : groups[piece->group].take()) chunks.push_back({type_of_group(piece->group), std::move(each)});
  });
  return chunks;
}

std::size_t header_bytes() {
  std::size_t header = 0;
  bool more = false;
  (void)decode_header(stream(), header, more);
  return header;
}

/// Reports whether the segment between two points meets a triangle.
bool meets(const IndexedMesh& geometry, const glm::vec3& from, const glm::vec3& to) {
  const glm::vec3 d = to - from;
  for (std::size_t i = 0; i < geometry.triangles.size(); i += 3) {
    const glm::vec3 a = geometry.positions[geometry.triangles[i]],
                    ab = geometry.positions[geometry.triangles[i + 1]] - a,
                    ac = geometry.positions[geometry.triangles[i + 2]] - a, n = glm::cross(d, ac);
    const float det = glm::dot(ab, n);
    if (det == 0) continue;
    const glm::vec3 s = from - a, q = glm::cross(s, ab);
    const float u = glm::dot(s, n) / det, v = glm::dot(d, q) / det, t = glm::dot(ac, q) / det;
    if (u >= 0 && v >= 0 && u + v <= 1 && t >= 0 && t <= 1) return true;
  }
  return false;
}

}  // namespace

TEST_CASE("decodes a prefix of a tail to its first triangles, wherever it is cut") {
  for (const Source& s : smooth_sources())
    for (const bool ranked : {false, true}) {
      INFO(s.name << (ranked ? ", with ranks" : ""));
      const ExactMesh mesh = mesh_of(s.triangles, 12, s.colored);
      const TailRanks ranks = some_ranks();
      TailOrder order;
      const Bytes tail = encode_tail(mesh, false, ranked ? &ranks : nullptr, &order);
      const auto whole = decode_tail(tail, kMax);
      REQUIRE(whole);
      CHECK(triangles_in(*whole) == triangles_in(mesh));
      // The triangles are in decoding order.
      REQUIRE(order.triangles.size() == whole->triangles.size());
      for (std::size_t t = 0; t < order.triangles.size(); ++t) {
        const displaced::Corners& now = whole->triangles[t];
        for (const std::uint32_t v : mesh.triangles[order.triangles[t]])
          REQUIRE_EACH(std::ranges::count(now, order.vertices[v]) == 1);
      }
      for (const std::size_t step : {std::size_t{1}, std::size_t{37}, tail.size()}) {
        TailReader reader(tail.size(), kMax);
        std::size_t before = 0, middle = 0;
        for (std::size_t at = 0; at < tail.size(); at += step) {
          reader.push(std::span(tail).subspan(at, std::min(step, tail.size() - at)));
          REQUIRE_EACH(reader.triangles() >= before);
          before = reader.triangles();
          if (at + step >= tail.size() / 2 && middle == 0) middle = before;
          if (at / step % 61 != 0) continue;
          const ExactMesh now = reader.mesh();
          REQUIRE_EACH(std::equal(now.triangles.begin(), now.triangles.end(), whole->triangles.begin()));
          REQUIRE_EACH(std::equal(now.vertices.begin(), now.vertices.end(), whole->vertices.begin()));
        }
        CHECK(reader.state() == TailReader::State::whole);
        CHECK(reader.mesh().triangles == whole->triangles);
        CHECK(reader.mesh().twins == whole->twins);
        if (step < 100 && tail.size() > 1500) CHECK(middle > 0);
      }
    }
}

TEST_CASE("grows a mesh first in the cells of the highest ranks") {
  const ExactMesh mesh = mesh_of(displaced::ball(40), 12, false);
  TailRanks ranks{2, std::vector<std::uint8_t>(64, 5)};
  for (std::size_t cell = 0; cell < 32; ++cell) ranks.of[cell] = 1;  // the lower half
  const auto whole = decode_tail(encode_tail(mesh, false, &ranks), kMax);
  REQUIRE(whole);
  // All triangles of one half come before those of the other half, except in cells on the border.
  std::size_t low = 0;
  const std::size_t half = whole->triangles.size() / 2;
  for (std::size_t t = 0; t < half; ++t) low += whole->vertices[whole->triangles[t][0]].z < 2048 ? 1 : 0;
  CHECK(low > half * 9 / 10);
}

TEST_CASE("decodes mutated tails with ranks to a part of a mesh or rejects them") {
  std::mt19937 random(8);
  const TailRanks ranks = some_ranks();
  const Bytes tail = encode_tail(mesh_of(displaced::torus(30, 16), 11, false), false, &ranks);
  for (std::size_t round = 0; round < 120; round += watched_step(8)) {
    Bytes mutated = tail;
    mutated[random() % (round % 3 == 0 ? 16 : mutated.size())] = static_cast<std::byte>(random());
    TailReader reader(mutated.size(), kMax);
    for (std::size_t at = 0; at < mutated.size(); at += 301)
      reader.push(std::span(mutated).subspan(at, std::min<std::size_t>(301, mutated.size() - at)));
    const ExactMesh mesh = reader.mesh();
    for (const displaced::Corners& t : mesh.triangles)
      for (const std::uint32_t v : t) REQUIRE_EACH(v < mesh.vertices.size());
  }
}

TEST_CASE("restores a table of covered patches, and rejects invalid ones") {
  Cover cover{3, 64, 5000, {}};
  std::mt19937 random(2);
  for (int p = 0; p < 700; ++p) cover.patches.push_back(static_cast<std::uint8_t>(p % 5 == 0 ? random() % 65 : 20));
  const Bytes bytes = encode_cover(cover);
  const auto back = decode_cover(bytes);
  REQUIRE(back);
  CHECK(back->stage == 3);
  CHECK(back->triangles == 5000);
  CHECK(back->patches == cover.patches);
  CHECK(back->covered(1, 1563));  // 20 of 64 parts: 1562.5
  CHECK(!back->covered(1, 1562));
  for (std::size_t length = 0; length < bytes.size() - 8; length += 9)
    CHECK(!decode_cover(std::span(bytes).first(length)));
  const auto with = [&](std::size_t at, int value) {
    Bytes changed = bytes;
    changed[at] = static_cast<std::byte>(value);
    return decode_cover(changed).has_value();
  };
  CHECK(!with(0, 16));
  CHECK(!with(1, 0));
  CHECK(!with(1, 19));  // fewer parts than stated
  CHECK(!with(5, 1));   // more patches than the limit
  for (std::size_t round = 0; round < 200; round += watched_step(10)) {
    Bytes mutated = bytes;
    mutated[10 + random() % (mutated.size() - 10)] = static_cast<std::byte>(random());
    if (const auto decoded = decode_cover(mutated))
      for (const int is : decoded->patches) REQUIRE_EACH(is <= decoded->parts);
  }
}

TEST_CASE("replaces patches by the received part of the mesh without holes while a tail is received") {
  StreamDecoder decoder;
  std::size_t mixed = 0, last = 0;
  std::mt19937 random(6);
  std::normal_distribution<float> normal;
  const std::span<const std::byte> bytes(stream());
  const std::size_t step = bytes.size() / 90;
  for (std::size_t at = 0; at < bytes.size(); at += step) {
    REQUIRE(decoder.push(bytes.subspan(at, std::min(step, bytes.size() - at))));
    if (!decoder.mesh().partly) continue;
    ++mixed;
    const IndexedMesh geometry = content_of<IndexedMesh>(decoder.geometry());
    CHECK(decoder.geometry_to_draw().as<IndexedMesh>());
    REQUIRE(geometry.size() == decoder.vectors());
    REQUIRE(geometry.normals.size() == geometry.size());
    for (const float w : geometry.weights) REQUIRE_EACH(w > 0);
    for (const std::uint32_t v : geometry.triangles) REQUIRE_EACH(v < geometry.size());
    // The number of remaining patches decreases.
    const std::size_t patches = geometry.triangles.size() / 3 - decoder.mesh().triangles;
    CHECK((mixed == 1 || patches <= last));
    last = patches;
    for (std::size_t i = 0; i < 60; i += watched_step(20)) {
      const glm::vec3 way = glm::normalize(glm::vec3(normal(random), normal(random), normal(random)));
      const glm::vec3 aside = 0.3f * glm::vec3(normal(random), normal(random), normal(random));
      REQUIRE_EACH(meets(geometry, 3.0f * way, 0.3f * aside));
    }
  }
  CHECK(mixed > 5);
  CHECK(last < content_of<IndexedMesh>(decoder.geometry()).triangles.size() / 3);
  CHECK(decoder.mesh().whole);
}

TEST_CASE("hides a partial tail without its table, or beside another stage than the table names") {
  const std::vector<Chunk> chunks = chunks_whole();
  for (const int which : {0, 1, 2}) {
    StreamDecoder decoder;
    REQUIRE(decoder.push(std::span(stream()).first(header_bytes())));
    std::size_t pieces = 0;
    for (const auto& [type, payload] : chunks) {
      if (type == ChunkType::low_bits || (type == ChunkType::exact && ++pieces > 4)) continue;
      Bytes changed = payload;
      if (type == ChunkType::cover) {
        if (which == 0) continue;
        auto cover = decode_cover(payload);
        REQUIRE(cover);
        if (which == 1) cover->stage = 9;
        if (which == 2) cover->patches.pop_back();
        changed = encode_cover(*cover);
      }
      decoder.add(type, changed);
    }
    REQUIRE(pieces > 5);
    CHECK(decoder.mesh().triangles > 100);
    const IndexedMesh geometry = content_of<IndexedMesh>(decoder.geometry());
    CHECK(geometry.size() == decoder.vectors());
    CHECK(geometry.triangles.size() % 3 == 0);
    CHECK(decoder.geometry_to_draw().as<SurfacePatches>());
  }
}

TEST_CASE("ends a surface with the mesh if that pays and restores the mesh after losses") {
  StreamDecoder decoder;
  REQUIRE(decoder.push(stream()));
  decoder.finish();
  REQUIRE(decoder.mesh().final);
  CHECK(decoder.mesh().bits >= 11);
  CHECK(decoder.mesh().bits <= 14);
  for (const unsigned seed : {1u, 2u, 3u, 4u}) {
    StreamDecoder lossy;
    REQUIRE(lossy.push(drop_packets(stream(), 0.3, seed)));
    lossy.finish();
    CHECK(lossy.mesh().whole);
  }
  // With a limit of 1,700 bytes, the stream has no exact mesh.
  EncodeOptions options;
  options.exact_bits = kExactWherePays;
  options.max_bytes = 1700;
  const auto small = encode_displaced(source_of(displaced::ball(14)), options);
  REQUIRE(std::holds_alternative<EncodedStream>(small));
  StreamDecoder few;
  REQUIRE(few.push(std::get<EncodedStream>(small).bytes));
  CHECK(few.mesh().bytes == 0);
  CHECK(std::get<EncodedStream>(small).bytes.size() <= 1700);
}

}  // namespace gs::qnv::exact::prefix_test
