// Tests of octree streams that end with the exact mesh.
#include "qnv/codecs/octree/encode/encode_surface.h"
#include "qnv/codecs/octree/lod/lod.h"
#include "qnv/codecs/shared/encode_options.h"
#include "qnv/reader/loss.h"
#include "qnv/reader/stream_decoder.h"
#include "tests/geometries.h"
#include "tests/qnv/surface_shapes.h"
#include "tests/watched.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <set>
#include <span>

namespace gs::qnv::octree_mesh_test {
namespace {

/// Returns parts of three colours, some of which touch.
Triangles assembly() {
  Triangles all;
  const std::array<Rgb8, 3> colors{Rgb8{250, 10, 10}, Rgb8{10, 200, 30}, Rgb8{20, 30, 240}};
  for (int i = 0; i < 60; ++i) {
    const glm::vec3 lower(static_cast<float>(i % 8), static_cast<float>(i / 8 % 4) * 1.5f,
                          static_cast<float>(i / 32) * 2);
    Triangles box = box_shape(lower, lower + glm::vec3(1, 0.7f, 1), 2);
    for (Triangle& t : box) t.colors.fill(colors[static_cast<std::size_t>(i % 3)]);
    all.insert(all.end(), box.begin(), box.end());
  }
  return all;
}

EncodedStream encoded(const Triangles& triangles, int bits, std::size_t max_bytes = 0) {
  EncodeOptions options;
  options.exact_bits = bits;
  options.max_bytes = max_bytes;
  auto made = encode_surface([&](const TriangleSink& sink) { return sink(triangles); }, options);
  REQUIRE(std::holds_alternative<EncodedStream>(made));
  return std::get<EncodedStream>(std::move(made));
}

std::size_t triangles_with_area(const Triangles& all) {
  return static_cast<std::size_t>(std::ranges::count_if(all, [](const Triangle& t) { return area_of(t) > 0; }));
}

}  // namespace

TEST_CASE("ends an octree with the mesh if its colours have borders") {
  const Triangles all = assembly();
  for (const int bits : {kExactWherePays, 13}) {
    const EncodedStream stream = encoded(all, bits);
    CHECK(stream.header.payload == Payload::packed);
    CHECK(stream.header.meshed);
    StreamDecoder decoder;
    std::size_t discs = 0;
    bool mesh = false;
    for (std::size_t at = 0; at < stream.bytes.size(); at += 211) {
      (void)decoder.push(std::span(stream.bytes).subspan(at, std::min<std::size_t>(211, stream.bytes.size() - at)));
      if (!decoder.header()) continue;
      const bool is_mesh = decoder.mesh().whole;
      REQUIRE_EACH((is_mesh || !mesh));
      const Geometry geometry = decoder.geometry();
      REQUIRE_EACH((geometry.as<IndexedMesh>() != nullptr) == is_mesh);
      REQUIRE_EACH(geometry.size() == decoder.vectors());
      if (!is_mesh) {
        REQUIRE_EACH(geometry.size() >= discs);
        discs = geometry.size();
      }
      mesh = is_mesh;
    }
    decoder.finish();
    CHECK(discs > 100);
    CHECK(decoder.mesh().final);
    CHECK(decoder.refused_chunks() == 0);
    const IndexedMesh geometry = content_of<IndexedMesh>(decoder.geometry());
    CHECK(geometry.triangles.size() == 3 * triangles_with_area(all));
    std::set<std::array<int, 3>> colors;
    for (const Rgb8& c : geometry.colors) colors.insert({c.r, c.g, c.b});
    CHECK(colors == std::set<std::array<int, 3>>{{250, 10, 10}, {10, 200, 30}, {20, 30, 240}});
  }
}

TEST_CASE("encodes an octree without a mesh unchanged") {
  const EncodedStream stream = encoded(assembly(), 0);
  CHECK(!stream.header.meshed);
  StreamReader reader;
  (void)reader.push(stream.bytes, [](ChunkType type, std::span<const std::byte>, std::uint64_t) {
    CHECK((type == ChunkType::packed || type == ChunkType::directory));
  });
  CHECK(std::holds_alternative<std::unique_ptr<LodStream>>(LodStream::open(std::vector(stream.bytes))));
}

TEST_CASE("refuses to open a stream with a mesh at its end by levels") {
  const EncodedStream stream = encoded(assembly(), kExactWherePays);
  const auto opened = LodStream::open(std::vector(stream.bytes));
  REQUIRE(std::holds_alternative<StreamProblem>(opened));
  CHECK(std::get<StreamProblem>(opened).message.find("mesh") != std::string::npos);
}

TEST_CASE("omits the mesh if it exceeds the requested bytes") {
  const std::size_t most = encoded(assembly(), kExactWherePays).bytes.size() / 4;
  const EncodedStream stream = encoded(assembly(), kExactWherePays, most);
  CHECK(!stream.header.meshed);
  CHECK(stream.bytes.size() <= most);
}

TEST_CASE("usually restores the mesh of an octree after the loss of a third of its packets") {
  const Triangles all = assembly();
  const EncodedStream stream = encoded(all, kExactWherePays);
  std::size_t whole = 0;
  constexpr std::uint64_t kSeeds = 12;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    StreamDecoder decoder;
    REQUIRE(decoder.push(drop_packets(stream.bytes, 0.3, seed)));
    whole += decoder.mesh().final ? 1 : 0;
    CHECK(decoder.geometry().size() > 0);
  }
  CHECK(whole >= kSeeds / 2);
}

}  // namespace gs::qnv::octree_mesh_test
