#include "qnv/codecs/lossless/cover.h"
#include "qnv/codecs/lossless/low_bits.h"
#include "qnv/codecs/lossless/tail_pieces.h"
#include "qnv/codecs/progressive/progressive.h"
#include "qnv/container/piece_group.h"
#include "qnv/reader/stream_decoder.h"
#include "tests/geometries.h"
#include "tests/qnv/codecs/lossless/exact_shapes.h"
#include "tests/qnv/pinned_vectors.h"
#include "tests/watched.h"

#include <zlib.h>
#include <catch2/catch.hpp>

#include <algorithm>
#include <fstream>
#include <map>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace gs::qnv::exact::vectors_test {

/// Calls `take` with the first word and the other words of each line of a pinned result.
template <class Take>
void each_line(const std::string& name, Take take) {
  std::ifstream in(GHOSTSPACE_TESTS "/qnv/vectors/v1/" + name + ".txt");
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    std::string kind;
    words >> kind;
    take(kind, words);
  }
}

// encode_displaced once wrote tests/qnv/vectors/v1/displaced_exact.qnv, _shaded and _small.
// tests/qnv/vectors/displaced.py, written from FORMAT.md alone, made the .txt files. Never regenerate any.
TEST_CASE("decodes exact tails of version 1 to their pinned meshes") {
  for (const std::string name : {"displaced_exact", "displaced_shaded", "displaced_small"}) {
    INFO(name);
    ExactMesh wanted;
    std::vector<std::pair<std::size_t, glm::vec3>> normals;
    each_line(name, [&](const std::string& kind, std::istringstream& words) {
      if (kind == "exact") {
        words >> wanted.bits >> wanted.crease_angle;
      } else if (kind == "at") {
        glm::ivec3 p(0), c(0);
        words >> p.x >> p.y >> p.z;
        wanted.vertices.push_back(p);
        if (words >> c.x >> c.y >> c.z)
          wanted.colors.push_back(
              {static_cast<std::uint8_t>(c.x), static_cast<std::uint8_t>(c.y), static_cast<std::uint8_t>(c.z)});
      } else if (kind == "face") {
        displaced::Corners t{};
        words >> t[0] >> t[1] >> t[2];
        wanted.triangles.push_back(t);
      } else if (kind == "shading") {
        wanted.shading.rule = Shading::Rule::faces;
        words >> wanted.shading.angle;
      } else if (kind == "normal") {
        auto& [corner, n] = normals.emplace_back();
        words >> corner >> n.x >> n.y >> n.z;
      }
    });
    REQUIRE(wanted.triangles.size() > 500);
    const std::vector<std::byte> stream = read_bytes(name + ".qnv");
    TailPieces pieces;
    PieceGroup group;
    StreamReader reader;
    std::optional<Shading> shading;
    REQUIRE(reader.push(stream, [&](ChunkType type, std::span<const std::byte> payload, std::uint64_t) {
      if (type == ChunkType::exact) CHECK(pieces.add(payload));
      if (type == ChunkType::shading) shading = decode_shading(payload);
      if (type != ChunkType::piece) return;
      const auto piece = read_piece_header(payload);
      REQUIRE(piece);
      CHECK(piece->group == kGroupsOfTails);
      CHECK(group.add(*piece, payload));
      for (const auto& each : group.take()) CHECK(pieces.add(each));
    }));
    const auto tail = pieces.take();
    REQUIRE(tail);
    const auto mesh = decode_tail(*tail, 1 << 16);
    REQUIRE(mesh);
    CHECK(mesh->bits == wanted.bits);
    CHECK(mesh->crease_angle == wanted.crease_angle);
    CHECK(mesh->vertices == wanted.vertices);
    CHECK(mesh->triangles == wanted.triangles);
    REQUIRE(mesh->colors.size() == wanted.colors.size());
    for (std::size_t v = 0; v < mesh->colors.size(); ++v) REQUIRE_EACH(mesh->colors[v] == wanted.colors[v]);
    REQUIRE(shading.has_value() == (name == "displaced_shaded"));
    if (!shading) continue;
    CHECK(*shading == wanted.shading);
    CHECK(normals.size() > 100);
    StreamDecoder decoder;
    REQUIRE(decoder.push(stream));
    const IndexedMesh geometry = content_of<IndexedMesh>(decoder.geometry());
    for (const auto& [corner, n] : normals)
      REQUIRE_EACH(glm::length(geometry.normals[geometry.triangles[corner]] - n) < 1e-4f);
  }
}

// Pinned low bits of displaced_low_bits, a stream with fewer bits in its tail than in its mesh.
TEST_CASE("decodes low bits after a tail to their pinned positions") {
  std::vector<glm::ivec3> wanted;
  std::ifstream in(GHOSTSPACE_TESTS "/qnv/vectors/v1/displaced_low_bits.txt");
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    std::string kind;
    glm::ivec3 p(0);
    if (words >> kind; kind == "at" && words >> p.x >> p.y >> p.z) wanted.push_back(p);
  }
  REQUIRE(wanted.size() > 400);
  const std::vector<std::byte> stream = read_bytes("displaced_low_bits.qnv");
  TailPieces pieces;
  LowBits low_bits;
  StreamReader reader;
  REQUIRE(reader.push(stream, [&](ChunkType type, std::span<const std::byte> payload, std::uint64_t) {
    if (type == ChunkType::exact) CHECK(pieces.add(payload));
    if (type == ChunkType::low_bits) CHECK(low_bits.add(payload));
  }));
  const auto tail = pieces.take();
  REQUIRE(tail);
  auto mesh = decode_tail(*tail, 1 << 16);
  REQUIRE(mesh);
  CHECK(mesh->bits == 11);
  CHECK(low_bits.complete(*mesh));
  low_bits.apply(*mesh);
  CHECK(mesh->bits == 14);
  CHECK(mesh->vertices == wanted);
}

// Pinned ranks and covered patches of displaced_covered, a stream with its tail and low bits in pieces.
TEST_CASE("decodes a tail with ranks and its table of covered patches as pinned") {
  std::vector<glm::ivec3> wanted;
  std::vector<displaced::Corners> faces;
  std::vector<int> covered;
  int stage = -1, parts = 0, bits = 0;
  std::uint32_t triangles = 0;
  each_line("displaced_covered", [&](const std::string& kind, std::istringstream& words) {
    glm::ivec3 p(0);
    displaced::Corners t{};
    if (kind == "exact") words >> bits;
    if (kind == "at" && words >> p.x >> p.y >> p.z) wanted.push_back(p);
    if (kind == "face" && words >> t[0] >> t[1] >> t[2]) faces.push_back(t);
    if (kind == "cover") words >> stage >> parts >> triangles;
    for (int is = 0; kind == "covered" && words >> is;) covered.push_back(is);
  });
  REQUIRE(wanted.size() > 400);
  TailPieces pieces;
  LowBits low_bits;
  std::map<int, PieceGroup> groups;
  std::optional<Cover> cover;
  StreamReader reader;
  REQUIRE(reader.push(read_bytes("displaced_covered.qnv"),
                      [&](ChunkType type, std::span<const std::byte> payload, std::uint64_t) {
                        if (type == ChunkType::cover) cover = decode_cover(payload);
                        const auto piece = type == ChunkType::piece ? read_piece_header(payload) : std::nullopt;
                        if (!piece) return;
                        CHECK(groups[piece->group].add(*piece, payload));
                        for (const auto& each : groups[piece->group].take()) {
                          if (type_of_group(piece->group) == ChunkType::exact) CHECK(pieces.add(each));
                          if (type_of_group(piece->group) == ChunkType::low_bits) CHECK(low_bits.add(each));
                        }
                      }));
  const auto tail = pieces.take();
  REQUIRE(tail);
  auto mesh = decode_tail(*tail, 1 << 16);
  REQUIRE(mesh);
  CHECK(mesh->bits < mesh->finest);
  CHECK(mesh->finest == bits);
  low_bits.apply(*mesh);
  CHECK(mesh->vertices == wanted);
  CHECK(mesh->triangles == faces);
  REQUIRE(cover);
  CHECK(cover->stage == stage);
  CHECK(cover->parts == parts);
  CHECK(cover->triangles == triangles);
  CHECK(triangles == faces.size());
  CHECK(std::ranges::equal(cover->patches, covered));
  CHECK(covered.size() > 300);
}

// Pinned corners of displaced_textured, a stream with texture coordinates, own normals and a texture.
TEST_CASE("decodes a textured tail to its pinned corners, normals and texture files") {
  TextureLattice lattice;
  std::vector<displaced::Corners> faces;
  std::vector<CornerCoordinates> coordinates;
  std::vector<std::pair<std::size_t, glm::vec3>> normals;
  std::vector<std::array<std::uint32_t, 3>> files;  // length, bytes that suffice, checksum
  each_line("displaced_textured", [&](const std::string& kind, std::istringstream& words) {
    if (kind == "texture") {
      words >> lattice.bits >> lattice.lower.x >> lattice.lower.y >> lattice.size.x >> lattice.size.y;
    } else if (kind == "face") {
      displaced::Corners& t = faces.emplace_back();
      words >> t[0] >> t[1] >> t[2];
    } else if (kind == "corners") {
      for (glm::ivec2& q : coordinates.emplace_back()) words >> q.x >> q.y;
    } else if (kind == "own") {
      auto& [corner, n] = normals.emplace_back();
      words >> corner >> n.x >> n.y >> n.z;
    } else if (kind == "file") {
      auto& [length, enough, checksum] = files.emplace_back();
      words >> length >> enough >> checksum;
    }
  });
  REQUIRE(faces.size() > 700);
  REQUIRE(normals.size() > 200);
  REQUIRE(files.size() == 1);
  const std::vector<std::byte> stream = read_bytes("displaced_textured.qnv");
  TailPieces pieces;
  std::map<int, PieceGroup> groups;
  StreamReader reader;
  REQUIRE(reader.push(stream, [&](ChunkType type, std::span<const std::byte> payload, std::uint64_t) {
    const auto piece = type == ChunkType::piece ? read_piece_header(payload) : std::nullopt;
    if (!piece) return;
    CHECK(groups[piece->group].add(*piece, payload));
    for (const auto& each : groups[piece->group].take())
      if (type_of_group(piece->group) == ChunkType::exact) CHECK(pieces.add(each));
  }));
  const auto tail = pieces.take();
  REQUIRE(tail);
  const auto mesh = decode_tail(*tail, 1 << 16);
  REQUIRE(mesh);
  CHECK(mesh->triangles == faces);
  CHECK(mesh->coordinates == coordinates);
  CHECK(mesh->texture.bits == lattice.bits);
  CHECK(mesh->texture.lower == lattice.lower);
  CHECK(mesh->texture.size == lattice.size);
  StreamDecoder decoder;
  REQUIRE(decoder.push(stream));
  CHECK(decoder.mesh().final);
  const IndexedMesh geometry = content_of<IndexedMesh>(decoder.geometry());
  REQUIRE(geometry.triangles.size() == 3 * faces.size());
  REQUIRE(geometry.texture_coordinates.size() == geometry.size());
  for (std::size_t corner = 0; corner < geometry.triangles.size(); ++corner)
    REQUIRE_EACH(geometry.texture_coordinates[geometry.triangles[corner]] ==
                 lattice.at(coordinates[corner / 3][corner % 3]));
  // The expected normals are computed in f32 from the corners of the square, within one step.
  for (const auto& [corner, n] : normals)
    REQUIRE_EACH(glm::length(geometry.normals[geometry.triangles[corner]] - n) < 0.01f);
  REQUIRE(geometry.picture);
  CHECK(geometry.picture->bytes.size() == files[0][0]);
  CHECK(crc32(0, reinterpret_cast<const Bytef*>(geometry.picture->bytes.data()),
              static_cast<uInt>(geometry.picture->bytes.size())) == files[0][2]);
}

// Pinned result of displaced_splits, by tests/qnv/vectors/splits.py.
TEST_CASE("decodes a progressive mesh to its pinned result") {
  ExactMesh wanted;
  each_line("displaced_splits", [&](const std::string& kind, std::istringstream& words) {
    if (kind == "exact") {
      words >> wanted.bits >> wanted.crease_angle;
    } else if (kind == "at") {
      glm::ivec3& p = wanted.vertices.emplace_back(0);
      words >> p.x >> p.y >> p.z;
    } else {
      displaced::Corners& t = wanted.triangles.emplace_back();
      words >> t[0] >> t[1] >> t[2];
    }
  });
  REQUIRE(wanted.triangles.size() > 1000);
  const auto stream = read_bytes("displaced_splits.qnv");
  StreamDecoder decoder;
  REQUIRE(decoder.push(stream));
  CHECK(decoder.refused_chunks() == 0);
  CHECK(decoder.mesh().final);
  progressive::ProgressiveMesh growing;
  REQUIRE(growing.begin(decoder.header()->base, 1 << 16));
  PieceGroups groups;
  StreamReader reader;
  REQUIRE(reader.push(stream, [&](ChunkType type, std::span<const std::byte> payload, std::uint64_t) {
    if (type != ChunkType::piece) return;
    CHECK(groups.add(payload, [&](ChunkType, std::span<const std::byte> each) { CHECK(growing.add(each)); }));
  }));
  const ExactMesh mesh = growing.mesh();
  CHECK(mesh.bits == wanted.bits);
  CHECK(mesh.crease_angle == wanted.crease_angle);
  CHECK(mesh.vertices == wanted.vertices);
  CHECK(mesh.triangles == wanted.triangles);
}

}  // namespace gs::qnv::exact::vectors_test
