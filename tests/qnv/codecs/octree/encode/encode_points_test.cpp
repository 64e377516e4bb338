#include "qnv/codecs/octree/encode/encode_surface.h"
#include "qnv/reader/stream_decoder.h"
#include "tests/geometries.h"
#include "tests/qnv/surface_shapes.h"
#include "tests/watched.h"

#include <catch2/catch.hpp>
#include <glm/geometric.hpp>

#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <utility>
#include <variant>
#include <vector>

using namespace gs::qnv;

namespace {

/// Returns points of a ball with equal areas.
Splats ball_of_points(std::size_t count) {
  Splats geometry;
  geometry.description.two_sided = true;
  geometry.description.origin = {6e6, 0, 0};
  geometry.description.metadata = {{"up", "z"}};
  for (std::size_t i = 0; i < count; ++i) {
    const double z = 1 - (2 * static_cast<double>(i) + 1) / static_cast<double>(count);
    const double turn = 2.399963 * static_cast<double>(i), r = std::sqrt(1 - z * z);
    const glm::vec3 n(r * std::cos(turn), r * std::sin(turn), z);
    geometry.positions.push_back(3.0f * n);
    geometry.normals.push_back(n);
    geometry.weights.push_back(static_cast<float>(4 * std::numbers::pi * 9 / static_cast<double>(count)));
    geometry.colors.push_back(n.z > 0 ? Rgb8{200, 0, 0} : Rgb8{0, 0, 200});
  }
  return geometry;
}

Splats decoded_points(const EncodedStream& stream) {
  StreamDecoder decoder;
  REQUIRE(decoder.push(stream.bytes));
  decoder.finish();
  REQUIRE(decoder.problems().empty());
  return content_of<Splats>(decoder.geometry());
}

}  // namespace

TEST_CASE("packs points of a surface at their positions, with their normals and without gaps") {
  Splats points = ball_of_points(8000);
  EncodeOptions options;
  options.metadata = {{"title", "ball"}};
  const auto result = encode_points(points, options);
  REQUIRE(std::holds_alternative<EncodedStream>(result));
  const auto& stream = std::get<EncodedStream>(result);
  CHECK(stream.header.payload == Payload::packed);
  CHECK(stream.header.description.origin == glm::dvec3(6e6, 0, 0));
  CHECK(stream.header.description.metadata ==
        std::vector<std::pair<std::string, std::string>>{{"title", "ball"}, {"up", "z"}});
  CHECK(stream.header.description.total == Approx(4 * std::numbers::pi * 9).epsilon(0.001));
  CHECK(stream.bytes.size() < 8000 * 3);  // records would need 8000 * 8
  const Splats geometry = decoded_points(stream);
  CHECK(geometry.size() > 4000);
  CHECK(geometry.size() < 20'000);
  CHECK(total_weight(geometry) == Approx(4 * std::numbers::pi * 9).epsilon(0.05));
  for (std::size_t i = 0; i < geometry.size(); ++i) {
    const glm::vec3& p = geometry.positions[i];
    REQUIRE_EACH(std::abs(glm::length(p) - 3) < 0.06f);
    REQUIRE_EACH(glm::dot(geometry.normals[i], glm::normalize(p)) > 0.97f);
    REQUIRE_EACH(std::abs(p.z) < 0.3f || (geometry.colors[i].r > geometry.colors[i].b) == (p.z > 0));
  }
}

TEST_CASE("skips invalid points, and refuses points that form no surface") {
  Splats points = ball_of_points(500);
  points.positions[7].x = std::numeric_limits<float>::quiet_NaN();
  points.normals[8] = glm::vec3(0);
  points.weights[9] = -1;
  CHECK(std::holds_alternative<EncodedStream>(encode_points(points, {})));
  Splats none = points;
  none.weights.assign(none.size(), 0);
  CHECK(std::holds_alternative<EncodeError>(encode_points(none, {})));
  none.weights.pop_back();
  CHECK(std::holds_alternative<EncodeError>(encode_points(none, {})));
  Volume volume;
  static_cast<VectorArrays&>(volume) = points;
  CHECK(std::holds_alternative<EncodeError>(encode_points(volume, {})));
}
