#include "qnv/codecs/octree/encode/encode_surface.h"
#include "qnv/codecs/octree/packed.h"
#include "qnv/codecs/shared/encode_options.h"

#include "qnv/reader/stream_decoder.h"
#include "tests/geometries.h"
#include "tests/qnv/surface_shapes.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <cstdint>
#include <limits>
#include <set>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace gs::qnv {
namespace {

Splats decoded(const EncodedStream& stream) {
  StreamDecoder decoder;
  REQUIRE(decoder.push(stream.bytes));
  decoder.finish();
  CHECK(decoder.problems().empty());
  CHECK(decoder.refused_chunks() == 0);
  CHECK(decoder.vectors() == decoder.geometry().size());
  return content_of<Splats>(decoder.geometry());
}

std::string error_of(const TriangleSource& source, const EncodeOptions& options = {}, Progress* progress = nullptr) {
  const auto result = encode_surface(source, options, progress);
  const auto* error = std::get_if<EncodeError>(&result);
  return error ? error->message : "";
}

TEST_CASE("describes its surface in the header of a stream") {
  const Triangles ball = sphere(40, 2, {1, 2, 3});
  EncodeOptions options;
  options.vectors = 5000;
  options.two_sided = true;
  options.metadata = {{"title", "Ball"}};
  const EncodedStream stream = encoded(ball, options);
  const Description& d = stream.header.description;
  CHECK(stream.header.kind == Kind::surface);
  CHECK(d.box == box_of(ball));
  CHECK(d.total == Approx(area_of(ball)));
  CHECK_FALSE(d.two_sided);  // the surface is closed, so its inside is invisible
  CHECK(d.metadata == options.metadata);
  CHECK_FALSE(stream.header.colored);
  StreamDecoder decoder;
  REQUIRE(decoder.push(stream.bytes));
  REQUIRE(decoder.header() != nullptr);
  CHECK(encode_header(*decoder.header()) == encode_header(stream.header));
  CHECK(decoder.directory().size() == stream.header.chunks);
  CHECK(decoder.vectors() == stream.header.vectors);
  Triangles open(ball.begin(), ball.begin() + static_cast<std::ptrdiff_t>(ball.size() / 2));
  CHECK(encoded(open, options).header.description.two_sided);
}

TEST_CASE("encodes about the requested number of vectors, with the area of the surface") {
  const Triangles ball = sphere(100);
  for (const std::size_t vectors : {500u, 2000u, 10000u, 40000u}) {
    EncodeOptions options;
    options.vectors = vectors;
    const Splats geometry = decoded(encoded(ball, options));
    INFO(vectors << " asked for, " << geometry.size() << " came");
    CHECK(geometry.size() >= vectors * 9 / 10);
    CHECK(geometry.size() <= vectors + 5000);
    CHECK(total_weight(geometry) == Approx(area_of(ball)).epsilon(0.05));
  }
}

TEST_CASE("encodes the same bytes on any number of threads") {
  Triangles many = random_triangles(500, 1, 23);
  const Triangles ball = sphere(60, 1, {}, true);
  many.insert(many.end(), ball.begin(), ball.end());
  for (const auto& encode : {encode_surface, encode_surface_records}) {
    EncodeOptions options;
    options.vectors = 15000;
    const auto bytes = [&](unsigned threads) {
      options.threads = threads;
      return std::get<EncodedStream>(encode(source_of(many), options, nullptr)).bytes;
    };
    const std::vector<std::byte> expected = bytes(1);
    for (const unsigned threads : {2u, 5u}) CHECK(bytes(threads) == expected);
  }
}

TEST_CASE("never exceeds the requested length of a stream", "[optimised]") {
  const Triangles ball = sphere(70, 1, {}, true);
  double last = 0;
  for (const std::size_t most : {300u, 500u, 700u, 900u, 1200u, 1900u, 3000u, 5000u, 9001u, 20000u, 60000u, 150000u}) {
    EncodeOptions options;
    options.max_bytes = most;
    const EncodedStream stream = encoded(ball, options);
    INFO(most << " asked for, " << stream.bytes.size() << " came");
    CHECK(stream.bytes.size() <= most);
    if (most >= 3000) CHECK(stream.bytes.size() > most * 6 / 10);
    const Splats geometry = decoded(stream);
    CHECK(static_cast<double>(geometry.size()) >= last);
    CHECK(total_weight(geometry) == Approx(area_of(ball)).epsilon(most < 900 ? 0.5 : 0.2));
    StreamDecoder decoder;
    REQUIRE(decoder.push(stream.bytes));
    CHECK(decoder.directory().size() == stream.header.chunks);
    std::size_t voxels = 0;
    for (const DirectoryEntry& e : decoder.directory()) voxels += e.vectors;
    CHECK(voxels >= stream.header.vectors);
    last = static_cast<double>(geometry.size());
  }
  EncodeOptions options;
  options.max_bytes = 100;
  CHECK(error_of(source_of(ball), options).find("the coarsest picture has ") == 0);
}

TEST_CASE("encodes one colour for all vectors, or one per vector") {
  EncodeOptions options;
  options.vectors = 3000;
  Triangles red = sphere(30);
  for (Triangle& t : red) t.colors.fill({200, 10, 10});
  const EncodedStream plain = encoded(red, options);
  CHECK_FALSE(plain.header.colored);
  CHECK(plain.header.color == Rgb8{200, 10, 10});
  CHECK(decoded(plain).colors.empty());
  for (Triangle& t : red)
    if (t.positions[0].z > 0) t.colors.fill({10, 10, 200});
  const Splats two = decoded(encoded(red, options));
  REQUIRE(two.colors.size() == two.size());
  for (std::size_t i = 0; i < two.size(); ++i)
    if (std::abs(two.positions[i].z) > 0.3f) REQUIRE((two.colors[i].b > two.colors[i].r) == (two.positions[i].z > 0));
}

TEST_CASE("stores directory boxes that contain the splats of their clusters") {
  const Triangles ball = sphere(60);
  EncodeOptions options;
  options.vectors = 8000;
  const EncodedStream stream = encoded(ball, options);
  StreamDecoder all;
  REQUIRE(all.push(stream.bytes));
  const auto& directory = all.directory();
  const Box& box = stream.header.description.box;
  for (std::size_t i = 0; i < directory.size(); ++i) {
    const auto payload = std::span(stream.bytes)
                             .subspan(directory[i].offset + kChunkHeaderBytes, directory[i].bytes - kChunkHeaderBytes);
    const auto read = read_cluster_header(payload);
    REQUIRE(std::holds_alternative<ClusterHeader>(read));
    const auto& header = std::get<ClusterHeader>(read);
    CHECK(header.id == i);
    CHECK(header.parent == directory[i].parent);
    CHECK(header.level + header.levels == directory[i].level);
    if (i != 0) continue;
    CHECK(directory[i].box.lower == box.lower);
    CHECK(directory[i].box.upper.x == Approx(box.upper.x));
  }
}

TEST_CASE("refuses surfaces that cannot be encoded, with a reason") {
  const std::string nothing = "no surface to encode; expected triangles with an area";
  const float nan = std::numeric_limits<float>::quiet_NaN();
  CHECK(error_of([](const TriangleSink&) { return false; }) == "the surface cannot be read");
  CHECK(error_of(source_of({})) == nothing);
  CHECK(error_of(source_of({triangle_of({0, 0, 0}, {1, 1, 1}, {2, 2, 2})})) == nothing);
  CHECK(error_of(source_of({triangle_of({nan, 0, 0}, {1, 0, 0}, {0, 1, 0})})) == nothing);
  CHECK(error_of(source_of({triangle_of({-3e38f, 0, 0}, {3e38f, 0, 0}, {0, 3e38f, 0})})) == nothing);
  const Triangles ball = sphere(10);
  int calls = 0;
  const TriangleSource once = [&](const TriangleSink& sink) { return ++calls == 1 && sink(ball); };
  CHECK(error_of(once) == "the surface cannot be read again");
  Progress progress;
  progress.cancelled = true;
  CHECK(error_of(source_of(ball), {}, &progress) == "cancelled");
}

TEST_CASE("encodes surfaces of extreme size as vectors that can be drawn") {
  for (const float size : {1e-25f, 1e-10f, 1e10f, 1e18f}) {
    EncodeOptions options;
    options.vectors = 500;
    for (const auto& encode : {encode_surface, encode_surface_records}) {
      const Triangles ball = sphere(12, size);
      const auto result = encode(source_of(ball), options, nullptr);
      if (std::holds_alternative<EncodeError>(result)) continue;  // the encoder reports an error
      const Splats geometry = decoded(std::get<EncodedStream>(result));
      REQUIRE_FALSE(geometry.empty());
      for (std::size_t i = 0; i < geometry.size(); ++i) {
        REQUIRE(geometry.weights[i] > 0);
        REQUIRE(std::isfinite(geometry.weights[i]));
        REQUIRE(std::isfinite(glm::length(geometry.positions[i] / size)));
      }
    }
  }
}

TEST_CASE("encodes records with the exact area of a surface") {
  const Triangles ball = sphere(50);
  EncodeOptions options;
  options.vectors = 4000;
  const auto result = encode_surface_records(source_of(ball), options);
  REQUIRE(std::holds_alternative<EncodedStream>(result));
  CHECK(total_weight(decoded(std::get<EncodedStream>(result))) == Approx(area_of(ball)).epsilon(0.01));
}

}  // namespace
}  // namespace gs::qnv
