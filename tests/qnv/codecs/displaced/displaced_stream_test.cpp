#include "qnv/codecs/displaced/encode/encode_displaced.h"
#include "qnv/codecs/displaced/surface.h"
#include "qnv/codecs/payloads.h"
#include "qnv/mesh/triangle_tree.h"
#include "qnv/reader/loss.h"
#include "qnv/reader/stream_decoder.h"
#include "tests/geometries.h"
#include "tests/qnv/codecs/displaced/displaced_shapes.h"
#include "tests/watched.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace gs::qnv::displaced::stream_test {
namespace {

using Bytes = std::vector<std::byte>;

struct Sample {
  std::string name;
  Triangles triangles;
  Bytes stream;
  double most = 0;  // RMS error of the whole stream, relative to the longest edge of the box
};

Bytes encode(const Triangles& triangles) {
  auto made = encode_displaced(source_of(triangles), {});
  if (const auto* error = std::get_if<EncodeError>(&made)) FAIL(error->message);
  return std::get<EncodedStream>(std::move(made)).bytes;
}

/// Returns a cube of 2 n^2 flat-shaded triangles per side.
Triangles cube(int n) {
  Triangles all = box_shape(glm::vec3(-1), glm::vec3(1), n);
  for (Triangle& t : all)
    t.normals.fill(glm::normalize(glm::cross(t.positions[1] - t.positions[0], t.positions[2] - t.positions[0])));
  return all;
}

Rgb8 painted(const glm::vec3& p) {
  const auto part = [](float x) { return static_cast<std::uint8_t>(127.5f + 127.5f * x); };
  return {part(std::sin(3 * p.x)), part(std::cos(2 * p.y + 1)), part(p.z)};
}

const std::vector<Sample>& samples() {
  static const std::vector<Sample> all = [] {
    std::vector<Sample> made{{"ball", ball(40), {}, 4e-4},
                             {"torus", torus(120, 60), {}, 4e-4},
                             {"sheet", sheet(90), {}, 1e-3},
                             {"cube", cube(24), {}, 1e-3},
                             {"painted ball", ball(30, painted), {}, 5e-4}};
    for (Sample& s : made) s.stream = encode(s.triangles);
    return made;
  }();
  return all;
}

StreamDecoder decoded(std::span<const std::byte> bytes) {
  StreamDecoder decoder;
  (void)decoder.push(bytes);
  decoder.finish();
  return decoder;
}

/// Returns the distance of both surfaces, relative to the longest edge of the box.
double error_of(const IndexedMesh& geometry, const Triangles& source) {
  SurfaceMesh made;
  made.positions = geometry.positions;
  for (std::size_t i = 0; i < geometry.triangles.size(); i += 3)
    made.triangles.push_back({geometry.triangles[i], geometry.triangles[i + 1], geometry.triangles[i + 2]});
  const SurfaceMesh wanted = mesh_of(source);
  const TriangleTree there(wanted), here(made);
  double sum = 0;
  std::size_t count = 0;
  const auto add = [&](const TriangleTree& tree, const std::vector<glm::vec3>& places) {
    const std::size_t step = std::max<std::size_t>(1, places.size() / 3000);
    for (std::size_t i = 0; i < places.size(); i += step, ++count) {
      const double d = static_cast<double>(tree.nearest(places[i], 10, glm::vec3(0), -1).distance);
      sum += d * d;
    }
  };
  add(there, made.positions);
  add(here, wanted.positions);
  const glm::vec3 size = box_of(source).size();
  return std::sqrt(sum / static_cast<double>(count)) / static_cast<double>(std::max({size.x, size.y, size.z}));
}

bool same(const IndexedMesh& a, const IndexedMesh& b) {
  return a.positions == b.positions && a.normals == b.normals && a.weights == b.weights && a.colors == b.colors &&
         a.triangles == b.triangles;
}

std::vector<std::pair<ChunkType, Bytes>> chunks_of(std::span<const std::byte> stream, StreamReader& reader) {
  std::vector<std::pair<ChunkType, Bytes>> chunks;
  (void)reader.push(stream, [&](ChunkType type, std::span<const std::byte> payload, std::uint64_t) {
    if (type == ChunkType::displaced) chunks.emplace_back(type, Bytes(payload.begin(), payload.end()));
  });
  return chunks;
}

std::size_t header_bytes(std::span<const std::byte> stream) {
  std::size_t bytes = 0;
  bool more = false;
  (void)decode_header(stream, bytes, more);
  return bytes;
}

}  // namespace

TEST_CASE("approaches the surface as more of a displaced stream is received") {
  for (const Sample& s : samples()) {
    INFO(s.name);
    CHECK(header_bytes(s.stream) <= 1000);
    double before = 1;
    for (const double part : {0.0, 0.1, 0.4, 1.0}) {
      const std::size_t head = header_bytes(s.stream);
      const auto bytes = head + static_cast<std::size_t>(part * static_cast<double>(s.stream.size() - head));
      const StreamDecoder decoder = decoded(std::span(s.stream).first(bytes));
      CHECK(decoder.refused_chunks() == 0);
      const IndexedMesh geometry = content_of<IndexedMesh>(decoder.geometry());
      check_sound(geometry);
      const double error = error_of(geometry, s.triangles);
      INFO(part << " " << bytes << " bytes: " << error);
      CHECK(error < (part == 1.0 ? s.most : 0.02));
      CHECK(error < before * 1.05);
      before = error;
    }
    const StreamDecoder decoder = decoded(s.stream);
    CHECK(decoder.problems().empty());
    const IndexedMesh geometry = content_of<IndexedMesh>(decoder.geometry());
    CHECK(decoder.vectors() == geometry.size());
    // The sum of weights is the shown area.
    CHECK(total_weight(geometry) == Approx(area_of(s.triangles)).epsilon(0.01));
  }
}

TEST_CASE("keeps closed surfaces closed and boundaries in place") {
  for (const Sample& s : samples()) {
    INFO(s.name);
    for (const double part : {0.3, 1.0}) {
      const auto bytes =
          std::max(header_bytes(s.stream), static_cast<std::size_t>(part * static_cast<double>(s.stream.size())));
      const IndexedMesh geometry = content_of<IndexedMesh>(decoded(std::span(s.stream).first(bytes)).geometry());
      // Corners at one position become one vertex.
      Triangles triangles;
      for (std::size_t i = 0; i < geometry.triangles.size(); i += 3)
        triangles.push_back(triangle_of(geometry.positions[geometry.triangles[i]],
                                        geometry.positions[geometry.triangles[i + 1]],
                                        geometry.positions[geometry.triangles[i + 2]]));
      const SurfaceMesh mesh = mesh_of(triangles);
      CHECK(sides_once(mesh.triangles));
      CHECK((rims_of(mesh.triangles) == 0) == (s.name != "sheet"));
      CHECK(euler_characteristic(mesh.triangles) == (s.name == "torus" || s.name == "sheet" ? 0 : 2));
    }
  }
}

TEST_CASE("keeps sharp edges as creases with the normals of their sides") {
  const IndexedMesh geometry = content_of<IndexedMesh>(decoded(samples()[3].stream).geometry());
  std::size_t straight = 0;
  for (const glm::vec3& n : geometry.normals)
    straight += std::max({std::abs(n.x), std::abs(n.y), std::abs(n.z)}) > 0.98f;
  CHECK(straight > geometry.size() * 97 / 100);
}

TEST_CASE("restores colours within their quantisation steps") {
  const Sample& s = samples()[4];
  const IndexedMesh geometry = content_of<IndexedMesh>(decoded(s.stream).geometry());
  REQUIRE(geometry.colors.size() == geometry.size());
  double sum = 0;
  for (std::size_t i = 0; i < geometry.size(); ++i) {
    const Rgb8 wanted = painted(glm::normalize(geometry.positions[i])), got = geometry.colors[i];
    for (const auto& [a, b] : {std::pair{wanted.r, got.r}, {wanted.g, got.g}, {wanted.b, got.b}})
      sum += (static_cast<double>(a) - b) * (static_cast<double>(a) - b);
  }
  // Colours have steps of 6 in luma and 12 in chroma.
  CHECK(std::sqrt(sum / (3.0 * static_cast<double>(geometry.size()))) < 8);
  CHECK(content_of<IndexedMesh>(decoded(samples()[0].stream).geometry()).colors.empty());
}

TEST_CASE("shows a picture for every prefix that holds the header of a displaced stream") {
  for (const Sample& s : {samples()[2], samples()[4]}) {
    const std::size_t head = header_bytes(s.stream);
    StreamDecoder decoder;
    std::size_t drawn = 0;
    std::uint64_t revision = 0;
    for (std::size_t i = 0; i < s.stream.size(); ++i) {
      REQUIRE(decoder.push(std::span(s.stream).subspan(i, 1)));
      REQUIRE_EACH((decoder.vectors() > 0) == (i + 1 >= head));
      if (decoder.revision() == revision) continue;
      revision = decoder.revision();
      if (++drawn % watched_step(5) != 0) continue;
      const IndexedMesh geometry = content_of<IndexedMesh>(decoder.geometry());
      check_sound(geometry);
      REQUIRE_EACH(geometry.size() == decoder.vectors());
    }
    CHECK(same(content_of<IndexedMesh>(decoder.geometry()), content_of<IndexedMesh>(decoded(s.stream).geometry())));
  }
}

TEST_CASE("decodes a displaced stream to the same surface in any pieces") {
  const Sample& s = samples()[0];
  const IndexedMesh wanted = content_of<IndexedMesh>(decoded(s.stream).geometry());
  for (std::size_t at = 0; at <= s.stream.size(); at += 1 + 16 * watched_step(20)) {
    StreamDecoder decoder;
    REQUIRE(decoder.push(std::span(s.stream).first(at)));
    REQUIRE(decoder.push(std::span(s.stream).subspan(at)));
    decoder.finish();
    REQUIRE_EACH(same(content_of<IndexedMesh>(decoder.geometry()), wanted));
  }
}

TEST_CASE("decodes a displaced stream to the same surface in any order, and with repeated chunks") {
  std::mt19937 random(6);
  for (const Sample& s : samples()) {
    INFO(s.name);
    const IndexedMesh wanted = content_of<IndexedMesh>(decoded(s.stream).geometry());
    StreamReader reader;
    auto chunks = chunks_of(s.stream, reader);
    for (int round = 0; round < 4; ++round) {
      std::shuffle(chunks.begin(), chunks.end(), random);
      StreamDecoder decoder;
      REQUIRE(decoder.push(std::span(s.stream).first(header_bytes(s.stream))));
      for (const auto& [type, payload] : chunks) {
        decoder.add(type, payload);
        if (round == 3) decoder.add(type, payload);
      }
      CHECK(same(content_of<IndexedMesh>(decoder.geometry()), wanted));
    }
  }
}

TEST_CASE("makes a displaced surface only rougher when chunks are lost", "[optimised]") {
  const Triangles rough = sheet(150);
  const Bytes stream = encode(rough);
  StreamReader reader;
  const auto chunks = chunks_of(stream, reader);
  REQUIRE(chunks.size() >= 6);
  const double base =
      error_of(content_of<IndexedMesh>(decoded(std::span(stream).first(header_bytes(stream))).geometry()), rough);
  const double whole = error_of(content_of<IndexedMesh>(decoded(stream).geometry()), rough);
  for (const auto& [share, factor] : {std::pair{0.1, 0.5}, {0.3, 0.8}}) {
    double sum = 0;
    constexpr int kRounds = 6;
    for (std::uint32_t seed = 0; seed < kRounds; ++seed) {
      std::mt19937 random(seed);
      StreamDecoder decoder;
      REQUIRE(decoder.push(std::span(stream).first(header_bytes(stream))));
      for (const auto& [type, payload] : chunks)
        if (random() % 1000 >= share * 1000) decoder.add(type, payload);
      CHECK(decoder.refused_chunks() == 0);
      const IndexedMesh geometry = content_of<IndexedMesh>(decoder.geometry());
      check_sound(geometry);
      sum += error_of(geometry, rough);
    }
    // The error is compared with the error of the base alone.
    INFO("lost " << share << ": " << sum / kRounds << "; whole " << whole << ", base " << base);
    CHECK(sum / kRounds < whole + factor * (base - whole));
  }
  // In a stream of few chunks, a loss affects a large part; finer parts remain beside the lost parts.
  for (const Sample& s : samples()) {
    INFO(s.name);
    StreamReader of;
    const auto few = chunks_of(s.stream, of);
    const double alone = error_of(
        content_of<IndexedMesh>(decoded(std::span(s.stream).first(header_bytes(s.stream))).geometry()), s.triangles);
    for (std::size_t lost = 0; lost < few.size(); lost += watched_step(3)) {
      StreamDecoder decoder;
      REQUIRE(decoder.push(std::span(s.stream).first(header_bytes(s.stream))));
      for (std::size_t i = 0; i < few.size(); ++i)
        if (i != lost) decoder.add(few[i].first, few[i].second);
      CHECK(error_of(content_of<IndexedMesh>(decoder.geometry()), s.triangles) < 1.5 * alone);
    }
  }
}

TEST_CASE("loses at most one chunk of a displaced stream to a flipped bit") {
  const Sample& s = samples()[4];
  const std::size_t head = header_bytes(s.stream);
  const std::size_t whole = decoded(s.stream).vectors();
  for (std::size_t bit = 8 * head; bit < 8 * s.stream.size(); bit += 1 + 36 * watched_step(20)) {
    Bytes damaged = s.stream;
    damaged[bit / 8] ^= static_cast<std::byte>(1 << bit % 8);
    const StreamDecoder decoder = decoded(damaged);
    REQUIRE_EACH(decoder.problems().size() == 1);
    REQUIRE_EACH(decoder.refused_chunks() == 0);
    REQUIRE_EACH(decoder.vectors() <= whole);
    REQUIRE_EACH(decoder.vectors() > 0);
  }
}

TEST_CASE("decodes mutated chunks of a displaced stream to finite numbers or rejects them") {
  std::mt19937 random(12);
  for (const Sample& s : {samples()[2], samples()[4]}) {
    StreamReader reader;
    const auto chunks = chunks_of(s.stream, reader);
    const std::span<const std::byte> head = std::span(s.stream).first(header_bytes(s.stream));
    std::size_t done = 0;
    for (std::size_t round = 0; done < 4'000 / watched_step(4); ++round) {
      StreamDecoder decoder(1 << 20);
      REQUIRE(decoder.push(head));
      for (const auto& [type, payload] : chunks) {
        Bytes mutated = payload;
        for (std::size_t i = 0; i <= round % 4; ++i)
          mutated[random() % std::min<std::size_t>(mutated.size(), round % 3 == 0 ? 5 : 1u << 20)] =
              static_cast<std::byte>(random());
        decoder.add(type, mutated);
        ++done;
      }
      if (round % 8 == 0) check_sound(content_of<IndexedMesh>(decoder.geometry()));
    }
  }
}

TEST_CASE("decodes at most the maximum number of vectors of a displaced stream") {
  const Sample& s = samples()[0];
  for (const std::size_t most : {500, 2000}) {
    StreamDecoder decoder(most);
    REQUIRE(decoder.push(s.stream));
    decoder.finish();
    CHECK(decoder.full());
    CHECK(decoder.vectors() <= most);
    CHECK(decoder.vectors() > most / 8);
    CHECK(decoder.geometry().size() == decoder.vectors());
    CHECK(decoder.refused_chunks() == 0);
  }
}

TEST_CASE("allocates little memory for a few hostile bytes") {
  // The base has many triangles, with 2^26 vertices on the deepest level. A small cluster contains a few of these
  // vertices.
  const Sample& s = samples()[0];
  StreamReader reader;
  (void)chunks_of(s.stream, reader);
  StreamHeader header = *reader.header();
  header.base[0] = std::byte{8};
  StreamDecoder decoder;
  REQUIRE(decoder.push(encode_header(header)));
  for (int level = 1; level <= 8; ++level) {
    ClusterHeader cluster;
    cluster.level = level;
    cluster.count = 1;
    Bytes payload = encode_cluster_header(cluster);
    payload.resize(payload.size() + 200, std::byte{0x91});
    decoder.add(ChunkType::displaced, payload);
  }
  CHECK(decoder.vectors() > 0);
  CHECK(decoder.vectors() <= 65536 + 8 * 1024 * 220);
  check_sound(content_of<IndexedMesh>(decoder.geometry()));
}

TEST_CASE("encodes small and distant surfaces as precisely as others") {
  const Triangles wanted = ball(16);
  const double error = error_of(content_of<IndexedMesh>(decoded(encode(wanted)).geometry()), wanted);
  for (const auto& [scale, away] : {std::pair{1e-12f, 0.0f}, {1e15f, 0.0f}, {1.0f, 512.0f}}) {
    Triangles other = wanted;
    for (Triangle& t : other)
      for (glm::vec3& p : t.positions) p = p * scale + away;
    IndexedMesh geometry = content_of<IndexedMesh>(decoded(encode(other)).geometry());
    check_sound(geometry);
    for (glm::vec3& p : geometry.positions) p = (p - away) / scale;
    CHECK(error_of(geometry, wanted) < error * 1.5 + 3e-5);
  }
}

TEST_CASE("keeps the colours of a few triangles") {
  for (const bool striped : {false, true}) {
    Triangles small = ball(4);
    for (Triangle& t : small)
      for (std::size_t k = 0; k < 3; ++k)
        t.colors[k] = striped && t.positions[k].z > 0 ? Rgb8{20, 220, 40} : Rgb8{230, 20, static_cast<std::uint8_t>(k)};
    const IndexedMesh geometry = content_of<IndexedMesh>(decoded(encode(small)).geometry());
    REQUIRE(geometry.colors.size() == geometry.size());
    for (std::size_t i = 0; i < geometry.size(); ++i) {
      if (std::abs(geometry.positions[i].z) < 0.5f) continue;
      const bool green = striped && geometry.positions[i].z > 0;
      CHECK(std::abs(geometry.colors[i].r - (green ? 20 : 230)) < 24);
      CHECK(std::abs(geometry.colors[i].g - (green ? 220 : 20)) < 24);
    }
  }
}

TEST_CASE("encodes a surface to the same bytes on any number of threads") {
  const Sample& s = samples()[4];
  for (const unsigned threads : {1u, 3u}) {
    EncodeOptions options;
    options.threads = threads;
    const auto made = encode_displaced(source_of(s.triangles), options);
    CHECK(std::get<EncodedStream>(made).bytes == s.stream);
  }
}

TEST_CASE("refuses geometry that is not a surface") {
  CHECK(std::holds_alternative<EncodeError>(encode_displaced(source_of({}), {})));
  const Triangles line{triangle_of({0, 0, 0}, {1, 1, 1}, {1, 1, 1})};
  CHECK(std::holds_alternative<EncodeError>(encode_displaced(source_of(line), {})));
  EncodeOptions options;
  options.only_if_suited = true;
  const auto made = encode_displaced(source_of(random_triangles(3000, 1, 5)), options);
  const auto* error = std::get_if<EncodeError>(&made);
  REQUIRE(error);
  CHECK(error->unsuited);
}

}  // namespace gs::qnv::displaced::stream_test
