// Tests of normals of corners that no shading rule gives.
#include "qnv/codecs/lossless/own_normals.h"
#include "qnv/codecs/displaced/encode/encode_displaced.h"
#include "qnv/codecs/lossless/encode/surface_tail.h"
#include "qnv/container/piece_group.h"
#include "qnv/reader/stream_decoder.h"
#include "tests/geometries.h"
#include "tests/qnv/codecs/lossless/exact_shapes.h"
#include "tests/watched.h"

#include <catch2/catch.hpp>

#include <span>

namespace gs::qnv::exact::own_normals_test {
namespace {

using Bytes = std::vector<std::byte>;
constexpr Shading kSmooth{Shading::Rule::edges, 180};

ExactMesh decoded_mesh(const Triangles& triangles) {
  const auto decoded = decode_tail(encode_tail(mesh_of(triangles, 11, false)), 1 << 20);
  REQUIRE(decoded);
  return *decoded;
}
/// Bends normals by the position of the vertex. `apart` also separates each face.
std::vector<glm::vec3> bent(const ExactMesh& mesh, bool apart) {
  std::vector<glm::vec3> own = shaded_normals(mesh, kSmooth);
  for (std::size_t c = 0; c < own.size(); ++c) {
    const glm::vec3 p = glm::vec3(mesh.vertices[mesh.triangles[c / 3][c % 3]]) / 300.0f;
    own[c] = glm::normalize(own[c] + 0.3f * glm::vec3(std::sin(p.x), std::cos(p.y), std::sin(p.z + p.x)) +
                            (apart ? 0.2f * glm::vec3(static_cast<float>(c / 3 % 5), 0, 1) : glm::vec3(0)));
  }
  return own;
}

}  // namespace

TEST_CASE("restores the normals of a file within their bits, for smooth and sharp vertices") {
  for (const Triangles& shape :
       {displaced::ball(9), displaced::torus(24, 12), box_shape(glm::vec3(-1), glm::vec3(1), 5)})
    for (const bool apart : {false, true})
      for (const int bits : {6, 9, 14}) {
        const ExactMesh mesh = decoded_mesh(shape);
        const std::vector<glm::vec3> shaded = shaded_normals(mesh, kSmooth), own = bent(mesh, apart);
        const Bytes bytes = encode_normals(mesh, shaded, own, bits);
        const auto back = decode_normals(bytes, mesh, shaded);
        REQUIRE(back);
        REQUIRE(back->size() == own.size());
        const float step = 2.0f / static_cast<float>((1 << bits) - 1);
        for (std::size_t c = 0; c < own.size(); ++c) {
          REQUIRE_EACH(glm::length((*back)[c] - own[c]) < 4 * step);
          REQUIRE_EACH(std::abs(glm::length((*back)[c]) - 1) < 1e-5f);
        }
        CHECK(distance_of(*back, own) < 2 * static_cast<double>(step));
      }
}

TEST_CASE("encodes smooth normals once per vertex, in fewer bits than their precision") {
  const ExactMesh mesh = decoded_mesh(displaced::ball(24));
  const std::vector<glm::vec3> shaded = shaded_normals(mesh, kSmooth);
  CHECK(8 * encode_normals(mesh, shaded, bent(mesh, false)).size() < 14 * mesh.vertices.size());
  // Normals that match the shading rule take almost no bits.
  CHECK(8 * encode_normals(mesh, shaded, shaded).size() < mesh.vertices.size());
}

TEST_CASE(
    "rejects truncated normals and normals of another mesh, and decodes mutated ones to unit vectors or rejects them") {
  const ExactMesh mesh = decoded_mesh(displaced::torus(24, 12)), other = decoded_mesh(displaced::ball(6));
  const std::vector<glm::vec3> shaded = shaded_normals(mesh, kSmooth);
  const Bytes bytes = encode_normals(mesh, shaded, bent(mesh, true));
  REQUIRE(decode_normals(bytes, mesh, shaded));
  CHECK(!decode_normals(bytes, other, shaded_normals(other, kSmooth)));
  for (std::size_t length = 0; length + 8 < bytes.size(); length += 13 * watched_step(5))
    REQUIRE_EACH(!decode_normals(std::span(bytes).first(length), mesh, shaded));
  Bytes changed = bytes;
  for (const int bits : {0, 3, 15, 255}) {
    changed[0] = static_cast<std::byte>(bits);
    CHECK(!decode_normals(changed, mesh, shaded));
  }
  std::mt19937 random(4);
  for (std::size_t round = 0; round < 300; round += watched_step(7)) {
    Bytes mutated = bytes;
    const std::size_t from = round % 2 == 0 ? 0 : mutated.size() - 40;
    mutated[from + random() % (mutated.size() - from)] = static_cast<std::byte>(random());
    const auto normals = decode_normals(mutated, mesh, shaded);
    if (!normals) continue;
    for (const glm::vec3& n : *normals) REQUIRE_EACH(std::abs(glm::length(n) - 1) < 1e-5f);
  }
}

TEST_CASE("encodes the normals of a source only if no shading rule gives them") {
  const Triangles plain = displaced::torus(40, 20);
  Triangles own = plain;
  for (Triangle& t : own)
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::vec3 p = t.positions[k];
      t.normals[k] = glm::normalize(p + glm::vec3(std::sin(5 * p.x), 2 * p.y, 0.3f));
    }
  for (const bool bent_ones : {false, true})
    for (const int bits : {kExactWherePays, 12}) {
      const Triangles& triangles = bent_ones ? own : plain;
      const TriangleSource source = [&](const TriangleSink& sink) { return sink(triangles); };
      EncodeOptions options;
      options.exact_bits = bits;
      const auto encoded = encode_displaced(source, options);
      REQUIRE(std::holds_alternative<EncodedStream>(encoded));
      const auto& bytes = std::get<EncodedStream>(encoded).bytes;
      bool told = false;
      StreamReader reader;
      (void)reader.push(bytes, [&](ChunkType type, std::span<const std::byte> payload, std::uint64_t) {
        const auto piece = type == ChunkType::piece ? read_piece_header(payload) : std::nullopt;
        told = told || type == ChunkType::normals || (piece && type_of_group(piece->group) == ChunkType::normals);
      });
      CHECK(told == bent_ones);
      StreamDecoder decoder;
      REQUIRE(decoder.push(bytes));
      CHECK(decoder.refused_chunks() == 0);
      REQUIRE(decoder.mesh().final);
      const IndexedMesh geometry = content_of<IndexedMesh>(decoder.geometry());
      if (!bent_ones) continue;
      // Compares the normals at the first corner of every eleventh triangle.
      double sum = 0, count = 0;
      for (std::size_t t = 0; t < triangles.size(); t += 11) {
        std::size_t nearest = 0;
        for (std::size_t v = 1; v < geometry.size(); ++v)
          if (glm::length(geometry.positions[v] - triangles[t].positions[0]) <
              glm::length(geometry.positions[nearest] - triangles[t].positions[0]))
            nearest = v;
        sum += static_cast<double>(glm::length(geometry.normals[nearest] - triangles[t].normals[0]));
        ++count;
      }
      CHECK(sum / count < 0.02);
    }
}

}  // namespace gs::qnv::exact::own_normals_test
