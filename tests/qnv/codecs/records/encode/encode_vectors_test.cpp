#include "qnv/codecs/records/encode/encode_vectors.h"
#include "qnv/codecs/shared/encode_options.h"

#include "qnv/reader/stream_decoder.h"
#include "tests/geometries.h"

#include <glm/geometric.hpp>

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>

using namespace gs;

using namespace gs::qnv;

namespace {

// Returns points spread evenly over a unit sphere.
Splats sphere_vectors(std::size_t count, bool colored) {
  Splats geometry;
  const auto all = static_cast<float>(count);
  for (std::size_t i = 0; i < count; ++i) {
    const float z = 1 - (2 * static_cast<float>(i) + 1) / all, r = std::sqrt(1 - z * z);
    const float turn = static_cast<float>(i) * 2.39996323f;
    geometry.normals.emplace_back(r * std::cos(turn), r * std::sin(turn), z);
    geometry.positions.push_back(geometry.normals.back());
    geometry.weights.push_back(4 * std::numbers::pi_v<float> / all);
    if (colored) geometry.colors.push_back(z > 0 ? Rgb8{255, 0, 0} : Rgb8{0, 0, 255});
    geometry.description.box.add(geometry.positions.back());
  }
  geometry.color = {1, 2, 3};
  return geometry;
}

EncodedStream encoded(const VectorView& geometry, const EncodeOptions& options = {}) {
  auto result = encode_vectors(geometry, options);
  if (const auto* problem = std::get_if<EncodeError>(&result)) FAIL(problem->message);
  return std::get<EncodedStream>(result);
}

std::string problem_of(const VectorView& geometry, const EncodeOptions& options = {}) {
  const auto result = encode_vectors(geometry, options);
  const auto* problem = std::get_if<EncodeError>(&result);
  return problem ? problem->message : std::string();
}

template <class T = Splats>
T decoded(std::span<const std::byte> bytes) {
  StreamDecoder decoder;
  CHECK(decoder.push(bytes));
  CHECK(decoder.problems().empty());
  CHECK(decoder.refused_chunks() == 0);
  CHECK(decoder.geometry().size() == decoder.vectors());
  return content_of<T>(decoder.geometry());
}

double sum(const VectorArrays& geometry) {
  double all = 0;
  for (const float weight : geometry.weights) all += weight;
  return all;
}

}  // namespace

TEST_CASE("restores positions, directions, weights and colours of vectors from their stream") {
  EncodeOptions options;
  options.metadata = {{"title", "ball"}};
  Splats geometry = sphere_vectors(5000, true);
  geometry.description.two_sided = true;
  geometry.description.metadata = {{"title", "other"}, {"author", "someone"}};
  const EncodedStream stream = encoded(geometry, options);
  CHECK(stream.header.payload == Payload::records);
  CHECK(stream.header.vectors == 5000);
  CHECK(stream.header.colored);
  CHECK(stream.header.palette.size() == 2);
  const Splats back = decoded(stream.bytes);
  REQUIRE(back.size() == 5000);
  CHECK(back.description.two_sided);
  CHECK(back.description.metadata == decltype(options.metadata){{"title", "ball"}, {"author", "someone"}});
  CHECK(sum(back) == Approx(4 * std::numbers::pi).epsilon(1e-4));
  for (std::size_t i = 0; i < back.size(); ++i) {
    REQUIRE(glm::length(back.positions[i]) == Approx(1).margin(0.002));
    REQUIRE(glm::dot(back.positions[i], back.normals[i]) > std::cos(0.0694271f) - 0.005f);
    if (std::abs(back.positions[i].z) > 0.01f)
      REQUIRE(back.colors[i] == (back.positions[i].z > 0 ? Rgb8{255, 0, 0} : Rgb8{0, 0, 255}));
  }
  CHECK(encoded(geometry, options).bytes == stream.bytes);
  options.threads = 1;
  CHECK(encoded(geometry, options).bytes == stream.bytes);
  options.seed = 2;
  CHECK(encoded(geometry, options).bytes != stream.bytes);
  CHECK(decoded(encoded(sphere_vectors(100, false)).bytes).color == Rgb8{1, 2, 3});
}

TEST_CASE("keeps the whole area at every cut of a stream of records, within its budget") {
  const Splats geometry = sphere_vectors(4000, false);
  const EncodedStream stream = encoded(geometry);
  std::size_t before = 0;
  for (std::size_t size = 2000; size < stream.bytes.size(); size += 777) {
    const Splats part = decoded(std::span(stream.bytes).first(size));
    REQUIRE(part.size() >= before);
    REQUIRE(sum(part) == Approx(4 * std::numbers::pi).epsilon(1e-3));
    before = part.size();
  }
  EncodeOptions options;
  for (options.max_bytes = 250; options.max_bytes < 40000; options.max_bytes += options.max_bytes / 3) {
    const EncodedStream small = encoded(geometry, options);
    REQUIRE(small.bytes.size() <= options.max_bytes);
    const Splats back = decoded(small.bytes);
    REQUIRE(back.size() == small.header.vectors);
    REQUIRE(static_cast<double>(back.size()) >= 0.9 * static_cast<double>(options.max_bytes - 250) / 8.5);
  }
  options.max_bytes = 100;
  CHECK(problem_of(geometry, options).find("at most 100") != std::string::npos);
  options.max_bytes = 0;
  options.vectors = 123;
  CHECK(decoded(encoded(geometry, options).bytes).size() == 123);
}

TEST_CASE("encodes a volume's classes and transfer function, with the total of the sent vectors") {
  Volume geometry;
  static_cast<VectorArrays&>(geometry) = sphere_vectors(500, false);
  geometry.description.total = 1e9;  // includes vectors that were left out
  geometry.description.spacing = 0.5f;
  geometry.description.value_range = {-3, 7};
  geometry.description.transfer = {{0, {0, 0, 0}, 0}, {1, {255, 255, 255}, 1}};
  for (std::size_t i = 0; i < geometry.size(); ++i) geometry.classes.push_back(static_cast<std::uint8_t>(i % 7));
  const auto back = decoded<Volume>(encoded(geometry).bytes);
  REQUIRE(back.classes.size() == 500);
  CHECK(back.colors.empty());
  CHECK(*std::max_element(back.classes.begin(), back.classes.end()) == 6);
  CHECK(back.description.transfer == geometry.description.transfer);
  CHECK(back.description.value_range == geometry.description.value_range);
  CHECK(sum(back) == Approx(4 * std::numbers::pi).epsilon(1e-4));
}

TEST_CASE("omits invalid vectors and refuses an input without vectors") {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInfinity = std::numeric_limits<float>::infinity();
  Splats geometry = sphere_vectors(50, false);
  geometry.weights[3] = 0;
  geometry.weights[4] = kNan;
  geometry.positions[5].x = kInfinity;
  geometry.positions[6].y = kNan;
  CHECK(decoded(encoded(geometry).bytes).size() == 46);
  CHECK_FALSE(problem_of(Splats{}).empty());
  std::fill(geometry.weights.begin(), geometry.weights.end(), 0.0f);
  CHECK_FALSE(problem_of(geometry).empty());
  geometry.weights.pop_back();
  CHECK_FALSE(problem_of(geometry).empty());
  Progress progress;
  progress.cancelled = true;
  CHECK(std::get<EncodeError>(encode_vectors(sphere_vectors(50, false), {}, &progress)).message == "cancelled");
}

TEST_CASE("rejects chunks of the other payload and nonsense") {
  const EncodedStream stream = encoded(sphere_vectors(200, false));
  StreamDecoder decoder;
  REQUIRE(decoder.push(stream.bytes));
  const std::vector<std::byte> nonsense(100, std::byte{0x5a});
  decoder.add(ChunkType::packed, nonsense);
  decoder.add(ChunkType::records, nonsense);
  CHECK(decoder.refused_chunks() == 2);
  CHECK(decoder.vectors() == 200);
  StreamDecoder few(50);
  REQUIRE(few.push(stream.bytes));
  CHECK(few.vectors() <= 50);
  CHECK(few.refused_chunks() > 0);
}
