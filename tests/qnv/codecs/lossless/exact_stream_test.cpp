#include "qnv/codecs/displaced/encode/encode_displaced.h"
#include "qnv/codecs/lossless/tail_pieces.h"
#include "qnv/codecs/payloads.h"
#include "qnv/reader/loss.h"
#include "qnv/reader/stream_decoder.h"
#include "tests/geometries.h"
#include "tests/qnv/codecs/lossless/exact_shapes.h"
#include "tests/watched.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <span>
#include <variant>

namespace gs::qnv::exact::stream_test {
namespace {

using Bytes = std::vector<std::byte>;

std::variant<EncodedStream, EncodeError> encoded(const Triangles& triangles, int bits, unsigned threads = 0) {
  EncodeOptions options;
  options.exact_bits = bits;
  options.threads = threads;
  return encode_displaced(source_of(triangles), options);
}

struct Sample {
  Source source;
  int bits = 11;
  Bytes stream;
};

/// Returns a sheet that is too rough for a tail of one piece.
Triangles rough_sheet() {
  Triangles sheet = displaced::sheet(140);
  for (Triangle& t : sheet)
    for (glm::vec3& p : t.positions) {
      const glm::vec3 by(std::sin(9000 * p.x + 7000 * p.y), std::sin(8000 * p.x + 9100 * p.y),
                         std::sin(7700 * p.x + 8300 * p.y));
      const glm::vec3 noise = 40000.0f * by;
      p += 0.002f * (noise - glm::floor(noise));
    }
  return sheet;
}

const std::vector<Sample>& samples() {
  static const std::vector<Sample> all = [] {
    std::vector<Sample> made;
    // The last shape has several pieces.
    for (const Source& s : {smooth_sources()[3], smooth_sources()[2], Source{"large sheet", rough_sheet()}})
      made.push_back({s, made.size() == 2 ? 20 : 11, {}});
    for (Sample& s : made) s.stream = std::get<EncodedStream>(encoded(s.source.triangles, s.bits)).bytes;
    return made;
  }();
  return all;
}

StreamDecoder decoded(std::span<const std::byte> bytes, std::size_t most = std::size_t{1} << 20) {
  StreamDecoder decoder(most);
  (void)decoder.push(bytes);
  decoder.finish();
  return decoder;
}

bool same(const IndexedMesh& a, const IndexedMesh& b) {
  return a.positions == b.positions && a.normals == b.normals && a.weights == b.weights && a.colors == b.colors &&
         a.triangles == b.triangles;
}

struct Chunk {
  ChunkType type = ChunkType::displaced;
  Bytes payload;
  std::size_t end = 0;  // position in the stream
};

std::vector<Chunk> chunks_of(const Bytes& stream) {
  std::vector<Chunk> chunks;
  StreamReader reader;
  (void)reader.push(stream, [&](ChunkType type, std::span<const std::byte> payload, std::uint64_t at) {
    chunks.push_back({type, Bytes(payload.begin(), payload.end()), at + kChunkHeaderBytes + payload.size()});
  });
  return chunks;
}

std::size_t header_bytes(const Bytes& stream) {
  std::size_t bytes = 0;
  bool more = false;
  (void)decode_header(stream, bytes, more);
  return bytes;
}

/// Returns the shown triangles of a geometry on the lattice.
std::vector<Turned> triangles_shown(const IndexedMesh& geometry, int bits, bool rgb) {
  const displaced::Frame frame(geometry.description.box);
  const float step = frame.size / static_cast<float>((1 << bits) - 1);
  ExactMesh mesh;
  for (const glm::vec3& p : geometry.positions) mesh.vertices.emplace_back(glm::floor((p - frame.lower) / step + 0.5f));
  if (rgb) mesh.colors = geometry.colors;
  for (std::size_t i = 0; i < geometry.triangles.size(); i += 3)
    mesh.triangles.push_back({geometry.triangles[i], geometry.triangles[i + 1], geometry.triangles[i + 2]});
  return triangles_in(mesh);
}

}  // namespace

TEST_CASE("encodes a surface with vertex colours as base mesh and exact mesh by default") {
  Triangles ball = displaced::ball(24);
  for (Triangle& t : ball)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto shade = [](float x) { return static_cast<std::uint8_t>(127 + 120 * std::sin(9 * x)); };
      const glm::vec3& p = t.positions[k];
      t.colors[k] = {shade(p.x), shade(p.y), shade(p.z)};
    }
  EncodeOptions options;
  options.exact_bits = kExactWherePays;
  options.only_if_suited = true;
  const auto made = encode_displaced(source_of(ball), options);
  REQUIRE(std::holds_alternative<EncodedStream>(made));
  const StreamDecoder decoder = decoded(std::get<EncodedStream>(made).bytes);
  CHECK(decoder.refused_chunks() == 0);
  REQUIRE(decoder.mesh().whole);
  const IndexedMesh geometry = content_of<IndexedMesh>(decoder.geometry());
  check_sound(geometry);
  CHECK(triangles_shown(geometry, decoder.mesh().bits, true) == triangles_in(ball, decoder.mesh().bits, true));
}

TEST_CASE("ends an exact stream with the mesh itself") {
  for (const Sample& s : samples()) {
    INFO(s.source.name);
    const StreamDecoder decoder = decoded(s.stream);
    CHECK(decoder.problems().empty());
    CHECK(decoder.refused_chunks() == 0);
    CHECK(!decoder.full());
    REQUIRE(decoder.mesh().whole);
    CHECK(decoder.mesh().bits == s.bits);
    CHECK(decoder.mesh().received == decoder.mesh().bytes);
    const IndexedMesh geometry = content_of<IndexedMesh>(decoder.geometry());
    check_sound(geometry);
    CHECK(geometry.size() == decoder.vectors());
    CHECK(triangles_shown(geometry, s.bits, s.source.colored) ==
          triangles_in(s.source.triangles, s.bits, s.source.colored));
    // Half a step of the lattice, plus f32 rounding.
    const Box box = geometry.description.box;
    for (const glm::vec3& p : geometry.positions)
      for (int axis = 0; axis < 3; ++axis)
        REQUIRE_EACH((p[axis] >= box.lower[axis] - 1e-5f && p[axis] <= box.upper[axis] + 2e-3f));
    // The shown part has the area of the source.
    double area = 0;
    for (const float w : geometry.weights) area += static_cast<double>(w);
    CHECK(area == Approx(area_of(s.source.triangles)).epsilon(0.01));
  }
}

TEST_CASE("restores defective surfaces from exact streams, or reports the defect") {
  for (const Source& s : nasty_sources()) {
    INFO(s.name);
    const auto made = encoded(s.triangles, 11);
    REQUIRE(std::holds_alternative<EncodedStream>(made));
    const StreamDecoder decoder = decoded(std::get<EncodedStream>(made).bytes);
    REQUIRE(decoder.mesh().whole);
    const IndexedMesh geometry = content_of<IndexedMesh>(decoder.geometry());
    check_sound(geometry);
    CHECK(triangles_shown(geometry, 11, false) == triangles_in(s.triangles, 11, false));
  }
  CHECK(std::holds_alternative<EncodeError>(encoded({}, 11)));
  CHECK(std::holds_alternative<EncodeError>(encoded({triangle_of({0, 0, 0}, {1, 1, 1}, {1, 1, 1})}, 11)));
}

TEST_CASE("limits the data before an exact tail to a fifth of it and shows a picture from the header on") {
  for (const Sample& s : samples()) {
    INFO(s.source.name);
    const auto chunks = chunks_of(s.stream);
    std::size_t before = header_bytes(s.stream), tail = 0;
    bool ended = false;
    for (const Chunk& chunk : chunks) {
      if (chunk.type == ChunkType::directory) continue;
      const bool piece = chunk.type == ChunkType::exact || chunk.type == ChunkType::low_bits;
      CHECK((piece || !ended));  // the tail comes last
      ended = ended || piece;
      (piece ? tail : before) += kChunkHeaderBytes + chunk.payload.size();
    }
    CHECK(before <= 1000 + tail / 5);
    CHECK(decoded(std::span(s.stream).first(header_bytes(s.stream))).vectors() > 300);
  }
  CHECK(std::ranges::count(chunks_of(samples()[2].stream), ChunkType::exact, &Chunk::type) >= 2);
  CHECK(std::ranges::count(chunks_of(samples()[0].stream), ChunkType::low_bits, &Chunk::type) == 0);
}

// FORMAT.md, "Low bits".
TEST_CASE("refines positions bit by bit after the tail, with any losses and in any order") {
  const Sample& s = samples()[2];
  std::vector<Chunk> chunks = chunks_of(s.stream), low;
  for (const Chunk& chunk : chunks)
    if (chunk.type == ChunkType::low_bits) low.push_back(chunk);
  REQUIRE(low.size() > 20);
  const auto whole = triangles_in(s.source.triangles, s.bits, false);
  const auto with = [&](std::span<const Chunk> some, bool first) {
    StreamDecoder decoder;
    REQUIRE(decoder.push(std::span(s.stream).first(header_bytes(s.stream))));
    if (first)
      for (const Chunk& chunk : some) decoder.add(chunk.type, chunk.payload);
    for (const Chunk& chunk : chunks)
      if (chunk.type != ChunkType::low_bits) decoder.add(chunk.type, chunk.payload);
    if (!first)
      for (const Chunk& chunk : some) decoder.add(chunk.type, chunk.payload);
    CHECK(decoder.refused_chunks() == 0);
    CHECK(decoder.mesh().whole);
    CHECK(decoder.mesh().final == (some.size() == low.size()));
    return content_of<IndexedMesh>(decoder.geometry());
  };
  const auto off = [&](const IndexedMesh& geometry) {
    const IndexedMesh all = with(low, false);
    float most = 0;
    for (std::size_t corner = 0; corner < all.triangles.size(); ++corner)
      most = std::max(
          most, glm::length(geometry.positions[geometry.triangles[corner]] - all.positions[all.triangles[corner]]));
    return most;
  };
  std::mt19937 random(4);
  std::vector<Chunk> shuffled = low;
  std::shuffle(shuffled.begin(), shuffled.end(), random);
  CHECK(triangles_shown(with(shuffled, false), s.bits, false) == whole);
  CHECK(triangles_shown(with(shuffled, true), s.bits, false) == whole);
  const std::size_t layer = low.size() / 8;  // layers for the bits 13 to 20
  const float none = off(with({}, false)), one = off(with(std::span(low).first(layer), false)),
              three = off(with(std::span(low).first(3 * layer), false));
  CHECK(one < 0.6f * none);
  CHECK(three < 0.6f * one);
  // If one chunk of the first layer is missing, the vertices of this chunk keep their positions.
  CHECK(off(with(std::span(low).subspan(1), false)) <= none);
  CHECK(off(with(std::span(low).subspan(1), false)) > 0.5f * none);
}

TEST_CASE("shows a surface for every prefix of an exact stream, and never a broken mesh") {
  for (const Sample& s : samples()) {
    INFO(s.source.name);
    std::size_t whole_at = 0;
    for (const Chunk& chunk : chunks_of(s.stream))
      if (chunk.type == ChunkType::exact) whole_at = chunk.end;
    StreamDecoder decoder;
    const std::size_t step = std::max<std::size_t>(1, s.stream.size() / 150);
    bool was_whole = false;
    for (std::size_t at = 0; at < s.stream.size(); at += step) {
      REQUIRE(decoder.push(std::span(s.stream).subspan(at, std::min(step, s.stream.size() - at))));
      const std::size_t come = std::min(at + step, s.stream.size());
      REQUIRE_EACH(decoder.mesh().whole == (come >= whole_at));
      if (!decoder.header()) continue;
      if (decoder.mesh().whole == was_whole && at % (7 * step) != 0) continue;
      was_whole = decoder.mesh().whole;
      const IndexedMesh geometry = content_of<IndexedMesh>(decoder.geometry());
      check_sound(geometry);
      REQUIRE_EACH(geometry.size() == decoder.vectors());
    }
    CHECK(was_whole);
  }
}

TEST_CASE("draws the refined surface and then the mesh of an exact stream") {
  const Sample& s = samples()[0];
  StreamDecoder decoder;
  REQUIRE(decoder.push(std::span(s.stream).first(header_bytes(s.stream))));
  CHECK(decoder.geometry_to_draw().as<SurfacePatches>());
  REQUIRE(decoder.push(std::span(s.stream).subspan(header_bytes(s.stream))));
  const auto drawn = content_of<IndexedMesh>(decoder.geometry_to_draw());
  CHECK(same(drawn, content_of<IndexedMesh>(decoder.geometry())));
  CHECK(drawn.triangles.size() == 3 * s.source.triangles.size());
}

TEST_CASE("accepts pieces of a tail in any order, repeated, and before all other chunks") {
  const Sample& s = samples()[2];
  auto chunks = chunks_of(s.stream);
  const IndexedMesh wanted = content_of<IndexedMesh>(decoded(s.stream).geometry());
  std::mt19937 random(4);
  for (int round = 0; round < 3; ++round) {
    std::shuffle(chunks.begin(), chunks.end(), random);
    StreamDecoder decoder;
    REQUIRE(decoder.push(std::span(s.stream).first(header_bytes(s.stream))));
    for (const Chunk& chunk : chunks) {
      decoder.add(chunk.type, chunk.payload);
      if (round == 1 && chunk.type == ChunkType::exact) decoder.add(chunk.type, chunk.payload);
    }
    CHECK(same(content_of<IndexedMesh>(decoder.geometry()), wanted));
    CHECK(decoder.refused_chunks() == 0);
  }
}

TEST_CASE("keeps the earlier picture at a lost or damaged piece, and the refined surface elsewhere") {
  const Sample& s = samples()[2];
  const auto chunks = chunks_of(s.stream);
  std::mt19937 random(9);
  const auto low = [](const Chunk& chunk) { return chunk.type == ChunkType::low_bits; };
  for (const Chunk& chunk : chunks) {
    if (chunk.type != ChunkType::exact) continue;
    Bytes damaged = s.stream;
    damaged[chunk.end - 1 - random() % chunk.payload.size()] ^= std::byte{16};
    const StreamDecoder decoder = decoded(damaged);
    CHECK(!decoder.mesh().whole);
    CHECK(decoder.problems().size() == 1);
    StreamDecoder before;
    REQUIRE(before.push(std::span(s.stream).first(chunk.end - chunk.payload.size() - kChunkHeaderBytes)));
    for (const Chunk& other : chunks)
      if (low(other)) before.add(other.type, other.payload);
    CHECK(same(content_of<IndexedMesh>(decoder.geometry()), content_of<IndexedMesh>(before.geometry())));
  }
  const Bytes lossy = drop_packets(s.stream, 1, 2);
  CHECK(!decoded(lossy).mesh().whole);
  CHECK(decoded(drop_packets(s.stream, 0, 2)).mesh().whole);
}

TEST_CASE("rejects pieces that do not belong together") {
  const Bytes tail(40000, std::byte{3});
  const auto pieces = pieces_of(tail);
  REQUIRE(pieces.size() == 3);
  TailPieces held;
  CHECK(!held.add({}));
  CHECK(!held.add(std::span(pieces[0]).first(8)));
  CHECK(held.length() == 0);
  REQUIRE(held.add(pieces[1]));
  CHECK(held.length() == tail.size());
  CHECK(!held.take());
  Bytes other = pieces[0];
  other[4] = std::byte{1};  // for a tail of another length
  CHECK(!held.add(other));
  other = pieces[0];
  other[0] = std::byte{1};  // overlaps the second
  CHECK(!held.add(other));
  other = pieces[2];
  other.push_back(std::byte{3});  // beyond the end
  CHECK(!held.add(other));
  other = pieces[1];
  other.back() = std::byte{4};
  CHECK(!held.add(other));  // received before with other bytes
  CHECK(held.add(pieces[1]));
  CHECK(held.come() == 16384);
  REQUIRE(held.add(pieces[2]));
  REQUIRE(held.add(pieces[0]));
  const auto whole = held.take();
  REQUIRE(whole);
  CHECK(*whole == tail);
}

TEST_CASE("decodes mutated pieces to the refined surface or to a mesh") {
  std::mt19937 random(21);
  const Sample& s = samples()[1];
  const auto chunks = chunks_of(s.stream);
  for (std::size_t round = 0; round < 60; round += watched_step(6)) {
    StreamDecoder decoder(1 << 18);
    REQUIRE(decoder.push(std::span(s.stream).first(header_bytes(s.stream))));
    for (const Chunk& chunk : chunks) {
      Bytes mutated = chunk.payload;
      const std::size_t within = round % 2 == 0 ? std::min<std::size_t>(mutated.size(), 130) : mutated.size();
      if (chunk.type == ChunkType::exact) mutated[random() % within] = static_cast<std::byte>(random());
      decoder.add(chunk.type, mutated);
    }
    const IndexedMesh geometry = content_of<IndexedMesh>(decoder.geometry());
    check_sound(geometry);
    REQUIRE(geometry.size() == decoder.vectors());
  }
}

TEST_CASE("shows the refined surface if the mesh exceeds the maximum number of vectors") {
  const Sample& s = samples()[2];
  const StreamDecoder decoder = decoded(s.stream, 9000);
  CHECK(decoder.full());
  CHECK(!decoder.mesh().whole);
  CHECK(decoder.vectors() > 300);
  CHECK(decoder.vectors() <= 9000);
}

TEST_CASE("encodes a mesh to the same exact stream on any number of threads, after stages and octrees") {
  const Sample& s = samples()[1];
  for (const unsigned threads : {1u, 3u})
    CHECK(std::get<EncodedStream>(encoded(s.source.triangles, s.bits, threads)).bytes == s.stream);
  CHECK(carries(row_of(Payload::displaced), ChunkType::exact));
  CHECK(carries(row_of(Payload::packed), ChunkType::exact));
  CHECK(!carries(row_of(Payload::packed), ChunkType::cover));
  CHECK(!carries(row_of(Payload::records), ChunkType::exact));
  // A stream of another payload rejects it.
  const TriangleSource source = source_of(s.source.triangles);
  const auto packed = row_of(Payload::packed).encode(std::cref(source), {}, nullptr);
  StreamDecoder decoder;
  REQUIRE(decoder.push(std::get<EncodedStream>(packed).bytes));
  decoder.add(ChunkType::exact, Bytes(100));
  CHECK(decoder.refused_chunks() == 1);
}

}  // namespace gs::qnv::exact::stream_test
