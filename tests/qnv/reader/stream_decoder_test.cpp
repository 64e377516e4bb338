#include "qnv/reader/stream_decoder.h"

#include "qnv/base/morton.h"
#include "qnv/codecs/octree/packed.h"
#include "qnv/codecs/records/encode/encode_vectors.h"
#include "qnv/codecs/records/records_payload.h"
#include "tests/geometries.h"
#include "tests/qnv/pinned_vectors.h"
#include "tests/qnv/surface_shapes.h"
#include "tests/watched.h"

#include <catch2/catch.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <numeric>
#include <random>
#include <set>
#include <span>
#include <sstream>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace gs::qnv {
namespace {

using Bytes = std::vector<std::byte>;

bool same(const Splats& a, const Splats& b) {
  const auto cells = [](const Cell& x, const Cell& y) { return x.edge == y.edge && x.offset == y.offset; };
  return a.description == b.description && a.positions == b.positions && a.normals == b.normals &&
         a.weights == b.weights && a.colors == b.colors && a.color == b.color &&
         std::equal(a.cells.begin(), a.cells.end(), b.cells.begin(), b.cells.end(), cells);
}

// Stream split into header and chunks.
struct PackedParts {
  EncodedStream stream;
  Bytes header;
  std::vector<Bytes> payloads;

  explicit PackedParts(EncodedStream encoded) : stream(std::move(encoded)) {
    header = encode_header(stream.header);
    StreamReader reader;
    const auto keep = [&](ChunkType type, std::span<const std::byte> payload, std::uint64_t) {
      if (type == ChunkType::packed) payloads.emplace_back(payload.begin(), payload.end());
    };
    REQUIRE(reader.push(stream.bytes, keep));
    REQUIRE(payloads.size() == stream.header.chunks);
  }
  [[nodiscard]] StreamDecoder begun() const {
    StreamDecoder decoder;
    REQUIRE(decoder.push(header));
    return decoder;
  }
  [[nodiscard]] Splats whole() const {
    StreamDecoder decoder;
    REQUIRE(decoder.push(stream.bytes));
    return content_of<Splats>(decoder.geometry());
  }
};

PackedParts sphere_parts(std::size_t vectors) {
  EncodeOptions options;
  options.vectors = vectors;
  return PackedParts(encoded(sphere(60), options));
}

// Returns a coloured ball with a two-sided sheet inside.
PackedParts small_parts() {
  Triangles shape = sphere(24, 1, {}, true);
  for (Triangle t : two_sided_sheet()) {
    for (glm::vec3& p : t.positions) p *= 0.6f;
    shape.push_back(t);
  }
  EncodeOptions options;
  options.vectors = 1500;
  return PackedParts(encoded(shape, options));
}

// Cube of the octree: its level and cell.
struct Place {
  int level;
  std::array<std::uint32_t, 3> cell;
};

Place place_of(const Splats& geometry, std::size_t i, const Cube& cube) {
  const Cell& cell = geometry.cells[i];
  const glm::vec3 at = (geometry.positions[i] - cell.offset * geometry.normals[i] - cube.lower) / cell.edge - 0.5f;
  Place place{static_cast<int>(std::lround(std::log2(cube.edge / cell.edge))), {}};
  for (int axis = 0; axis < 3; ++axis)
    place.cell[static_cast<std::size_t>(axis)] = static_cast<std::uint32_t>(std::lround(at[axis]));
  return place;
}

// Checks that each part of the sphere is covered once: its points are in cubes with a splat (within one finest voxel,
// where the surface only touches a cube), and no cube is inside another.
void check_cover(const Splats& geometry, const Cube& cube, int finest) {
  std::set<std::pair<int, std::uint64_t>> cubes;
  for (std::size_t i = 0; i < geometry.size(); ++i) {
    const Place p = place_of(geometry, i, cube);
    REQUIRE(cubes.emplace(p.level, morton_encode(p.cell[0], p.cell[1], p.cell[2])).second);
  }
  for (auto [level, key] : cubes)
    while (level-- > 0) REQUIRE_FALSE(cubes.contains({level, key >>= 3}));
  const int n = 1 << finest;
  for (int i = 0; i < 500; ++i) {
    const double z = 1 - 2 * (i + 0.5) / 500, r = std::sqrt(1 - z * z), a = i * 2.399963;
    const glm::vec3 p =
        (glm::vec3(r * std::cos(a), r * std::sin(a), z) * 0.9995f - cube.lower) * (static_cast<float>(n) / cube.edge);
    bool covered = false;
    for (int d = 0; d < 27 && !covered; ++d) {
      std::array<std::uint32_t, 3> cell{};
      for (int axis = 0, rest = d; axis < 3; ++axis, rest /= 3)
        cell[static_cast<std::size_t>(axis)] =
            static_cast<std::uint32_t>(std::clamp(static_cast<int>(p[axis]) + rest % 3 - 1, 0, n - 1));
      std::uint64_t key = morton_encode(cell[0], cell[1], cell[2]);
      for (int level = finest; level > 0 && !covered; --level, key >>= 3) covered = cubes.contains({level, key});
    }
    REQUIRE(covered);
  }
}

int finest_level(const PackedParts& parts) {
  int finest = 0;
  for (const Bytes& payload : parts.payloads) {
    const auto header = std::get<ClusterHeader>(read_cluster_header(payload));
    finest = std::max(finest, header.level + header.levels);
  }
  return finest;
}

TEST_CASE("decodes every prefix of a stream to a complete picture") {
  const PackedParts parts = sphere_parts(8000);
  const std::size_t first = parts.header.size() + kChunkHeaderBytes + parts.payloads[0].size();
  std::size_t last = 0;
  StreamDecoder decoder;
  const int finest = finest_level(parts);
  for (std::size_t at = 0; at < parts.stream.bytes.size(); ++at) {
    const std::uint64_t before = decoder.revision();
    REQUIRE(decoder.push(std::span(parts.stream.bytes).subspan(at, 1)));
    if (at + 1 < first) REQUIRE(decoder.vectors() == 0);
    if (decoder.revision() == before) continue;
    const Splats geometry = content_of<Splats>(decoder.geometry());
    REQUIRE(at + 1 >= first);
    REQUIRE(geometry.size() == decoder.vectors());
    REQUIRE(geometry.size() >= last);
    REQUIRE(total_weight(geometry) == Approx(4 * std::numbers::pi).epsilon(0.1));
    check_cover(geometry, parts.stream.header.cube, finest);
    last = geometry.size();
  }
  CHECK(last == parts.stream.header.vectors);
}

TEST_CASE("decodes a stream to the same picture wherever it is cut in two") {
  const PackedParts parts = small_parts();
  const Splats expected = parts.whole();
  CHECK(expected.size() > 1500);
  for (std::size_t at = 0; at <= parts.stream.bytes.size(); at += watched_step(5)) {
    StreamDecoder decoder;
    REQUIRE(decoder.push(std::span(parts.stream.bytes).first(at)));
    REQUIRE(decoder.push(std::span(parts.stream.bytes).subspan(at)));
    decoder.finish();
    REQUIRE(decoder.problems().empty());
    REQUIRE(same(content_of<Splats>(decoder.geometry()), expected));
  }
}

TEST_CASE("leaves no hole and no overlap with chunks in any order and with any losses") {
  const PackedParts parts = sphere_parts(8000);
  const Splats expected = parts.whole();
  const int finest = finest_level(parts);
  std::mt19937 random(5);
  std::vector<std::size_t> order(parts.payloads.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  for (int round = 0; round < 40; ++round) {
    std::shuffle(order.begin(), order.end(), random);
    const unsigned lost = round < 5 ? 0 : static_cast<unsigned>(round * 2);  // per cent
    StreamDecoder decoder = parts.begun();
    for (const std::size_t i : order)
      if (i == 0 || random() % 100 >= lost) decoder.add(ChunkType::packed, parts.payloads[i]);
    CHECK(decoder.refused_chunks() == 0);
    const Splats geometry = content_of<Splats>(decoder.geometry());
    REQUIRE(geometry.size() == decoder.vectors());
    if (lost == 0) REQUIRE(same(geometry, expected));
    check_cover(geometry, parts.stream.header.cube, finest);
    CHECK(total_weight(geometry) == Approx(4 * std::numbers::pi).epsilon(0.1));
    // The lost chunks are received at last.
    for (const Bytes& payload : parts.payloads) decoder.add(ChunkType::packed, payload);
    REQUIRE(same(content_of<Splats>(decoder.geometry()), expected));
  }
}

TEST_CASE("decodes a cluster with its ancestors alone") {
  const PackedParts parts = sphere_parts(5000);
  std::vector<std::uint32_t> parent;
  for (const Bytes& payload : parts.payloads)
    parent.push_back(std::get<ClusterHeader>(read_cluster_header(payload)).parent);
  for (std::size_t i = 0; i < parts.payloads.size(); ++i) {
    StreamDecoder decoder = parts.begun();
    std::size_t needed = 0;
    for (std::uint32_t id = static_cast<std::uint32_t>(i); id != kNoParent; id = parent[id], ++needed)
      decoder.add(ChunkType::packed, parts.payloads[id]);
    REQUIRE(decoder.refused_chunks() == 0);
    REQUIRE(decoder.revision() == needed);
  }
}

TEST_CASE("reports every flipped bit of a stream and shows no wrong data") {
  const PackedParts parts = small_parts();
  const Splats expected = parts.whole();
  Bytes bytes = parts.stream.bytes;
  std::set<std::array<float, 3>> right;
  // The stream shows splats of several levels while a chunk is missing.
  StreamDecoder growing = parts.begun();
  for (const Bytes& payload : parts.payloads) {
    growing.add(ChunkType::packed, payload);
    for (const glm::vec3& p : content_of<Splats>(growing.geometry()).positions) right.insert({p.x, p.y, p.z});
  }
  for (std::size_t bit = 0; bit < 8 * bytes.size(); bit += watched_step(11)) {
    bytes[bit / 8] ^= static_cast<std::byte>(1u << bit % 8);
    StreamDecoder decoder;
    const bool good = decoder.push(bytes);
    decoder.finish();
    REQUIRE_FALSE(decoder.problems().empty());
    if (bit / 8 < parts.header.size()) {
      REQUIRE((!good || decoder.header() == nullptr));
      REQUIRE(decoder.geometry().size() == 0);
    } else if (bit % 8 == 0) {
      const Splats geometry = content_of<Splats>(decoder.geometry());
      REQUIRE(geometry.empty() == (bit / 8 < parts.header.size() + kChunkHeaderBytes + parts.payloads[0].size()));
      for (const glm::vec3& p : geometry.positions) REQUIRE_EACH(right.contains({p.x, p.y, p.z}));
    }
    bytes[bit / 8] ^= static_cast<std::byte>(1u << bit % 8);
  }
}

TEST_CASE("survives every flipped bit in chunks without a checksum") {
  const PackedParts parts = small_parts();
  std::vector<Bytes> payloads = parts.payloads;
  for (std::size_t which = 0; which < 3; ++which)
    for (std::size_t bit = 0; bit < 8 * payloads[which].size(); bit += (bit < 8 * 22 ? 1 : 5) * watched_step(7)) {
      payloads[which][bit / 8] ^= static_cast<std::byte>(1u << bit % 8);
      StreamDecoder decoder = parts.begun();
      for (const Bytes& payload : payloads) decoder.add(ChunkType::packed, payload);
      const Splats geometry = content_of<Splats>(decoder.geometry());
      REQUIRE(geometry.size() == decoder.vectors());
      for (std::size_t i = 0; i < geometry.size(); ++i)
        REQUIRE_EACH((geometry.weights[i] > 0 && std::isfinite(geometry.weights[i])));
      payloads[which][bit / 8] ^= static_cast<std::byte>(1u << bit % 8);
    }
}

Bytes with_ids(Bytes payload, std::uint32_t id, std::uint32_t parent) {
  for (std::size_t i = 0; i < 4; ++i) {
    payload[i] = static_cast<std::byte>(id >> (8 * i) & 255);
    payload[4 + i] = static_cast<std::byte>(parent >> (8 * i) & 255);
  }
  return payload;
}

TEST_CASE("rejects cycles, duplicate numbers and second roots") {
  const PackedParts parts = small_parts();
  const Splats expected = parts.whole();
  StreamDecoder decoder = parts.begun();
  // One chunk is its own parent, and two chunks are each other's parents. They wait endlessly.
  decoder.add(ChunkType::packed, with_ids(parts.payloads[1], 900, 900));
  decoder.add(ChunkType::packed, with_ids(parts.payloads[1], 901, 902));
  decoder.add(ChunkType::packed, with_ids(parts.payloads[1], 902, 901));
  CHECK(decoder.geometry().size() == 0);
  for (const Bytes& payload : parts.payloads) decoder.add(ChunkType::packed, payload);
  CHECK(decoder.refused_chunks() == 0);
  CHECK(same(content_of<Splats>(decoder.geometry()), expected));
  std::size_t refused = 0;
  const auto refuses = [&](const Bytes& payload) {
    decoder.add(ChunkType::packed, payload);
    return decoder.refused_chunks() == ++refused && same(content_of<Splats>(decoder.geometry()), expected);
  };
  CHECK(refuses(parts.payloads[0]));                            // repeated
  CHECK(refuses(parts.payloads[1]));                            // another repeated chunk
  CHECK(refuses(with_ids(parts.payloads[0], 700, kNoParent)));  // a second root
  CHECK(refuses(with_ids(parts.payloads[1], 701, 0)));          // already divided
  CHECK(refuses(with_ids(parts.payloads[0], 702, 0)));          // levels that do not fit
  CHECK(refuses(with_ids(parts.payloads[1], kNoParent, 0)));    // an invalid chunk number
  CHECK(refuses({}));
  CHECK(refuses(Bytes(21)));
  decoder.add(ChunkType::records, parts.payloads[0]);
  CHECK(decoder.refused_chunks() == ++refused);
}

TEST_CASE("limits the memory for chunks without their parents") {
  const PackedParts parts = small_parts();
  StreamDecoder decoder = parts.begun();
  Bytes tiny(parts.payloads[1].begin(), parts.payloads[1].begin() + 22);
  for (std::uint32_t i = 0; i < 500'000; ++i) decoder.add(ChunkType::packed, with_ids(tiny, 10 + i, 5));
  CHECK(decoder.refused_chunks() > 0);
  CHECK(decoder.refused_chunks() < 200'000);
  CHECK(decoder.geometry().size() == 0);
}

TEST_CASE("decodes at most the maximum number of vectors") {
  const PackedParts parts = small_parts();
  for (const std::size_t most : {0u, 10u, 300u, 900u}) {
    StreamDecoder decoder(most);
    REQUIRE(decoder.push(parts.stream.bytes));
    CHECK(decoder.vectors() <= most);
    CHECK(decoder.geometry().size() <= most);
    CHECK(decoder.refused_chunks() > 0);
  }
}

TEST_CASE("accepts the records of a chunk in any pieces") {
  Splats geometry;
  std::mt19937 random(5);
  for (int i = 0; i < 3000; ++i) {
    const auto part = [&] { return static_cast<float>(random() % 1000) / 1000; };
    geometry.positions.emplace_back(part(), part(), part());
    geometry.normals.emplace_back(0, 0, 1);
    geometry.weights.push_back(0.5f + part());
    geometry.description.box.add(geometry.positions.back());
    geometry.description.total += geometry.weights.back();
  }
  EncodeOptions options;
  const auto encoded = encode_vectors(geometry, options);
  const auto& stream = std::get<EncodedStream>(encoded);
  std::vector<Bytes> payloads;
  StreamReader reader;
  REQUIRE(reader.push(stream.bytes, [&](ChunkType type, std::span<const std::byte> payload, std::uint64_t) {
    if (type == ChunkType::records) payloads.emplace_back(payload.begin(), payload.end());
  }));
  StreamDecoder whole, pieces;
  REQUIRE(whole.push(stream.bytes));
  REQUIRE(pieces.push(encode_header(stream.header)));
  constexpr std::size_t kPiece = 47 * 8;
  std::vector<std::pair<std::size_t, std::size_t>> order;  // payload, first byte
  for (std::size_t i = 0; i < payloads.size(); ++i)
    for (std::size_t at = kRecordsHeaderBytes; at < payloads[i].size(); at += kPiece) order.emplace_back(i, at);
  std::shuffle(order.begin(), order.end(), random);
  REQUIRE(order.size() > 50);
  std::size_t vectors = 0;
  for (const auto& [i, at] : order) {
    const std::size_t end = std::min(at + kPiece, payloads[i].size());
    const Bytes part(payloads[i].begin(), payloads[i].begin() + static_cast<std::ptrdiff_t>(end));
    const ByteRange missing{kRecordsHeaderBytes, at};
    pieces.add(ChunkType::records, part, std::span(&missing, at > kRecordsHeaderBytes ? 1 : 0));
    vectors += (end - at) / 8;
    REQUIRE(pieces.vectors() == vectors);
  }
  CHECK(pieces.refused_chunks() == 0);
  const auto sorted = [](const Splats& c) {
    std::multiset<std::array<float, 4>> all;
    for (std::size_t i = 0; i < c.size(); ++i)
      all.insert({c.positions[i].x, c.positions[i].y, c.positions[i].z, c.weights[i]});
    return all;
  };
  CHECK(sorted(content_of<Splats>(pieces.geometry())) == sorted(content_of<Splats>(whole.geometry())));
  // Only records can have missing ranges.
  const ByteRange missing{0, 8};
  pieces.add(ChunkType::packed, payloads[0], std::span(&missing, 1));
  CHECK(pieces.refused_chunks() == 1);
}

TEST_CASE("is empty before the header, and reads directories in pieces") {
  const PackedParts parts = small_parts();
  StreamDecoder decoder;
  decoder.add(ChunkType::packed, parts.payloads[0]);
  CHECK(decoder.geometry().size() == 0);
  CHECK(decoder.header() == nullptr);
  REQUIRE(decoder.push(parts.stream.bytes));
  CHECK(decoder.directory().size() == parts.stream.header.chunks);
  decoder.add(ChunkType::directory, Bytes(7));
  CHECK(decoder.directory().size() == parts.stream.header.chunks);
}

// encode_surface once wrote tests/qnv/vectors/v1/packed_sphere.qnv. A program written from FORMAT.md alone made
// packed_sphere.txt. Never regenerate either: streams of version 1 stay readable.
TEST_CASE("decodes a stream of version 1 to its pinned numbers") {
  const std::string folder = GHOSTSPACE_TESTS "/qnv/vectors/v1/";
  std::ifstream in(folder + "packed_sphere.qnv", std::ios::binary);
  const std::vector<char> chars{std::istreambuf_iterator<char>(in), {}};
  REQUIRE(chars.size() > 1000);
  Bytes bytes(chars.size());
  std::transform(chars.begin(), chars.end(), bytes.begin(), [](char c) { return static_cast<std::byte>(c); });
  StreamDecoder decoder;
  REQUIRE(decoder.push(bytes));
  decoder.finish();
  REQUIRE(decoder.problems().empty());
  REQUIRE(decoder.refused_chunks() == 0);
  const Splats geometry = content_of<Splats>(decoder.geometry());
  std::ifstream text(folder + "packed_sphere.txt");
  std::string line;
  std::size_t i = 0;
  while (std::getline(text, line)) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream numbers(line);
    std::array<double, 9> d{};
    std::array<int, 3> color{};
    for (std::size_t k = 0; k < 7; ++k) numbers >> d[k];
    for (int& c : color) numbers >> c;
    numbers >> d[7] >> d[8];
    REQUIRE(numbers);
    REQUIRE(i < geometry.size());
    for (int axis = 0; axis < 3; ++axis) {
      REQUIRE(geometry.positions[i][axis] == Approx(d[static_cast<std::size_t>(axis)]).margin(1e-6));
      REQUIRE(geometry.normals[i][axis] == Approx(d[static_cast<std::size_t>(axis) + 3]).margin(1e-6));
    }
    REQUIRE(geometry.weights[i] == Approx(d[6]).epsilon(1e-5));
    REQUIRE(geometry.colors[i] == Rgb8{static_cast<std::uint8_t>(color[0]), static_cast<std::uint8_t>(color[1]),
                                       static_cast<std::uint8_t>(color[2])});
    REQUIRE(geometry.cells[i].edge == Approx(d[7]).epsilon(1e-6));
    REQUIRE(geometry.cells[i].offset == Approx(d[8]).margin(1e-6));
    ++i;
  }
  CHECK(i == geometry.size());
  CHECK(geometry.description.metadata.at(0).first == "title");
}

// Streams in tests/qnv/vectors/v2 have an origin. records_decode.py made records_far.txt.
TEST_CASE("decodes a stream of version 2 to its pinned positions") {
  const Bytes bytes = read_bytes("records_far.qnv", "v2");
  StreamDecoder decoder;
  REQUIRE(decoder.push(bytes));
  decoder.finish();
  REQUIRE(decoder.problems().empty());
  const Splats geometry = content_of<Splats>(decoder.geometry());
  CHECK(geometry.description.origin == glm::dvec3(4'500'000.5, -4'500'000.5, 3'200'000));
  std::ifstream text(GHOSTSPACE_TESTS "/qnv/vectors/v2/records_far.txt");
  std::size_t i = 0;
  for (std::string line; std::getline(text, line); ++i) {
    std::istringstream numbers(line);
    glm::dvec3 place, normal;
    std::array<int, 3> color{};
    numbers >> place.x >> place.y >> place.z >> normal.x >> normal.y >> normal.z;
    for (int& c : color) numbers >> c;
    REQUIRE(numbers);
    REQUIRE(i < geometry.size());
    // A tenth of a micrometre at four thousand kilometres.
    CHECK(glm::length(geometry.description.origin + glm::dvec3(geometry.positions[i]) - place) < 1e-7);
    CHECK(glm::length(glm::dvec3(geometry.normals[i]) - normal) < 1e-5);
    CHECK(geometry.colors[i] == Rgb8{static_cast<std::uint8_t>(color[0]), static_cast<std::uint8_t>(color[1]),
                                     static_cast<std::uint8_t>(color[2])});
  }
  CHECK(i == geometry.size());
}

}  // namespace
}  // namespace gs::qnv
