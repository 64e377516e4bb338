// Tests of texture coordinates of exact tails, and of their textures.
#include "qnv/codecs/displaced/encode/encode_displaced.h"
#include "qnv/codecs/lossless/corner_growth.h"
#include "qnv/codecs/lossless/decode/tail_reader.h"
#include "qnv/codecs/lossless/encode/surface_tail.h"
#include "qnv/codecs/lossless/picture.h"
#include "qnv/reader/stream_decoder.h"
#include "tests/geometries.h"
#include "tests/qnv/codecs/lossless/exact_shapes.h"
#include "tests/watched.h"

#include <catch2/catch.hpp>

#include <functional>
#include <span>

namespace gs::qnv::exact::corner_test {
namespace {

using Bytes = std::vector<std::byte>;
constexpr std::size_t kMax = std::size_t{1} << 20;

/// Maps a point of a triangle to its texture coordinate.
using Mapped = std::function<glm::vec2(const glm::vec3& place, const Triangle& of)>;

TexturedSurface textured(const Triangles& triangles, const Mapped& mapped) {
  TexturedSurface surface;
  surface.triangles = triangles;
  for (const Triangle& t : triangles) {
    auto& at = surface.coordinates.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) at[k] = mapped(t.positions[k], t);
  }
  surface.width = surface.height = 64;
  surface.picture.push_back({Bytes(400, std::byte{7}), 100});
  return surface;
}
glm::vec2 from_above(const glm::vec3& p, const Triangle&) { return {p.x, p.y}; }
/// Maps to six charts side by side, with a seam wherever the direction of faces changes.
glm::vec2 boxed(const glm::vec3& p, const Triangle& of) {
  const glm::vec3 n = glm::cross(of.positions[1] - of.positions[0], of.positions[2] - of.positions[0]);
  int axis = 0;
  for (int k = 1; k < 3; ++k)
    if (std::abs(n[k]) > std::abs(n[axis])) axis = k;
  const float chart = static_cast<float>(axis + (n[axis] < 0 ? 3 : 0));
  return {chart * 4 + p[(axis + 1) % 3], n[axis] < 0 ? -p[(axis + 2) % 3] : p[(axis + 2) % 3]};
}
Mapped at_random(std::uint32_t seed) {
  auto random = std::make_shared<std::mt19937>(seed);
  return [random](const glm::vec3&, const Triangle&) {
    return glm::vec2(static_cast<float>((*random)() % 1000), static_cast<float>((*random)() % 1000));
  };
}

/// Triangle with texture coordinates, starting at its smallest corner.
using Dressed = std::array<std::array<int, 5>, 3>;
std::vector<Dressed> dressed(const ExactMesh& mesh) {
  std::vector<Dressed> all;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    Dressed corners{};
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::ivec3 p = mesh.vertices.at(mesh.triangles[t][k]);
      const glm::ivec2 q = mesh.coordinates.at(t)[k];
      corners[k] = {p.x, p.y, p.z, q.x, q.y};
    }
    std::rotate(corners.begin(), std::ranges::min_element(corners), corners.end());
    Dressed least = corners;  // two corners may be equal, so all rotations are compared
    for (int k = 0; k < 2; ++k) {
      std::rotate(corners.begin(), corners.begin() + 1, corners.end());
      least = std::min(least, corners);
    }
    all.push_back(least);
  }
  std::ranges::sort(all);
  return all;
}

ExactMesh mesh_with(const TexturedSurface& surface, int bits) {
  return exact_mesh_of(surface, displaced::Frame(box_of(surface.triangles)), bits);
}

}  // namespace

TEST_CASE("restores the texture coordinates of every corner of a mesh") {
  std::vector<Source> sources = smooth_sources();
  for (Source& s : nasty_sources()) sources.push_back(std::move(s));
  for (const Source& s : sources)
    for (const Mapped& mapped : {Mapped(from_above), Mapped(boxed), at_random(5)}) {
      INFO(s.name);
      const ExactMesh mesh = mesh_with(textured(s.triangles, mapped), 11);
      REQUIRE(mesh.coordinates.size() == mesh.triangles.size());
      const Bytes tail = encode_tail(mesh);
      const auto decoded = decode_tail(tail, kMax);
      REQUIRE(decoded);
      CHECK(dressed(*decoded) == dressed(mesh));
      CHECK(decoded->texture.bits == mesh.texture.bits);
      CHECK(decoded->texture.lower == mesh.texture.lower);
      CHECK(decoded->texture.size == mesh.texture.size);
    }
}

TEST_CASE("encodes smooth texture coordinates in about as many bits as their error in pixels") {
  const Triangles ball = displaced::ball(24);
  const ExactMesh mesh = mesh_with(textured(ball, from_above), 11);
  ExactMesh plain = mesh;
  plain.coordinates.clear();
  const std::size_t more = encode_tail(mesh).size() - encode_tail(plain).size();
  CHECK(8 * more < 6 * mesh.vertices.size());
}

TEST_CASE("predicts a corner from the triangle across the edge and exactly in a plane") {
  const auto at = [](const glm::ivec3& p) { return glm::ivec2(1000 + 7 * p.x - 3 * p.y, 2000 + 2 * p.x + 9 * p.y); };
  const glm::ivec3 from(40, 10, 0), to(90, 60, 0), beyond(120, 5, 0), corner(15, 80, 0);
  const ExpectedCorner expected{to - from, corner - from, at(from), at(to) - at(from)};
  const glm::ivec2 off = expected.folded(beyond - from, at(beyond)) - at(corner);  // both sides are rounded
  CHECK(std::max(std::abs(off.x), std::abs(off.y)) <= 1);
  // Unfolds an upright triangle into the plane.
  const glm::ivec3 along(100, 0, 0), up(30, 0, 50), down(30, -50, 0);
  const ExpectedCorner folded{along, up, {0, 0}, {200, 0}};
  CHECK(folded.folded(down, {60, -100}) == glm::ivec2(60, 100));
  CHECK(folded.turned(1) == glm::ivec2(60, 100));
  CHECK(folded.turned(-1) == glm::ivec2(60, -100));
  const ExpectedCorner nothing{{0, 0, 0}, {4, 5, 6}, {3, 4}, {0, 0}};
  CHECK(nothing.folded({1, 1, 1}, {9, 9}) == glm::ivec2(3, 4));
  CHECK(nothing.turned(1) == glm::ivec2(3, 4));
}

TEST_CASE("computes integer roots rounded down") {
  std::mt19937_64 random(1);
  for (int i = 0; i < 2000; ++i) {
    const auto x = static_cast<std::int64_t>(random() >> (2 + random() % 61));
    const auto root = static_cast<std::uint64_t>(root_of(x));
    REQUIRE_EACH(root * root <= static_cast<std::uint64_t>(x));
    REQUIRE_EACH((root + 1) * (root + 1) > static_cast<std::uint64_t>(x));
  }
  CHECK(root_of(0) == 0);
}

TEST_CASE("decodes a tail with texture coordinates byte by byte as at once") {
  const ExactMesh mesh = mesh_with(textured(displaced::torus(20, 12), boxed), 10);
  const Bytes tail = encode_tail(mesh);
  const auto whole = decode_tail(tail, kMax);
  REQUIRE(whole);
  TailReader reader(tail.size(), kMax);
  std::size_t before = 0, steps = 0;
  for (std::size_t at = 0; at < tail.size(); ++at) {
    reader.push(std::span(tail).subspan(at, 1));
    if (reader.triangles() == before) continue;
    before = reader.triangles();
    const ExactMesh part = reader.mesh();
    REQUIRE_EACH(part.coordinates.size() == part.triangles.size());
    REQUIRE_EACH(std::equal(part.coordinates.begin(), part.coordinates.end(), whole->coordinates.begin()));
    ++steps;
  }
  CHECK(steps > 5);
  CHECK(reader.state() == TailReader::State::whole);
}

TEST_CASE("decodes mutated tails with texture coordinates to a mesh or rejects them") {
  std::mt19937 random(11);
  for (const Mapped& mapped : {Mapped(boxed), at_random(2)}) {
    const Bytes tail = encode_tail(mesh_with(textured(displaced::ball(7), mapped), 10));
    for (std::size_t round = 0; round < 400; round += watched_step(7)) {
      Bytes mutated = tail;
      const std::size_t from = round % 3 == 0 ? 0 : 28;  // changes the header in a third of the rounds
      for (std::size_t i = 0; i <= round % 4; ++i)
        mutated[from + random() % (mutated.size() - from)] = static_cast<std::byte>(random());
      const auto decoded = decode_tail(mutated, kMax);
      if (!decoded || decoded->coordinates.empty()) continue;
      REQUIRE_EACH(decoded->coordinates.size() == decoded->triangles.size());
      for (const CornerCoordinates& corners : decoded->coordinates)
        for (const glm::ivec2& q : corners)
          for (int axis = 0; axis < 2; ++axis) REQUIRE_EACH((q[axis] >= 0 && q[axis] <= decoded->texture.top()));
    }
    for (std::size_t length = 0; length + 8 < tail.size(); length += 5 * watched_step(3))
      REQUIRE_EACH(!decode_tail(std::span(tail).first(length), kMax));
  }
}

TEST_CASE("keeps the lattice of texture coordinates finite") {
  const Bytes tail = encode_tail(mesh_with(textured(displaced::ball(4), from_above), 11));
  REQUIRE(decode_tail(tail, kMax));
  const auto with = [&](std::size_t at, std::initializer_list<int> values) {
    Bytes changed = tail;
    for (const int value : values) changed[at++] = static_cast<std::byte>(value);
    return changed;
  };
  CHECK(!decode_tail(with(11, {0}), kMax));  // bits
  CHECK(!decode_tail(with(11, {17}), kMax));
  CHECK(!decode_tail(with(12, {0, 0, 0x80, 0x7f}), kMax));  // infinite
  CHECK(!decode_tail(with(12, {0, 0, 0xc0, 0x7f}), kMax));  // no number
  CHECK(!decode_tail(with(20, {0, 0, 0x80, 0xbf}), kMax));  // a step of -1
  CHECK(!decode_tail(with(24, {0xff, 0xff, 0x7f, 0xff}), kMax));
}

TEST_CASE("shows a texture once enough of one of its files is received, in any order of pieces") {
  TailPicture picture;
  picture.repeat_t = false;
  for (const std::size_t size : {std::size_t{300}, std::size_t{2000}}) {
    PictureFile& file = picture.files.emplace_back();
    for (std::size_t i = 0; i < size; ++i) file.bytes.push_back(static_cast<std::byte>(i * size % 251));
    file.enough = size / 2;
  }
  const Bytes all = encode_picture(picture);
  CHECK(bytes_until_shown(picture, 0) == 2 + 2 * 8 + 150);
  CHECK(bytes_until_shown(picture, 1) == 2 + 2 * 8 + 300 + 1000);
  const auto pieces = pieces_of(all, 64);
  PictureReader reader;
  std::size_t come = 0;
  for (const Bytes& piece : pieces) {
    CHECK(reader.enough() == (come >= bytes_until_shown(picture, 0)));
    const auto shown = reader.picture();
    CHECK((shown != nullptr) == reader.enough());
    if (shown) {
      const bool fine = come >= bytes_until_shown(picture, 1);
      const Bytes& file = picture.files[fine ? 1 : 0].bytes;
      REQUIRE(shown->bytes.size() <= file.size());
      CHECK(std::equal(shown->bytes.begin(), shown->bytes.end(), file.begin()));
      CHECK(shown->repeat_s);
      CHECK(!shown->repeat_t);
      CHECK(!shown->whole);
    }
    CHECK(reader.add(piece));
    CHECK(reader.add(piece));  // repeated
    come = std::min(come + 64, all.size());
  }
  REQUIRE(reader.whole());
  CHECK(reader.picture()->whole);
  CHECK(reader.picture()->bytes == picture.files[1].bytes);
  PictureReader backwards;
  for (auto piece = pieces.rbegin(); piece != pieces.rend(); ++piece) {
    CHECK(!backwards.picture());
    CHECK(backwards.add(*piece));
  }
  CHECK(backwards.picture()->bytes == picture.files[1].bytes);
}

TEST_CASE("shows nothing for textures that promise missing data") {
  const auto read = [](const Bytes& bytes) {
    PictureReader reader;
    for (const Bytes& piece : pieces_of(bytes, 50)) (void)reader.add(piece);
    return reader.picture();
  };
  CHECK(!read({std::byte{3}}));
  CHECK(!read({std::byte{3}, std::byte{0}, std::byte{1}}));                              // no file
  CHECK(!read(Bytes(40, std::byte{0xff})));                                              // 255 files
  CHECK(!read({std::byte{3}, std::byte{1}, std::byte{9}, std::byte{0}, std::byte{0}}));  // cut off
  std::mt19937 random(9);
  for (std::size_t round = 0; round < 300; ++round) {
    Bytes bytes(1 + random() % 80);
    for (std::byte& b : bytes) b = static_cast<std::byte>(random() % (round % 2 == 0 ? 256 : 12));
    if (const auto picture = read(bytes)) REQUIRE_EACH(picture->bytes.size() <= bytes.size());
  }
}

EncodedStream encoded_with(const TexturedSurface& surface, int bits) {
  EncodeOptions options;
  options.textured = &surface;
  options.exact_bits = bits;
  auto encoded = encode_displaced([&](const TriangleSink& sink) { return sink(surface.triangles); }, options);
  REQUIRE(std::holds_alternative<EncodedStream>(encoded));
  return std::move(std::get<EncodedStream>(encoded));
}

TEST_CASE("ends a textured surface with its mesh and texture, in any order of its chunks") {
  const Triangles torus = displaced::torus(60, 30);
  const TexturedSurface surface = textured(torus, boxed);
  for (const int bits : {kExactWherePays, 12}) {
    const EncodedStream encoded = encoded_with(surface, bits);
    const EncodedStream* const stream = &encoded;
    bool partly = false;
    std::uint64_t revision = 0;
    StreamDecoder decoder;
    for (std::size_t at = 0; at < stream->bytes.size(); at += 97) {
      (void)decoder.push(std::span(stream->bytes).subspan(at, std::min<std::size_t>(97, stream->bytes.size() - at)));
      if (decoder.revision() == revision) continue;
      revision = decoder.revision();
      const IndexedMesh geometry = content_of<IndexedMesh>(decoder.geometry());
      REQUIRE_EACH((geometry.colors.empty() || geometry.colors.size() == geometry.positions.size()));
      REQUIRE_EACH(geometry.texture_coordinates.size() <= geometry.positions.size());
      if (geometry.texture_coordinates.empty()) continue;
      // The textured part is shown last, and only together with the texture.
      REQUIRE_EACH(geometry.picture);
      partly = partly || geometry.first_textured() > 0;
      bool pictured = false;
      for (std::size_t i = 0; i < geometry.triangles.size(); i += 3) {
        const bool now = geometry.triangles[i] >= geometry.first_textured();
        for (std::size_t k = 1; k < 3; ++k)
          REQUIRE_EACH((geometry.triangles[i + k] >= geometry.first_textured()) == now);
        REQUIRE_EACH((now || !pictured));
        pictured = now;
      }
    }
    decoder.finish();
    CHECK(decoder.mesh().final);
    CHECK(decoder.refused_chunks() == 0);
    const IndexedMesh geometry = content_of<IndexedMesh>(decoder.geometry());
    CHECK(geometry.first_textured() == 0);
    CHECK(geometry.triangles.size() == 3 * torus.size());
    REQUIRE(geometry.picture);
    CHECK(geometry.picture->bytes == surface.picture[0].bytes);
    CHECK(partly);
    // The mesh contains each corner of the source, at its texture coordinate.
    float furthest = 0;
    for (std::size_t t = 0; t < torus.size(); t += 71)
      for (std::size_t k = 0; k < 3; ++k) {
        float nearest = 1e9f;
        for (std::size_t v = 0; v < geometry.size(); ++v)
          nearest = std::min(nearest, glm::length(geometry.positions[v] - torus[t].positions[k]) +
                                          glm::length(geometry.texture_coordinates[v] - surface.coordinates[t][k]));
        furthest = std::max(furthest, nearest);
      }
    CHECK(furthest < 0.1f);
    (void)partly;
  }
}

TEST_CASE("hides a textured mesh until its texture is received") {
  const EncodedStream encoded = encoded_with(textured(displaced::torus(24, 12), boxed), 12);
  StreamDecoder decoder;
  std::vector<Bytes> pictures;
  StreamReader reader;
  const auto& bytes = encoded.bytes;
  bool begun = false;
  (void)reader.push(bytes, [&](ChunkType type, std::span<const std::byte> payload, std::uint64_t at) {
    if (!std::exchange(begun, true)) (void)decoder.push(std::span(bytes).first(at));
    if (type == ChunkType::picture)
      pictures.emplace_back(payload.begin(), payload.end());
    else
      decoder.add(type, payload);
  });
  REQUIRE(!pictures.empty());
  CHECK(!decoder.mesh().final);
  CHECK(content_of<IndexedMesh>(decoder.geometry()).texture_coordinates.empty());
  CHECK(decoder.geometry().size() > 0);
  for (const Bytes& payload : pictures) decoder.add(ChunkType::picture, payload);
  CHECK(decoder.mesh().final);
  CHECK(content_of<IndexedMesh>(decoder.geometry()).first_textured() == 0);
}

}  // namespace gs::qnv::exact::corner_test
