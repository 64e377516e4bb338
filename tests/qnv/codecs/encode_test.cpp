#include "qnv/codecs/encode.h"

#include "tests/qnv/codecs/displaced/displaced_shapes.h"
#include "tests/qnv/soft_ball.h"

#include <catch2/catch.hpp>

#include <functional>
#include <string>
#include <string_view>
#include <variant>

namespace gs::qnv::encode_test {
namespace {

Encoding made_of(const EncodeSource& source, const EncodeRequest& request) {
  auto made = encode(source, request);
  if (const auto* problem = std::get_if<EncodeError>(&made)) FAIL(problem->message);
  return std::get<Encoding>(std::move(made));
}

Encoding made_of(const Triangles& triangles, const EncodeRequest& request) {
  const TriangleSource source = source_of(triangles);
  return made_of(EncodeSource(std::cref(source)), request);
}

}  // namespace

TEST_CASE("chooses a base mesh for smooth surfaces and splits for sharp parts") {
  const Encoding smooth = made_of(displaced::ball(16), {});
  CHECK(smooth.payload->name == "displaced");
  CHECK(smooth.why == "a base mesh follows the surface");
  const Encoding sharp = made_of(displaced::wheel(), {});
  CHECK(sharp.payload->name == "progressive");
  CHECK(sharp.why == "the surface has planes and sharp edges");
}

TEST_CASE("replaces an unsuited payload by an octree") {
  const Triangles heap = random_triangles(3000, 1, 5);
  EncodeRequest request;
  request.options.max_bytes = 9000;
  const Encoding octree = made_of(heap, request);
  CHECK(octree.payload->name == "packed");
  CHECK(octree.why == "no base mesh follows the surface");
  CHECK(octree.stream.bytes.size() <= 9000);
}

TEST_CASE("encodes with the requested payload and reports that") {
  const Triangles ball = displaced::ball(8);
  for (const Payload payload : {Payload::records, Payload::packed, Payload::displaced}) {
    EncodeRequest request;
    request.payload = payload;
    request.options.vectors = 500;
    const Encoding made = made_of(ball, request);
    CHECK(made.stream.header.payload == payload);
    CHECK(made.why == "it was requested");
  }
}

TEST_CASE("encodes an octree without an exact mesh for a number of vectors") {
  EncodeRequest request;
  request.options.vectors = 500;
  request.options.exact_bits = kExactWherePays;
  const Encoding made = made_of(displaced::ball(8), request);
  CHECK(made.payload->name == "packed");
  CHECK(made.why == "only an octree can have a given number of vectors");
  CHECK(!made.stream.header.meshed);
}

TEST_CASE("chooses records for vectors and values for volumes") {
  const SoftBall ball(12);
  CHECK(made_of(EncodeSource(std::cref(ball.source)), {}).payload->name == "values");
  CHECK(made_of(EncodeSource(VectorView(ball.geometry)), {}).payload->name == "records");
}

TEST_CASE("rejects a payload that cannot be made of the source") {
  const SoftBall ball(12);
  EncodeRequest request;
  request.payload = Payload::displaced;
  CHECK(std::holds_alternative<EncodeError>(encode(EncodeSource(VectorView(ball.geometry)), request)));
  CHECK(std::holds_alternative<EncodeError>(encode(EncodeSource(std::cref(ball.source)), request)));
}

TEST_CASE("uses textures only for streams with an exact mesh") {
  EncodeRequest request;
  CHECK(!uses_texture(request, 100));
  request.options.exact_bits = kExactWherePays;
  CHECK(uses_texture(request, kMaxChosenTriangles));
  CHECK(!uses_texture(request, kMaxChosenTriangles + 1));
  request.options.exact_bits = 12;
  CHECK(uses_texture(request, kMaxChosenTriangles + 1));
  request.payload = Payload::displaced;
  CHECK(uses_texture(request, 100));
  request.options.vectors = 1000;
  CHECK(!uses_texture(request, 100));
  request = {Payload::packed, {}};
  request.options.exact_bits = 12;
  CHECK(!uses_texture(request, 100));
}

}  // namespace gs::qnv::encode_test
