#include "qnv/codecs/outlines/outline_chunk.h"
#include "qnv/codecs/outlines/outline_stream.h"
#include "tests/qnv/outline_decoding.h"
#include "tests/qnv/outline_shapes.h"
#include "tests/watched.h"

#include <zlib.h>
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace gs::qnv {
namespace {

using namespace outlines;

std::vector<OutlineAppearance> two_looks() {
  std::vector<OutlineAppearance> all(2);
  all[1].textured = true;
  all[1].texture_url = "t.png";
  return all;
}

/// Returns two appearances, one with texture coordinates, holes, and groups with and without inner polygons, in about
/// five chunks.
OutlineGroups example_groups() {
  OutlineGroups groups = shapes::sphere(6, 8, 4, 2);
  for (OutlineGroup& group : groups.groups) {
    if (group.appearance != 1) continue;
    for (const glm::vec3& p : group.inner.positions) group.inner.texture_coordinates.emplace_back(p.x, p.y);
  }
  groups.groups.push_back(
      shapes::flat_group({shapes::square({1, 1, 1}, 2), {{1.5f, 1.5f, 1}, {1.5f, 2, 1}, {2, 2, 1}}}));
  groups.groups.push_back(shapes::flat_group({shapes::square({1, 1, 2}, 0.5f)}, 1, {{0, 0}, {1, 0}, {1, 1}, {0, 1}}));
  return groups;
}

EncodedStream example_stream() {
  return encoded(example_groups(), two_looks(), {.position_bits = 12, .chunk_bytes = 250});
}

bool holds(const std::vector<One>& whole, const std::vector<One>& part) {
  return std::includes(whole.begin(), whole.end(), part.begin(), part.end());
}

/// Returns the starts of the records of a chunk, from its payload's start, and the end of the last one.
std::vector<std::size_t> records_of(const ChunkAt& chunk, const OutlineHeader& header) {
  outline::ChunkHead head;
  std::size_t at = 0;
  REQUIRE(outline::decode_head(chunk.payload, outline::LatticeBits(header), head, at));
  std::vector<std::size_t> begins{at};
  for (const std::uint16_t length : head.lengths) begins.push_back(at += length);
  return begins;
}

TEST_CASE("decodes every prefix of an outline stream to its complete records") {
  const EncodedStream stream = example_stream();
  const std::vector<One> whole = sorted(decode_all(stream.bytes));
  const std::vector<ChunkAt> chunks = chunks_of(stream.bytes);
  REQUIRE(chunks.size() >= 6);
  std::size_t before = 0;
  for (std::size_t size = 0; size <= stream.bytes.size(); size += watched_step(3)) {
    OutlineDecoder decoder;
    (void)decoder.push(std::span(stream.bytes).first(size));
    decoder.finish();
    const std::vector<One> all = sorted(take(decoder));
    REQUIRE(holds(whole, all));
    REQUIRE(all.size() >= before);
    before = all.size();
    REQUIRE_FALSE(decoder.refused());
    REQUIRE(decoder.refused_records() == 0);
  }
  CHECK(before == whole.size());
}

TEST_CASE("decodes an outline stream in any two pieces, and byte by byte") {
  const EncodedStream stream = example_stream();
  const std::vector<One> whole = sorted(decode_all(stream.bytes));
  for (std::size_t size = 0; size <= stream.bytes.size(); size += watched_step(5)) {
    OutlineDecoder decoder;
    REQUIRE(decoder.push(std::span(stream.bytes).first(size)));
    std::vector<One> all = take(decoder);
    REQUIRE(decoder.push(std::span(stream.bytes).subspan(size)));
    decoder.finish();
    const std::vector<One> rest = take(decoder);
    all.insert(all.end(), rest.begin(), rest.end());
    REQUIRE((sorted(std::move(all)) == whole));
    REQUIRE(decoder.problems().empty());
  }
  OutlineDecoder decoder;
  for (const std::byte& byte : stream.bytes) REQUIRE(decoder.push({&byte, 1}));
  CHECK((sorted(take(decoder)) == whole));
}

TEST_CASE("accepts outline chunks in any order, any subset and repeated") {
  const EncodedStream stream = example_stream();
  const std::vector<One> whole = sorted(decode_all(stream.bytes));
  std::vector<ChunkAt> chunks = chunks_of(stream.bytes);
  std::mt19937 random(3);
  for (int turn = 0; turn < 50; ++turn) {
    std::shuffle(chunks.begin(), chunks.end(), random);
    OutlineDecoder decoder;
    decoder.add(chunks[0].type, chunks[0].payload);  // before the header: ignored
    REQUIRE(decoder.push(header_of(stream.bytes)));
    const std::size_t count = 1 + random() % chunks.size();
    std::size_t polygons = 0;
    for (std::size_t i = 0; i < count; ++i) {
      decoder.add(chunks[i].type, chunks[i].payload);
      decoder.add(chunks[random() % (i + 1)].type, chunks[random() % (i + 1)].payload);
      if (chunks[i].type != ChunkType::directory) polygons += records_of(chunks[i], stream.header.outlines).size() - 1;
    }
    const std::vector<One> all = sorted(take(decoder));
    REQUIRE(all.size() == polygons);
    REQUIRE(holds(whole, all));
    REQUIRE(decoder.outline_polygons() + decoder.inner_polygons() == polygons);
  }
}

TEST_CASE("loses one polygon to a flipped bit in a record") {
  EncodedStream stream = example_stream();
  const std::vector<One> whole = sorted(decode_all(stream.bytes));
  std::size_t records = 0;
  for (const ChunkAt& chunk : chunks_of(stream.bytes)) {
    if (chunk.type == ChunkType::directory) continue;
    const std::vector<std::size_t> begins = records_of(chunk, stream.header.outlines);
    records += begins.size() - 1;
    const std::size_t payload = chunk.offset + kChunkHeaderBytes;
    for (std::size_t bit = 8 * (payload + begins.front()); bit < 8 * (payload + begins.back());
         bit += watched_step(11)) {
      stream.bytes[bit / 8] ^= static_cast<std::byte>(1u << bit % 8);
      OutlineDecoder decoder;
      REQUIRE(decoder.push(stream.bytes));
      decoder.finish();
      const std::vector<One> all = sorted(take(decoder));
      REQUIRE(all.size() + 1 == whole.size());
      REQUIRE(holds(whole, all));
      REQUIRE(decoder.refused_records() == 1);
      REQUIRE(decoder.refused_chunks() == 0);
      REQUIRE(decoder.problems().size() == 1);
      REQUIRE(decoder.problems()[0].message == "a chunk is damaged; its intact parts are used");
      stream.bytes[bit / 8] ^= static_cast<std::byte>(1u << bit % 8);
    }
  }
  CHECK(records == whole.size());
}

TEST_CASE("loses at most one chunk to a flipped bit elsewhere, and invents nothing") {
  EncodedStream stream = example_stream();
  const std::vector<One> whole = sorted(decode_all(stream.bytes));
  const std::vector<ChunkAt> chunks = chunks_of(stream.bytes);
  for (const ChunkAt& chunk : chunks) {
    const bool directory = chunk.type == ChunkType::directory;
    const std::vector<std::size_t> begins =
        directory ? std::vector<std::size_t>{chunk.payload.size()} : records_of(chunk, stream.header.outlines);
    const std::size_t head = 8 * (chunk.offset + kChunkHeaderBytes), end = head + 8 * begins.front();
    for (std::size_t bit = 8 * chunk.offset; bit < end; bit += watched_step(11)) {
      stream.bytes[bit / 8] ^= static_cast<std::byte>(1u << bit % 8);
      OutlineDecoder decoder;
      REQUIRE(decoder.push(stream.bytes));
      decoder.finish();
      const std::vector<One> all = sorted(take(decoder));
      REQUIRE(holds(whole, all));
      // A flipped bit of the checksum itself loses nothing.
      const bool sum = bit >= head - 32 && bit < head;
      REQUIRE(whole.size() - all.size() == (directory || sum ? 0 : begins.size() - 1));
      REQUIRE_FALSE(decoder.problems().empty());
      stream.bytes[bit / 8] ^= static_cast<std::byte>(1u << bit % 8);
    }
  }
}

TEST_CASE("survives damage in the last chunk of a stream without a directory") {
  EncodedStream stream = example_stream();
  const std::vector<One> whole = sorted(decode_all(stream.bytes));
  const std::vector<ChunkAt> chunks = chunks_of(stream.bytes);
  stream.bytes.resize(chunks.back().offset);
  stream.bytes.back() ^= std::byte{1};
  OutlineDecoder decoder;
  REQUIRE(decoder.push(stream.bytes));
  decoder.finish();
  CHECK(take(decoder).size() + 1 == whole.size());
  CHECK(decoder.problems().size() == 1);
  CHECK(decoder.refused_records() == 1);
}

TEST_CASE("uses the intact records of a damaged chunk, and the others when it is received again") {
  const EncodedStream stream = example_stream();
  const std::vector<One> whole = sorted(decode_all(stream.bytes));
  for (const ChunkAt& chunk : chunks_of(stream.bytes)) {
    if (chunk.type == ChunkType::directory) continue;
    const std::vector<std::size_t> begins = records_of(chunk, stream.header.outlines);
    for (std::size_t first = 0; first < chunk.payload.size(); first += 5) {
      const ByteRange lost{first, std::min(first + 48, chunk.payload.size())};
      Bytes payload = chunk.payload;
      std::fill(payload.begin() + static_cast<std::ptrdiff_t>(lost.first),
                payload.begin() + static_cast<std::ptrdiff_t>(lost.last), std::byte{0});
      std::size_t there = 0;
      for (std::size_t i = 0; i + 1 < begins.size(); ++i)
        there += begins[i + 1] <= lost.first || begins[i] >= lost.last ? 1 : 0;
      OutlineDecoder decoder;
      REQUIRE(decoder.push(header_of(stream.bytes)));
      decoder.add(chunk.type, payload, std::span(&lost, 1));
      const std::vector<One> all = sorted(take(decoder));
      REQUIRE(holds(whole, all));
      REQUIRE(all.size() == (lost.first < begins.front() ? 0 : there));
      REQUIRE(decoder.refused_records() == 0);
      decoder.add(chunk.type, chunk.payload);
      REQUIRE(take(decoder).size() + all.size() == begins.size() - 1);
    }
  }
}

TEST_CASE("returns at most the requested number of polygons") {
  const EncodedStream stream = example_stream();
  OutlineDecoder decoder(60);
  REQUIRE(decoder.push(stream.bytes));
  CHECK(take(decoder).size() == 60);
  CHECK(decoder.outline_polygons() + decoder.inner_polygons() == 60);
  CHECK(decoder.refused_records() + 60 == decode_all(stream.bytes).size());
  // The decoder also rejects inner polygons with more than eight times as many corners. The outlines have about 20.
  OutlineDecoder few(7);
  REQUIRE(few.push(stream.bytes));
  std::size_t corners = 0;
  for (const One& one : take(few))
    for (const auto& ring : one.rings) corners += ring.size();
  CHECK(corners <= 56);
}

TEST_CASE("rejects chunks of other payloads, in both directions") {
  const EncodedStream stream = example_stream();
  OutlineDecoder decoder;
  REQUIRE(decoder.push(header_of(stream.bytes)));
  decoder.add(ChunkType::packed, stream.bytes);
  decoder.add(ChunkType::outlines, {});
  CHECK(decoder.refused_chunks() == 2);
  const std::vector<ChunkAt> chunks = chunks_of(stream.bytes);
  decoder.add(ChunkType::inner, chunks[0].payload);  // the chunk header states outlines
  CHECK(decoder.refused_chunks() == 3);
  CHECK(take(decoder).empty());

  StreamHeader other;
  other.description.box = {{0, 0, 0}, {1, 1, 1}};
  OutlineDecoder of_other;
  CHECK_FALSE(of_other.push(encode_header(other)));
  CHECK(of_other.refused());
  CHECK(of_other.problems().at(0).message == "not an outlines stream; expected payload 2");
  CHECK_FALSE(of_other.push({}));
}

TEST_CASE("rejects impossible outline headers") {
  const StreamHeader good = example_stream().header;
  const auto refused = [&](auto change) {
    StreamHeader header = good;
    change(header.outlines);
    OutlineDecoder decoder;
    const bool pushed = decoder.push(encode_header(header));
    if (!pushed) CHECK(decoder.problems().at(0).message == "the header's section of outlines is missing or invalid");
    return !pushed;
  };
  CHECK_FALSE(refused([](OutlineHeader&) {}));
  CHECK(refused([](OutlineHeader& h) { h.positions.exponent = 128; }));
  CHECK(refused([](OutlineHeader& h) { h.positions.exponent = -150; }));
  CHECK(refused([](OutlineHeader& h) { h.positions.size[1] = 1u << 30; }));
  CHECK(refused([](OutlineHeader& h) { h.positions.origin[2] = (std::int64_t{1} << 52) + 1; }));
  CHECK(refused([](OutlineHeader& h) { h.positions.origin[0] = std::numeric_limits<std::int64_t>::min(); }));
  CHECK(refused([](OutlineHeader& h) {
    h.positions.exponent = 127;
    h.positions.origin[0] = 2;
  }));
  CHECK(refused([](OutlineHeader& h) { h.texture_coordinates.exponent = 1000; }));
  CHECK(refused([](OutlineHeader& h) { h.texture_coordinates.size[1] = ~0u; }));

  const Bytes section = encode_outline_header(good.outlines);
  REQUIRE(decode_outline_header(section) == good.outlines);
  for (std::size_t size = 0; size < section.size(); ++size)
    REQUIRE_FALSE(decode_outline_header(std::span(section).first(size)));
  OutlineHeader odd = good.outlines;
  odd.appearances[0].crease_angle = std::numeric_limits<float>::quiet_NaN();
  CHECK(decode_outline_header(encode_outline_header(odd))->appearances[0].crease_angle == 0);
}

void put(Bytes& bytes, std::size_t at, std::size_t value, int size) {
  for (int i = 0; i < size; ++i)
    bytes[at + static_cast<std::size_t>(i)] = static_cast<std::byte>(value >> (8 * i) & 255);
}

/// Corrects the checksums of a payload, as an attacker would.
void seal(Bytes& payload, const std::vector<std::size_t>& begins) {
  for (std::size_t i = 0; i + 1 < begins.size(); ++i)
    payload[begins[i + 1] - 1] =
        static_cast<std::byte>(outline::crc8(std::span(payload).subspan(begins[i], begins[i + 1] - 1 - begins[i])));
  const std::size_t head = std::min(u16(payload, 8), payload.size());
  put(payload, 10, 0, 2);
  put(payload, 10, outline::crc16(std::span(payload).first(head)), 2);
}

TEST_CASE("decodes hostile bytes to polygons inside the lattice, or to none") {
  const EncodedStream stream = example_stream();
  const OutlineHeader& header = stream.header.outlines;
  std::mt19937 random(11);
  std::size_t accepted = 0;
  for (const ChunkAt& chunk : chunks_of(stream.bytes)) {
    if (chunk.type == ChunkType::directory) continue;
    const std::vector<std::size_t> begins = records_of(chunk, header);
    for (int turn = 0; turn < 3000; ++turn) {
      Bytes payload = chunk.payload;
      for (std::size_t flips = 1 + random() % 6; flips > 0; --flips) {
        const bool in_head = turn % 2 == 0;
        const std::size_t at =
            in_head ? random() % begins.front() : begins.front() + random() % (payload.size() - begins.front());
        payload[at] = static_cast<std::byte>(random() % 3 == 0 ? random() : random() % 2 * 255);
      }
      seal(payload, begins);
      OutlineDecoder decoder;
      REQUIRE(decoder.push(header_of(stream.bytes)));
      decoder.add(chunk.type, payload);
      for (const One& one : take(decoder)) {
        ++accepted;
        REQUIRE(one.group < header.groups);
        REQUIRE(one.appearance < header.appearances.size());
        bool within = true;
        for (const auto& ring : one.rings)
          for (const Point& p : ring)
            for (std::size_t axis = 0; axis < 3; ++axis)
              within = within && p[axis] >= header.positions.at(axis, 0) &&
                       p[axis] <= header.positions.at(axis, header.positions.size[axis]);
        REQUIRE(within);
      }
    }
  }
  CHECK(accepted > 1000);
}

TEST_CASE("reads noise after a header, and chunks of noise, to the end") {
  const EncodedStream stream = example_stream();
  std::mt19937 random(12);
  for (int turn = 0; turn < 300; ++turn) {
    const auto head = header_of(stream.bytes);
    Bytes bytes(head.begin(), head.end());
    for (int i = 0; i < 20; ++i) {
      Bytes payload(random() % 300);
      for (std::byte& b : payload) b = static_cast<std::byte>(random());
      if (payload.size() > 30) put(payload, 8, 21 + random() % 9, 2), seal(payload, {});
      Bytes chunk = encode_chunk(random() % 2 == 0 ? ChunkType::outlines : ChunkType::inner, payload);
      if (random() % 2 == 0) chunk[6] ^= std::byte{1};
      if (random() % 4 == 0) chunk.resize(random() % (chunk.size() + 1));
      bytes.insert(bytes.end(), chunk.begin(), chunk.end());
    }
    OutlineDecoder decoder;
    (void)decoder.push(bytes);
    decoder.finish();
    (void)take(decoder);
  }
}

TEST_CASE("gives up a stream of false chunks in reasonable time") {
  const EncodedStream stream = example_stream();
  const auto head = header_of(stream.bytes);
  Bytes bytes(head.begin(), head.end());
  const Bytes false_start{std::byte{0x51}, std::byte{0x43}, std::byte{0xff},
                          std::byte{0xff}, std::byte{2},    std::byte{0}};
  while (bytes.size() < (std::size_t{2} << 20)) bytes.insert(bytes.end(), false_start.begin(), false_start.end());
  OutlineDecoder decoder;
  (void)decoder.push(bytes);
  decoder.finish();
  CHECK(decoder.refused());
  CHECK(decoder.problems().size() <= 100);
}

}  // namespace
}  // namespace gs::qnv
