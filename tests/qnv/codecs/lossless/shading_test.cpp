#include "qnv/codecs/lossless/shading.h"
#include "qnv/codecs/displaced/encode/encode_displaced.h"
#include "qnv/reader/stream_decoder.h"
#include "tests/geometries.h"
#include "tests/qnv/codecs/lossless/exact_shapes.h"
#include "tests/watched.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <variant>
#include <vector>

namespace gs::qnv::exact::shading_test {
namespace {

using displaced::Corners;
using displaced::SurfaceMesh;
using Bytes = std::vector<std::byte>;

std::vector<glm::vec3> faces_of(const SurfaceMesh& mesh) {
  std::vector<glm::vec3> faces;
  for (const Corners& t : mesh.triangles) {
    const glm::vec3 a = mesh.positions[t[0]];
    faces.push_back(glm::cross(mesh.positions[t[1]] - a, mesh.positions[t[2]] - a));
  }
  return faces;
}

std::vector<glm::vec3> shaded(const SurfaceMesh& mesh, const Shading& shading) {
  const auto twins = twins_of(mesh.triangles);
  const auto faces = faces_of(mesh);
  return corner_normals({mesh.triangles, twins, faces, mesh.positions.size()}, shading);
}

/// Returns a bent strip: triangles around an apex, each 40 degrees from the next.
SurfaceMesh bent() {
  SurfaceMesh mesh;
  mesh.positions.emplace_back(0.0f);
  for (int i = 0; i < 4; ++i) {
    // The strip continues across x, and is edge on along y.
    const float turned = static_cast<float>(i) * 40 * std::numbers::pi_v<float> / 180;
    mesh.positions.emplace_back(1.0f, std::cos(turned), std::sin(turned));
  }
  for (std::uint32_t i = 1; i < 4; ++i) mesh.triangles.push_back({0, i, i + 1});
  return mesh;
}

float angle_between(const glm::vec3& a, const glm::vec3& b) {
  return std::acos(std::clamp(glm::dot(glm::normalize(a), glm::normalize(b)), -1.0f, 1.0f)) * 180 /
         std::numbers::pi_v<float>;
}

bool near(const glm::vec3& a, const glm::vec3& b) { return glm::length(a - b) < 1e-5f; }

/// Returns a sheet with creases at some rough edges, shaded by a rule.
Triangles rough(const Shading& shading) {
  Triangles triangles = displaced::sheet(24);
  for (Triangle& t : triangles)
    for (glm::vec3& p : t.positions) p.z += 0.05f * std::sin(37 * p.x + 11 * p.y) * std::cos(29 * p.y - 5 * p.x);
  const SurfaceMesh mesh = displaced::mesh_of(triangles);
  const std::vector<glm::vec3> normals = shaded(mesh, shading);
  Triangles out;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    Triangle made;
    for (std::size_t k = 0; k < 3; ++k) {
      made.positions[k] = mesh.positions[mesh.triangles[t][k]];
      made.normals[k] = normals[3 * t + k];
    }
    out.push_back(made);
  }
  return out;
}

struct ShadedStream {
  Bytes head;
  std::vector<std::pair<ChunkType, Bytes>> chunks;
  std::size_t shadings = 0;
};

ShadedStream stream_of(const Triangles& triangles) {
  EncodeOptions options;
  options.exact_bits = 14;
  const Bytes bytes = std::get<EncodedStream>(encode_displaced(source_of(triangles), options)).bytes;
  ShadedStream stream;
  std::size_t header = 0;
  bool more = false;
  (void)decode_header(bytes, header, more);
  stream.head.assign(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(header));
  StreamReader reader;
  (void)reader.push(bytes, [&](ChunkType type, std::span<const std::byte> payload, std::uint64_t) {
    stream.chunks.emplace_back(type, Bytes(payload.begin(), payload.end()));
    stream.shadings += type == ChunkType::shading ? 1 : 0;
  });
  return stream;
}

IndexedMesh shown(const ShadedStream& stream, bool with_shading) {
  StreamDecoder decoder;
  (void)decoder.push(stream.head);
  for (const auto& [type, payload] : stream.chunks)
    if (with_shading || type != ChunkType::shading) decoder.add(type, payload);
  CHECK(decoder.refused_chunks() == 0);
  CHECK(decoder.mesh().whole);
  IndexedMesh geometry = content_of<IndexedMesh>(decoder.geometry());
  CHECK(geometry.size() == decoder.vectors());
  return geometry;
}

/// Returns the mean angle in degrees between a geometry's normals and those of the source's corners at that position
/// and face.
double off(const IndexedMesh& geometry, const Triangles& source) {
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < geometry.triangles.size(); ++i) {
    const glm::vec3 place = geometry.positions[geometry.triangles[i]];
    const std::size_t first = i - i % 3;
    glm::vec3 middle(0);
    for (std::size_t k = 0; k < 3; ++k) middle += geometry.positions[geometry.triangles[first + k]] / 3.0f;
    float best = 1e9f, angle = 0;
    for (const Triangle& t : source) {
      const glm::vec3 away = (t.positions[0] + t.positions[1] + t.positions[2]) / 3.0f - middle;
      if (glm::dot(away, away) > 1e-6f) continue;
      for (std::size_t k = 0; k < 3; ++k)
        if (const float d = glm::length(t.positions[k] - place); d < best) {
          best = d;
          angle = angle_between(t.normals[k], geometry.normals[geometry.triangles[i]]);
        }
    }
    sum += static_cast<double>(angle);
    ++count;
  }
  return sum / static_cast<double>(count);
}

}  // namespace

TEST_CASE("shades corners by faces of similar direction and by faces that edges connect") {
  const SurfaceMesh mesh = bent();
  const std::vector<glm::vec3> faces = faces_of(mesh);
  const float one = angle_between(faces[0], faces[1]), two = angle_between(faces[0], faces[2]);
  REQUIRE(one < two);
  const int between = static_cast<int>((std::max(one, angle_between(faces[1], faces[2])) + two) / 2);
  const glm::vec3 all = glm::normalize(faces[0] + faces[1] + faces[2]);
  // VRML97 6.23, creaseAngle: the first and the last face differ by more than the angle.
  const auto by_faces = shaded(mesh, {Shading::Rule::faces, between});
  CHECK(near(by_faces[0], glm::normalize(faces[0] + faces[1])));
  CHECK(near(by_faces[3], all));
  CHECK(near(by_faces[6], glm::normalize(faces[1] + faces[2])));
  // The second vertex has only one face.
  CHECK(near(by_faces[1], glm::normalize(faces[0])));
  for (const std::size_t corner : {0u, 3u, 6u}) CHECK(near(shaded(mesh, {Shading::Rule::edges, between})[corner], all));
  for (const auto rule : {Shading::Rule::edges, Shading::Rule::faces}) {
    CHECK(near(shaded(mesh, {rule, 180})[0], all));
    CHECK(near(shaded(mesh, {rule, 0})[0], glm::normalize(faces[0])));
  }
  // The faces around a face without area determine its shading.
  SurfaceMesh flat = mesh;
  flat.positions[2] = flat.positions[1];
  const auto faces_of_flat = faces_of(flat);
  CHECK(near(shaded(flat, {Shading::Rule::faces, 10})[0], glm::normalize(faces_of_flat[1] + faces_of_flat[2])));
}

TEST_CASE("shades a vertex of very many faces in linear time") {
  SurfaceMesh fan;
  constexpr std::uint32_t kFaces = 200'000;
  fan.positions.emplace_back(0.0f, 0.0f, 0.3f);
  for (std::uint32_t i = 0; i < kFaces; ++i) {
    const double a = 2 * std::numbers::pi * i / kFaces;
    fan.positions.emplace_back(std::cos(a), std::sin(a), 0.0);
  }
  for (std::uint32_t i = 0; i < kFaces; ++i) fan.triangles.push_back({0, 1 + i, 1 + (i + 1) % kFaces});
  const auto normals = shaded(fan, {Shading::Rule::faces, 20});
  CHECK(near(normals[0], {0, 0, 1}));
}

TEST_CASE("finds the shading rule of a mesh") {
  for (const int angle : {30, 60, 72}) {
    displaced::MeshBuilder builder(false);
    builder.add(rough({Shading::Rule::faces, angle}));
    const SurfaceMesh mesh = builder.finish();
    REQUIRE(!mesh.normals.empty());
    const Shading found = shading_of(mesh, 45);
    CHECK(found.rule == Shading::Rule::faces);
    CHECK(std::abs(found.angle - angle) <= 2);
  }
  displaced::MeshBuilder builder(false);
  builder.add(rough({Shading::Rule::edges, 40}));
  CHECK(shading_of(builder.finish(), 40) == Shading{Shading::Rule::edges, 40});
}

TEST_CASE("shades an exact stream as its source, whenever the shading chunk is received") {
  const Triangles source = rough({Shading::Rule::faces, 60});
  ShadedStream stream = stream_of(source);
  REQUIRE(stream.shadings == 1);
  const IndexedMesh wanted = shown(stream, true);
  const IndexedMesh without = shown(stream, false);
  CHECK(off(wanted, source) < 1.5);
  CHECK(off(without, source) > 2 * off(wanted, source));
  CHECK(wanted.triangles.size() == without.triangles.size());
  std::stable_partition(stream.chunks.begin(), stream.chunks.end(),
                        [](const auto& chunk) { return chunk.first != ChunkType::shading; });
  const IndexedMesh late = shown(stream, true);
  CHECK(late.positions == wanted.positions);
  CHECK(late.normals == wanted.normals);
  CHECK(late.triangles == wanted.triangles);
  // A smooth mesh needs no shading chunk.
  CHECK(stream_of(displaced::ball(12)).shadings == 0);
}

TEST_CASE("refuses an invalid shading chunk") {
  CHECK(decode_shading(encode_shading({Shading::Rule::faces, 60})) == Shading{Shading::Rule::faces, 60});
  for (const Bytes& bytes :
       {Bytes{}, Bytes{std::byte{1}}, Bytes{std::byte{0}, std::byte{60}}, Bytes{std::byte{2}, std::byte{60}},
        Bytes{std::byte{1}, std::byte{181}}, Bytes{std::byte{1}, std::byte{60}, std::byte{0}}})
    CHECK(!decode_shading(bytes));
  const ShadedStream stream = stream_of(rough({Shading::Rule::faces, 60}));
  StreamDecoder decoder;
  (void)decoder.push(stream.head);
  for (const auto& [type, payload] : stream.chunks) decoder.add(type, payload);
  const IndexedMesh before = content_of<IndexedMesh>(decoder.geometry());
  decoder.add(ChunkType::shading, encode_shading({Shading::Rule::faces, 5}));  // contradicts the first
  CHECK(decoder.refused_chunks() == 1);
  CHECK(content_of<IndexedMesh>(decoder.geometry()).normals == before.normals);
}

}  // namespace gs::qnv::exact::shading_test
