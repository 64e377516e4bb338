#include "qnv/container/container.h"

#include <zlib.h>
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <random>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace gs::qnv {
namespace {

using Bytes = std::vector<std::byte>;

StreamHeader example_header() {
  StreamHeader h;
  Description& d = h.description;
  h.kind = Kind::volume;
  d.two_sided = true;
  d.box = {{-1, -2, -3}, {4, 5, 6}};
  d.total = 12.5;
  d.spacing = 0.25f;
  d.value_range = {-7, 8};
  d.transfer = {{0, {1, 2, 3}, 0}, {0.5f, {4, 5, 6}, 0.75f}, {1, {7, 8, 9}, 1}};
  d.metadata = {{"title", "A t\xc3\xabst"}, {"empty", ""}, {"lines", "one\ntwo"}};
  h.payload = Payload::records;
  h.colored = true;
  h.color = {9, 8, 7};
  h.vectors = 0x0123456789abcdefULL;
  h.chunks = 77;
  h.directory = 0xfedcba9876543210ULL;
  h.cube = {{-1.5f, -2.5f, -3.5f}, 10};
  h.palette = {{1, 1, 1}, {2, 3, 4}, {255, 254, 253}};
  return h;
}

StreamHeader plain_header() {
  StreamHeader h;
  h.description.box = {{0, 0, 0}, {1, 1, 1}};
  return h;
}

std::variant<StreamHeader, StreamProblem> decode(std::span<const std::byte> bytes) {
  std::size_t size = 0;
  bool more = false;
  auto result = decode_header(bytes, size, more);
  if (more) return StreamProblem{0, "more"};
  return result;
}

Bytes payload_of(std::size_t size, unsigned seed) {
  std::mt19937 random(seed);
  Bytes bytes(size);
  for (std::byte& b : bytes) b = static_cast<std::byte>(random());
  return bytes;
}

void append(Bytes& to, const Bytes& more) { to.insert(to.end(), more.begin(), more.end()); }

struct Read {
  std::vector<std::pair<ChunkType, Bytes>> chunks;
  std::vector<std::uint64_t> offsets;
  std::vector<StreamProblem> problems;
  bool refused = false;
};

Read read_all(std::span<const std::byte> bytes, std::size_t piece) {
  Read read;
  StreamReader reader;
  const auto on_chunk = [&](ChunkType type, std::span<const std::byte> payload, std::uint64_t offset) {
    read.chunks.emplace_back(type, Bytes(payload.begin(), payload.end()));
    read.offsets.push_back(offset);
  };
  for (std::size_t i = 0; i < bytes.size(); i += piece)
    (void)reader.push(bytes.subspan(i, std::min(piece, bytes.size() - i)), on_chunk);
  reader.finish(on_chunk);
  read.problems = reader.problems();
  read.refused = reader.refused();
  return read;
}

struct Example {
  Bytes bytes;
  std::vector<Bytes> payloads;
  std::vector<std::size_t> starts;
};

Example example(std::size_t chunks = 12) {
  Example e;
  e.bytes = encode_header(plain_header());
  for (std::size_t i = 0; i < chunks; ++i) {
    e.payloads.push_back(payload_of(i == 3 ? 0 : 20 + 37 * i, static_cast<unsigned>(i)));
    e.starts.push_back(e.bytes.size());
    append(e.bytes, encode_chunk(i == 5 ? ChunkType::records : ChunkType::packed, e.payloads.back()));
  }
  return e;
}

TEST_CASE("writes the header as FORMAT.md defines") {
  const Bytes bytes = encode_header(example_header());
  const auto u8 = [&](std::size_t at) { return std::to_integer<unsigned>(bytes[at]); };
  const auto f32 = [&](std::size_t at) {
    float value;
    std::memcpy(&value, bytes.data() + at, 4);
    return value;
  };
  const auto f64 = [&](std::size_t at) {
    double value;
    std::memcpy(&value, bytes.data() + at, 8);
    return value;
  };
  const std::vector<unsigned> magic{0x89, 'Q', 'N', 'V', 13, 10, 26, 10, 1, 0, 1, 0};
  for (std::size_t i = 0; i < magic.size(); ++i) CHECK(u8(i) == magic[i]);
  CHECK(u8(12) + 256 * u8(13) == bytes.size());
  CHECK(u8(20) == 3);
  CHECK(u8(22) == 9);
  CHECK(f32(26) == -1);
  CHECK(f32(46) == 6);
  CHECK(f64(52) == 12.5);
  CHECK(f32(60) == 0.25f);
  CHECK(f32(68) == 8);
  CHECK(u8(72) == 0xef);
  CHECK(u8(80) == 77);
  CHECK(u8(84) == 0x10);
  CHECK(f32(92) == -1.5f);
  CHECK(f32(104) == 10);
  CHECK(u8(108) == 1);
  CHECK(u8(110) == 9);
  CHECK(u8(114 + 3) == 2);
}

// Readers of version 1 must reject these streams, because they would show them at a wrong position.
TEST_CASE("writes version 2 for a header with an origin, else version 1") {
  StreamHeader header = example_header();
  const Bytes before = encode_header(header);
  header.description.origin = {4'500'000.5, 0, -1e-3};
  const Bytes bytes = encode_header(header);
  CHECK(std::to_integer<int>(before[8]) == 1);
  CHECK(std::to_integer<int>(bytes[8]) == 2);
  CHECK(bytes.size() == before.size() + 6 + 24);
  const auto read = decode(bytes);
  REQUIRE(std::holds_alternative<StreamHeader>(read));
  CHECK(encode_header(std::get<StreamHeader>(read)) == encode_header(header));
  // The section has no meaning in version 1, and is required in version 2.
  const auto refused = [&](Bytes changed) {
    std::fill_n(changed.begin() + 16, 4, std::byte{0});
    const auto sum =
        static_cast<std::uint32_t>(crc32_z(0, reinterpret_cast<const unsigned char*>(changed.data()), changed.size()));
    std::memcpy(changed.data() + 16, &sum, 4);
    return std::holds_alternative<StreamProblem>(decode(changed));
  };
  Bytes old = bytes, bare = before, unknown = bytes;
  old[8] = std::byte{1};
  bare[8] = std::byte{2};
  unknown[8] = std::byte{3};
  CHECK(!refused(old));
  CHECK(refused(bare));
  CHECK(refused(unknown));
  StreamHeader outlines = plain_header();
  outlines.payload = Payload::outlines;
  outlines.description.origin = {1, 2, 3};
  CHECK(std::holds_alternative<StreamProblem>(decode(encode_header(outlines))));
  for (const double impossible : {std::numeric_limits<double>::infinity(), std::nan(""), 2e18, -2e18}) {
    header.description.origin.y = impossible;
    CHECK(std::holds_alternative<StreamProblem>(decode(encode_header(header))));
  }
}

TEST_CASE("restores a header from its bytes") {
  for (const StreamHeader& header : {example_header(), plain_header()}) {
    const Bytes bytes = encode_header(header);
    CHECK(is_stream(bytes));
    const auto result = decode(bytes);
    REQUIRE(std::holds_alternative<StreamHeader>(result));
    CHECK(encode_header(std::get<StreamHeader>(result)) == encode_header(header));
  }
  CHECK_FALSE(is_stream({}));
}

TEST_CASE("asks for more bytes for every prefix of a header, and rejects every flipped bit") {
  Bytes bytes = encode_header(example_header());
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    std::size_t header_bytes = 0;
    bool more = false;
    const Bytes prefix(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
    REQUIRE(std::holds_alternative<StreamProblem>(decode_header(prefix, header_bytes, more)));
    REQUIRE(more);
  }
  for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
    bytes[bit / 8] ^= static_cast<std::byte>(1u << bit % 8);
    REQUIRE(std::holds_alternative<StreamProblem>(decode(bytes)));
    bytes[bit / 8] ^= static_cast<std::byte>(1u << bit % 8);
  }
}

TEST_CASE("rejects headers with impossible numbers") {
  const float infinity = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
  const auto refused = [](auto change) {
    StreamHeader header = plain_header();
    change(header);
    return std::holds_alternative<StreamProblem>(decode(encode_header(header)));
  };
  for (const float bad : {infinity, -infinity, nan}) {
    CHECK(refused([&](StreamHeader& h) { h.description.box.lower.y = bad; }));
    CHECK(refused([&](StreamHeader& h) { h.description.box.upper.z = bad; }));
    CHECK(refused([&](StreamHeader& h) { h.description.total = static_cast<double>(bad); }));
    CHECK(refused([&](StreamHeader& h) { h.description.spacing = bad; }));
    CHECK(refused([&](StreamHeader& h) { h.description.value_range.second = bad; }));
    CHECK(refused([&](StreamHeader& h) { h.cube.lower.x = bad; }));
    CHECK(refused([&](StreamHeader& h) { h.cube.edge = bad; }));
  }
  CHECK(refused([](StreamHeader& h) { h.cube.edge = 0; }));
  CHECK(refused([](StreamHeader& h) { h.cube.edge = -1; }));
  CHECK(refused([](StreamHeader& h) { h.cube = {glm::vec3(3e38f), 3e38f}; }));
  CHECK(refused([](StreamHeader& h) { h.description.box = {}; }));
  CHECK(refused([](StreamHeader& h) { h.description.box = {glm::vec3(-3e38f), glm::vec3(3e38f)}; }));
  CHECK(refused([](StreamHeader& h) { h.kind = Kind::volume; }));  // volumes are records
  CHECK_FALSE(refused([](StreamHeader&) {}));
}

TEST_CASE("sorts a transfer function and clamps it to 0..1") {
  StreamHeader header = plain_header();
  header.description.transfer = {{5, {1, 1, 1}, -1},
                                 {0.5f, {2, 2, 2}, 7},
                                 {-1, {3, 3, 3}, 0.5f},
                                 {std::numeric_limits<float>::quiet_NaN(), {4, 4, 4}, 0.5f}};
  const auto result = decode(encode_header(header));
  REQUIRE(std::holds_alternative<StreamHeader>(result));
  const std::vector<TransferPoint> expected{{0, {3, 3, 3}, 0.5f}, {0.5f, {2, 2, 2}, 1}, {1, {1, 1, 1}, 0}};
  CHECK(std::get<StreamHeader>(result).description.transfer == expected);
}

TEST_CASE("returns whole chunks of any size, however the stream is cut") {
  const Example e = example();
  for (std::size_t piece = 1; piece <= e.bytes.size(); piece = piece < 40 ? piece + 1 : piece * 2) {
    const Read read = read_all(e.bytes, piece);
    REQUIRE(read.problems.empty());
    REQUIRE(read.chunks.size() == e.payloads.size());
    for (std::size_t i = 0; i < e.payloads.size(); ++i) {
      REQUIRE(read.chunks[i].second == e.payloads[i]);
      REQUIRE(read.chunks[i].first == (i == 5 ? ChunkType::records : ChunkType::packed));
      REQUIRE(read.offsets[i] == e.starts[i]);
    }
  }
  // Now the longest header.
  Bytes bytes = encode_header(plain_header());
  append(bytes, encode_chunk(ChunkType::packed, payload_of(kMaxChunkBytes, 5)));
  CHECK(read_all(bytes, 1000).chunks.at(0).second == payload_of(kMaxChunkBytes, 5));
}

TEST_CASE("returns the whole chunks of a prefix, and reports that it was cut") {
  const Example e = example();
  for (std::size_t size = 0; size < e.bytes.size(); ++size) {
    const Read read = read_all(std::span(e.bytes).first(size), 64);
    std::size_t whole = 0;
    bool between = size == 0;
    for (std::size_t i = 0; i < e.starts.size(); ++i) {
      whole += e.starts[i] + kChunkHeaderBytes + e.payloads[i].size() <= size;
      between = between || e.starts[i] == size;
    }
    REQUIRE(read.chunks.size() == whole);
    REQUIRE(read.problems.empty() == (between && size > 0));
    REQUIRE_FALSE(read.refused);
  }
}

TEST_CASE("loses at most one chunk to a flipped bit, and reports it") {
  Example e = example(7);
  for (std::size_t bit = 8 * e.starts[0]; bit < 8 * e.bytes.size(); ++bit) {
    e.bytes[bit / 8] ^= static_cast<std::byte>(1u << bit % 8);
    const Read read = read_all(e.bytes, 100);
    REQUIRE_FALSE(read.problems.empty());
    REQUIRE(read.chunks.size() + 1 == e.payloads.size());
    for (const auto& [type, payload] : read.chunks)
      REQUIRE(std::find(e.payloads.begin(), e.payloads.end(), payload) != e.payloads.end());
    e.bytes[bit / 8] ^= static_cast<std::byte>(1u << bit % 8);
  }
}

TEST_CASE("continues after lost and inserted bytes") {
  const Example e = example();
  for (std::size_t at = e.starts[0]; at < e.bytes.size(); at += 7)
    for (const std::size_t size : {std::size_t{1}, std::size_t{50}}) {
      Bytes lost = e.bytes;
      lost.erase(lost.begin() + static_cast<std::ptrdiff_t>(at),
                 lost.begin() + static_cast<std::ptrdiff_t>(std::min(at + size, lost.size())));
      REQUIRE(read_all(lost, 64).chunks.size() + 3 >= e.payloads.size());
      Bytes more = e.bytes;
      const Bytes noise = payload_of(size, static_cast<unsigned>(at));
      more.insert(more.begin() + static_cast<std::ptrdiff_t>(at), noise.begin(), noise.end());
      REQUIRE(read_all(more, 64).chunks.size() + 1 >= e.payloads.size());
    }
}

TEST_CASE("skips chunks and sections of later versions") {
  Bytes bytes = encode_header(plain_header());
  append(bytes, encode_chunk(static_cast<ChunkType>(99), payload_of(30, 1)));
  append(bytes, encode_chunk(ChunkType::packed, payload_of(30, 2)));
  const Read read = read_all(bytes, 1000);
  CHECK(read.problems.empty());
  REQUIRE(read.chunks.size() == 1);
  CHECK(read.chunks[0].second == payload_of(30, 2));
}

TEST_CASE("refuses data that are not a stream and reports why") {
  const auto problem = [](Bytes bytes) {
    const Read read = read_all(bytes, 10);
    REQUIRE(read.refused);
    REQUIRE(read.chunks.empty());
    return read.problems.at(0).message;
  };
  Bytes bytes = encode_header(plain_header());
  bytes[0] = std::byte{'P'};
  CHECK(problem(bytes) == "not a QNV stream; expected the bytes 89 51 4E 56 0D 0A 1A 0A at the start");
  bytes = encode_header(plain_header());
  bytes[8] = std::byte{3};
  CHECK(problem(bytes) == "is QNV version 3; expected 1 or 2");
  bytes = encode_header(plain_header());
  bytes[15] = std::byte{255};
  CHECK(problem(bytes) == "the header states 4278190188 bytes; expected 108 to 1048576");
  CHECK(read_all({}, 1).problems.at(0).message == "ends inside its header");
}

TEST_CASE("gives up bytes that look like chunks everywhere in reasonable time") {
  Bytes bytes = encode_header(plain_header());
  const Bytes false_start{std::byte{0x51}, std::byte{0x43}, std::byte{0xff},
                          std::byte{0xff}, std::byte{1},    std::byte{0}};
  while (bytes.size() < (std::size_t{2} << 20)) append(bytes, false_start);
  const Read read = read_all(bytes, 1 << 16);
  CHECK(read.chunks.empty());
  CHECK(read.refused);
  CHECK(read.problems.size() <= 100);
}

TEST_CASE("restores a directory with boxes that are never smaller") {
  const Box box{{-5, 0, 2}, {7, 1, 2}};
  std::mt19937 random(4);
  std::vector<DirectoryEntry> entries;
  for (std::size_t i = 0; i < 5000; ++i) {
    DirectoryEntry e;
    e.offset = 108 + i * 500;
    e.bytes = static_cast<std::uint32_t>(kChunkHeaderBytes + random() % 65536);
    e.level = static_cast<std::uint8_t>(random());
    e.parent = static_cast<std::uint32_t>(random());
    e.vectors = static_cast<std::uint32_t>(random());
    for (int corner = 0; corner < 2; ++corner) {
      const auto part = [&] { return static_cast<float>(random() % 1001) / 1000; };
      e.box.add(box.lower + box.size() * glm::vec3(part(), part(), part()));
    }
    entries.push_back(e);
  }
  const Bytes bytes = encode_directory(entries, box);
  Bytes stream = encode_header(plain_header());
  append(stream, bytes);
  const Read read = read_all(stream, 100000);
  REQUIRE(read.chunks.size() == 3);
  std::vector<DirectoryEntry> all;
  for (const auto& [type, payload] : read.chunks) {
    CHECK(type == ChunkType::directory);
    for (const DirectoryEntry& e : decode_directory(payload, box)) all.push_back(e);
  }
  REQUIRE(all.size() == entries.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    CHECK(all[i].offset == entries[i].offset);
    CHECK(all[i].bytes == entries[i].bytes);
    CHECK(all[i].level == entries[i].level);
    CHECK(all[i].parent == entries[i].parent);
    CHECK(all[i].vectors == entries[i].vectors);
    for (int axis = 0; axis < 3; ++axis) {
      const float step = box.size()[axis] / 65535 * 1.5f + 1e-6f;
      REQUIRE(all[i].box.lower[axis] <= entries[i].box.lower[axis] + 1e-5f);
      REQUIRE(all[i].box.lower[axis] >= entries[i].box.lower[axis] - step);
      REQUIRE(all[i].box.upper[axis] >= entries[i].box.upper[axis] - 1e-5f);
      REQUIRE(all[i].box.upper[axis] <= entries[i].box.upper[axis] + step);
    }
  }
  // An incomplete entry is dropped.
  CHECK(decode_directory(std::span(read.chunks[0].second).first(63), box).size() == 1);
  CHECK(encode_directory({}, box).empty());
}

}  // namespace
}  // namespace gs::qnv
