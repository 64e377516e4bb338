#include "qnv/codecs/outlines/grouping/outline_groups.h"

#include "tests/qnv/outline_models.h"

#include <catch2/catch.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace gs::qnv {
namespace {

OutlineOptions dropping() {  // a tolerance of merging drops straight vertices
  OutlineOptions options;
  options.merge_tolerance = 1e-6;
  return options;
}

bool has(std::span<const glm::vec3> ring, const glm::vec3& p) {
  return std::find(ring.begin(), ring.end(), p) != ring.end();
}

}  // namespace

TEST_CASE("merges a plate with two holes into one polygon of three rings", "[outline]") {
  PolygonModel model;
  for (int x = 0; x < 5; ++x)
    for (int y = 0; y < 5; ++y)
      if (!(x == 1 && y == 1) && !(x == 3 && y == 3)) add_square(model, static_cast<float>(x), static_cast<float>(y));
  for (const bool drop : {false, true}) {
    const OutlineGroups made = groups_of(model, drop ? dropping() : OutlineOptions{});
    REQUIRE(made.groups.size() == 1);
    const OutlineGroup& group = made.groups[0];
    CHECK(group.inner.empty());
    REQUIRE(group.outline.size() == 1);
    const OutlinePolygon plate = group.outline[0];
    REQUIRE(plate.rings() == 3);
    CHECK(plate.area == 23.0);
    CHECK(plate.ring(0).size() == (drop ? 4 : 20));
    CHECK(vector_area(plate.ring(0)) == glm::dvec3(0, 0, 25));
    for (const std::size_t hole : {1u, 2u}) {
      CHECK(plate.ring(hole).size() == 4);
      CHECK(vector_area(plate.ring(hole)) == glm::dvec3(0, 0, -1));
    }
    CHECK(made.counts.merged == 22);
  }
}

TEST_CASE("merges polygons with bent shading only if allowed", "[outline]") {
  PolygonModel model;
  for (int x = 0; x < 4; ++x) add_square(model, static_cast<float>(x), 0);
  model.bent = {0, 0, 1, 0};
  OutlineOptions options;
  options.tolerance = 0.1;
  const OutlineGroups exact = groups_of(model, options);
  REQUIRE(exact.groups.size() == 1);
  CHECK(exact.groups[0].outline.size() == 1);
  REQUIRE(exact.groups[0].inner.size() == 3);
  CHECK(exact.groups[0].inner[0].area == 2.0);
  CHECK(groups_of(model, dropping()).groups[0].inner.empty());
  model.bent.pop_back();
  CHECK(std::holds_alternative<OutlineError>(group_outlines(model, {})));
}

TEST_CASE("keeps the six corners of an L of three squares", "[outline]") {
  PolygonModel model;
  add_square(model, 0, 0);
  add_square(model, 1, 0);
  add_square(model, 0, 1);
  const OutlineGroups exact = groups_of(model);
  REQUIRE(exact.groups.size() == 1);
  CHECK(exact.groups[0].outline[0].ring(0).size() == 8);  // and two in straight edges
  const OutlineGroups made = groups_of(model, dropping());
  const auto ring = made.groups[0].outline[0].ring(0);
  REQUIRE(ring.size() == 6);
  for (const glm::vec3 p : {glm::vec3(0, 0, 0), {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}})
    CHECK(has(ring, p));
}

TEST_CASE("keeps an island in a hole as its own polygon", "[outline]") {
  PolygonModel model;
  for (int x = 0; x < 5; ++x)
    for (int y = 0; y < 5; ++y)
      if (x == 0 || y == 0 || x == 4 || y == 4) add_square(model, static_cast<float>(x), static_cast<float>(y));
  add_square(model, 2, 2);
  const OutlineGroups made = groups_of(model, dropping());
  REQUIRE(made.groups.size() == 2);
  CHECK(made.groups[0].outline[0].rings() == 2);
  CHECK(made.groups[0].area == 16.0);
  CHECK(made.groups[1].outline[0].rings() == 1);
  CHECK(made.groups[1].area == 1.0);
}

TEST_CASE("splits a ring that touches itself into rings that touch", "[outline]") {
  PolygonModel model;  // three by three without the centre and a corner, which touch
  for (int x = 0; x < 3; ++x)
    for (int y = 0; y < 3; ++y)
      if (!(x == 1 && y == 1) && !(x == 2 && y == 2)) add_square(model, static_cast<float>(x), static_cast<float>(y));
  const OutlineGroups made = groups_of(model);
  REQUIRE(made.groups.size() == 1);
  REQUIRE(made.groups[0].outline.size() == 1);
  const OutlinePolygon polygon = made.groups[0].outline[0];
  REQUIRE(polygon.rings() == 2);
  CHECK(vector_area(polygon.ring(0)) == glm::dvec3(0, 0, 8));
  CHECK(vector_area(polygon.ring(1)) == glm::dvec3(0, 0, -1));
  CHECK(has(polygon.ring(0), {2, 2, 0}));
  CHECK(has(polygon.ring(1), {2, 2, 0}));
  const auto bridged = bridged_ring(polygon);
  std::vector<glm::vec3> ring;
  for (const std::uint32_t i : bridged) ring.push_back(polygon.positions[i]);
  CHECK(vector_area(ring) == glm::dvec3(0, 0, 7));
}

TEST_CASE("does not merge polygons that overlap", "[outline]") {
  PolygonModel model;  // a flat spiral of nine triangles around one corner: one turn and a quarter
  const auto at = [](int i) {
    const double angle = i * 50 * std::numbers::pi / 180;
    return glm::vec3(std::cos(angle), std::sin(angle), 0);
  };
  for (int i = 0; i < 9; ++i) add_polygon(model, {{0, 0, 0}, at(i), at(i + 1)});
  const OutlineGroups made = groups_of(model);
  REQUIRE(made.groups.size() == 1);
  CHECK(made.groups[0].inner.size() == 9);
  CHECK(made.counts.merged == 0);
}

TEST_CASE("removes a straight vertex only if all rings can lose it", "[outline]") {
  const glm::vec3 middle(1, 1, 0);
  PolygonModel model;  // a bar of one appearance above two squares of another, with a common vertex
  add_square(model, 0, 0, 1);
  add_square(model, 1, 0, 1);
  add_polygon(model, {{0, 1, 0}, {1, 1, 0}, {2, 1, 0}, {2, 2, 0}, {0, 2, 0}}, 2);
  const auto passes = [&](const OutlineGroups& made, std::uint32_t appearance) {
    for (const OutlineGroup& group : made.groups)
      if (group.appearance == appearance) return has(group.outline.positions, middle);
    return false;
  };
  OutlineGroups made = groups_of(model, dropping());
  REQUIRE(made.groups.size() == 2);
  CHECK(!passes(made, 1));
  CHECK(!passes(made, 2));
  CHECK(groups_of(model).groups[0].outline.positions.size() == 6);

  // With a wall at that point, three edges meet.
  add_polygon(model, {{1, 1, 0}, {1, 1, 1}, {1, 0.5f, 1}}, 3);
  made = groups_of(model, dropping());
  CHECK(passes(made, 1));
  CHECK(passes(made, 2));
  CHECK(passes(made, 3));
}

TEST_CASE("makes no T-junction, and mends none by guessing", "[outline]") {
  PolygonModel model;  // the long edge of the bar lacks the vertex between the two squares below
  add_square(model, 0, 0, 1);
  add_square(model, 1, 0, 2);
  add_polygon(model, {{0, 1, 0}, {2, 1, 0}, {2, 2, 0}, {0, 2, 0}}, 3);
  const OutlineGroups made = groups_of(model, dropping());
  REQUIRE(made.groups.size() == 3);
  for (const OutlineGroup& group : made.groups) {
    CHECK(group.outline.positions.size() == 4);
    CHECK(has(group.outline.positions, {1, 1, 0}) == (group.appearance != 3));
  }
}

TEST_CASE("joins a sliver without area to its neighbour", "[outline]") {
  PolygonModel model;
  add_polygon(model, {{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {0, 1, 0}});
  add_polygon(model, {{0, 1, 0}, {2, 1, 0}, {1, 1, 0}});
  add_square(model, 0, 1);
  add_square(model, 1, 1);
  const OutlineGroups made = groups_of(model, dropping());
  REQUIRE(made.groups.size() == 1);
  CHECK(made.groups[0].area == 4.0);
  CHECK(made.groups[0].outline.positions.size() == 4);
}

TEST_CASE("merges slightly different planes only within a tolerance", "[outline]") {
  PolygonModel model;
  for (int i = 0; i < 8; ++i) {
    const auto x = static_cast<float>(i);
    const auto height = [](float at) { return 1e-4f * at * at; };
    add_polygon(model, {{x, 0, height(x)}, {x + 1, 0, height(x + 1)}, {x + 1, 1, height(x + 1)}, {x, 1, height(x)}});
  }
  OutlineOptions options;
  options.tolerance = 0.01;
  OutlineGroups made = groups_of(model, options);
  REQUIRE(made.groups.size() == 1);
  CHECK(made.groups[0].inner.size() == 8);
  CHECK(made.groups[0].outline.positions.size() == 18);
  options.merge_tolerance = 0.01;
  made = groups_of(model, options);
  CHECK(made.groups[0].inner.empty());
  CHECK(made.groups[0].outline.size() == 1);
  CHECK(made.groups[0].outline.positions.size() == 4);
}

TEST_CASE("merges a fine mesh of a tilted plane although its positions are rounded", "[outline]") {
  PolygonModel model;
  const glm::dvec3 u = glm::normalize(glm::dvec3(3, 1, 2)), v = glm::normalize(glm::cross(u, glm::dvec3(0, 0, 1)));
  const auto at = [&](int x, int y) { return glm::vec3(u * (x / 8.0) + v * (y / 8.0)); };
  for (int x = 0; x < 8; ++x)
    for (int y = 0; y < 8; ++y) add_polygon(model, {at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)});
  const OutlineGroups made = groups_of(model);
  REQUIRE(made.groups.size() == 1);
  CHECK(made.groups[0].outline.positions.size() == 32);
  CHECK(made.groups[0].area == Approx(1.0));
}

TEST_CASE("keeps texture coordinates, and merges polygons with one common mapping", "[outline]") {
  PolygonModel model;
  add_polygon(model, {{0, 0, 0}, {2, 0, 0}, {2, 1, 0}});
  add_polygon(model, {{0, 0, 0}, {2, 1, 0}, {0, 1, 0}});
  model.texture_coordinates = {{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}};
  OutlineGroups made = groups_of(model);
  REQUIRE(made.groups.size() == 1);
  CHECK(made.groups[0].inner.empty());
  const OutlinePolygon quad = made.groups[0].outline[0];
  REQUIRE(quad.positions.size() == 4);
  REQUIRE(quad.texture_coordinates.size() == 4);
  for (std::size_t i = 0; i < 4; ++i)
    CHECK(quad.texture_coordinates[i] == glm::vec2(quad.positions[i].x / 2, quad.positions[i].y));
  model.texture_coordinates[5] = {0, 0.5f};  // another mapping
  OutlineOptions options;
  options.tolerance = 0.1;
  made = groups_of(model, options);
  REQUIRE(made.groups.size() == 1);
  CHECK(made.groups[0].inner.size() == 2);
  CHECK(made.groups[0].inner.texture_coordinates.size() == 6);
  CHECK(made.groups[0].outline.size() == 1);
  CHECK(made.groups[0].outline.texture_coordinates.empty());
}

TEST_CASE("makes a ring for the hole of a polygon with a bridge", "[outline]") {
  PolygonModel model;
  add_polygon(
      model,
      {{0, 0, 0}, {3, 0, 0}, {3, 3, 0}, {0, 3, 0}, {0, 0, 0}, {1, 1, 0}, {1, 2, 0}, {2, 2, 0}, {2, 1, 0}, {1, 1, 0}});
  const OutlineGroups made = groups_of(model);
  REQUIRE(made.groups.size() == 1);
  REQUIRE(made.groups[0].outline.size() == 1);
  const OutlinePolygon polygon = made.groups[0].outline[0];
  REQUIRE(polygon.rings() == 2);
  CHECK(polygon.area == 8.0);
  CHECK(polygon.ring(0).size() == 4);
  CHECK(polygon.ring(1).size() == 4);
}

}  // namespace gs::qnv
