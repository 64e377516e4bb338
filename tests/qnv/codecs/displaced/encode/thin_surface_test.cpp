#include "qnv/codecs/displaced/encode/thin_surface.h"
#include "qnv/codecs/displaced/encode/encode_displaced.h"

#include "tests/qnv/surface_shapes.h"
#include "tests/watched.h"

#include <catch2/catch.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <utility>

using namespace gs;

using namespace gs::qnv;

namespace {

std::variant<ThinnedSurface, EncodeError> thin(const Triangles& triangles, std::size_t most,
                                               Progress* progress = nullptr) {
  EncodeRanks alone{EncodeOptions{}};
  SurfaceSurvey survey;
  survey.add(triangles);
  return thin_surface(alone, source_of(triangles), survey, most, progress);
}

ThinnedSurface thinned(const Triangles& triangles, std::size_t most) {
  auto result = thin(triangles, most);
  if (const auto* error = std::get_if<EncodeError>(&result)) FAIL(error->message);
  return std::get<ThinnedSurface>(std::move(result));
}

Triangles triangles_of(const ThinnedSurface& surface) {
  Triangles out;
  REQUIRE(surface.source()([&](std::span<const Triangle> some) {
    out.insert(out.end(), some.begin(), some.end());
    return true;
  }));
  return out;
}

/// Counts edges without a triangle in the other direction.
std::size_t open_sides(const ThinnedSurface& surface) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> sides;
  for (const auto& t : surface.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      ++sides[{t[k], t[(k + 1) % 3]}];
      --sides[{t[(k + 1) % 3], t[k]}];
    }
  std::size_t open = 0;
  for (const auto& [side, balance] : sides) open += balance != 0 ? 1 : 0;
  return open;
}

}  // namespace

TEST_CASE("thins a surface to the requested triangles, and keeps its position and closedness") {
  const Triangles ball = sphere(150, 2, {10, 0, 0}, true);
  for (const std::size_t most : {20'000u, 2'000u}) {
    INFO(most);
    const ThinnedSurface surface = thinned(ball, most);
    CHECK(surface.triangles.size() <= most);
    CHECK(surface.triangles.size() > most / 3);
    CHECK(open_sides(surface) == 0);
    float most_apart = 0;
    for (const glm::vec3& p : surface.positions)
      most_apart = std::max(most_apart, std::abs(glm::distance(p, glm::vec3(10, 0, 0)) - 2));
    CHECK(most_apart < (most > 10'000 ? 0.002f : 0.02f));
    CHECK(area_of(triangles_of(surface)) == Approx(area_of(ball)).epsilon(most > 10'000 ? 0.002 : 0.02));
    // Red grows from the top to the bottom.
    for (std::size_t i = 0; i < surface.positions.size(); ++i) {
      const double down = std::acos(std::clamp(surface.positions[i].z / 2, -1.0f, 1.0f)) / 3.14159265;
      REQUIRE_EACH(std::abs(surface.colors[i].r - 255 * down) < 40);
    }
  }
}

TEST_CASE("thins a surface equally if its triangles come in another order") {
  Triangles ball = sphere(60, 2, {10, 0, 0}, true);
  SurfaceSurvey survey;
  survey.add(ball);
  EncodeRanks alone{EncodeOptions{}};
  const auto first = thin_surface(alone, source_of(ball), survey, 3'000);
  std::reverse(ball.begin(), ball.end());
  const auto second = thin_surface(alone, source_of(ball), survey, 3'000);
  const auto &surface = std::get<ThinnedSurface>(first), &other = std::get<ThinnedSurface>(second);
  CHECK(other.triangles == surface.triangles);
  CHECK(other.positions == surface.positions);
  CHECK(other.colors == surface.colors);
}

TEST_CASE("thins rough and folded surfaces to nearly the requested triangles") {
  // A ball of dust has far more area than a smooth surface through its cells.
  const Triangles dust = random_triangles(60'000, 0.02f, 3);
  const ThinnedSurface surface = thinned(dust, 5'000);
  CHECK(surface.triangles.size() <= 5'000);
  const Triangles ball = sphere(120);
  for (const std::size_t most : {500u, 5'000u, 15'000u}) {
    const std::size_t triangles = thinned(ball, most).triangles.size();
    CHECK(triangles <= most);
    CHECK(triangles > most / 2);
  }
}

TEST_CASE("keeps edges and corners of a thinned box sharp") {
  const ThinnedSurface surface = thinned(box_shape({0, 0, 0}, {4, 3, 2}, 60), 3'000);
  CHECK(open_sides(surface) == 0);
  std::size_t corners = 0;
  float most_apart = 0;
  for (const glm::vec3& p : surface.positions) {
    const glm::vec3 beyond = glm::max(glm::max(-p, p - glm::vec3(4, 3, 2)), glm::vec3(0));
    const glm::vec3 inside = glm::min(p, glm::vec3(4, 3, 2) - p);
    most_apart = std::max({most_apart, glm::length(beyond), std::min({inside.x, inside.y, inside.z})});
    corners += glm::length(inside) < 0.01f ? 1 : 0;
  }
  CHECK(most_apart < 0.01f);
  CHECK(corners == 8);
}

TEST_CASE("ignores invalid triangles and reports a surface that cannot be simplified") {
  Triangles triangles = sphere(40);
  const ThinnedSurface sound = thinned(triangles, 1000);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  triangles.insert(triangles.begin() + 20, triangle_of({nan, 0, 0}, {1, 0, 0}, {0, 1, 0}));
  triangles.push_back(triangle_of({0, 0, 0}, {0, 0, 0}, {0, 1, 0}));
  CHECK(thinned(triangles, 1000).triangles == sound.triangles);
  CHECK(thinned(triangles, 1).triangles.size() <= 1);
  CHECK(std::holds_alternative<EncodeError>(thin({}, 1000)));
  Progress progress;
  progress.cancelled = true;
  CHECK(std::get<EncodeError>(thin(triangles, 1000, &progress)).message == "cancelled");
}

TEST_CASE("encodes a surface that exceeds the memory as one of fewer triangles") {
  const Triangles ball = sphere(90);
  EncodeOptions options;
  options.most_triangles = 8'000;
  const auto result = encode_displaced(source_of(ball), options);
  REQUIRE(std::holds_alternative<EncodedStream>(result));
  const StreamHeader& header = std::get<EncodedStream>(result).header;
  CHECK(header.payload == Payload::displaced);
  CHECK(std::get<EncodedStream>(result).thinned);
  CHECK(header.description.total == Approx(area_of(ball)).epsilon(0.01));
  // The encoder has no other copy of the mesh, so it omits the exact mesh.
  options.exact_bits = 12;
  const auto refused = encode_displaced(source_of(ball), options);
  REQUIRE(std::holds_alternative<EncodeError>(refused));
  CHECK(std::get<EncodeError>(refused).message ==
        "the exact mesh has more than 8000 triangles, which exceed the memory limit; expected a smaller mesh, or a "
        "larger --memory");
  options.most_triangles = ball.size();
  const auto whole = encode_displaced(source_of(ball), options);
  REQUIRE(std::holds_alternative<EncodedStream>(whole));
  CHECK_FALSE(std::get<EncodedStream>(whole).thinned);
}
