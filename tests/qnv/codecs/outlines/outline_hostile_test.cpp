#include "qnv/codecs/outlines/grouping/outline_groups.h"

#include "tests/qnv/outline_models.h"
#include "tests/watched.h"

#include <catch2/catch.hpp>
#include <glm/geometric.hpp>

#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <string>

namespace gs::qnv {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

// Checks the invariants of groups of any model.
void require_sound(const PolygonModel& model, const OutlineGroups& made) {
  REQUIRE(made.group_of.size() == model.ends.size());
  for (const std::uint32_t group : made.group_of)
    REQUIRE_EACH((group < made.groups.size() || group == OutlineGroups::kNoGroup));
  std::size_t grouped = 0;
  for (const OutlineGroup& group : made.groups) {
    REQUIRE(group.area > 0);
    REQUIRE(std::isfinite(group.area));
    REQUIRE(glm::length(group.normal) == Approx(1.0f));
    REQUIRE((std::isfinite(group.offset) && std::isfinite(group.deviation)));
    grouped += group.polygons;
    for (const OutlinePolygons* polygons : {&group.outline, &group.inner}) {
      REQUIRE(polygons->areas.size() == polygons->size());
      for (std::size_t i = 0; i < polygons->size(); ++i) {
        const OutlinePolygon polygon = (*polygons)[i];
        REQUIRE(polygon.rings() > 0);
        for (std::size_t r = 0; r < polygon.rings(); ++r) REQUIRE_EACH(polygon.ring(r).size() >= 3);
        for (const std::uint32_t corner : bridged_ring(polygon)) REQUIRE_EACH(corner < polygon.positions.size());
      }
    }
  }
  REQUIRE(grouped + made.counts.invalid + made.counts.degenerate + made.counts.duplicates == model.ends.size());
}

std::string error_of(const PolygonModel& model) {
  const auto made = group_outlines(model, {});
  return std::holds_alternative<OutlineError>(made) ? std::get<OutlineError>(made).message : "";
}

}  // namespace

TEST_CASE("makes no groups of no polygons", "[outline]") {
  CHECK(groups_of({}).groups.empty());
  PolygonModel model;
  model.positions.resize(3);
  model.ends = {0, 0, 0};
  const OutlineGroups made = groups_of(model);
  CHECK(made.groups.empty());
  CHECK(made.counts.degenerate == 3);
  CHECK(model_diagonal(model) == 0.0);
}

TEST_CASE("drops polygons with invalid corners", "[outline]") {
  PolygonModel model;
  add_square(model, 0, 0);
  add_polygon(model, {{0, 0, 0}, {1, 0, kNan}, {1, 1, 0}});
  add_polygon(model, {{0, 0, 0}, {kInfinity, 0, 0}, {1, 1, 0}});
  add_polygon(model, {{0, 0, 0}, {-kInfinity, 0, 0}, {1, 1, 0}});
  add_polygon(model, {{0, 0, 0}, {1, 0, 0}});
  add_polygon(model, {{5, 0, 0}, {6, 0, 0}, {5, 0, 0}, {6, 0, 0}});
  add_polygon(model, {{5, 0, 0}, {6, 0, 0}, {7, 0, 0}});
  add_polygon(model, {{5, 0, 0}, {6, 0, 0}, {6, 1, 0}});
  model.corners.back() = 4000000000u;
  const OutlineGroups made = groups_of(model);
  CHECK(made.groups.size() == 1);
  CHECK(made.counts.invalid == 4);
  CHECK(made.counts.degenerate == 3);
  require_sound(model, made);
}

TEST_CASE("treats -0 as 0 and repeated corners as one", "[outline]") {
  PolygonModel model;
  add_polygon(model, {{-0.0f, 0, 0}, {1, -0.0f, 0}, {1, 0, 0}, {1, 1, -0.0f}, {0, 0, 0}});
  add_polygon(model, {{0, 0, 0}, {1, 1, 0}, {0, 1, 0}});
  const OutlineGroups made = groups_of(model);
  REQUIRE(made.groups.size() == 1);
  CHECK(made.groups[0].outline.positions.size() == 4);
}

TEST_CASE("reports arrays of inconsistent lengths as errors", "[outline]") {
  PolygonModel model;
  add_square(model, 0, 0);
  add_square(model, 1, 0);
  PolygonModel bad = model;
  bad.ends = {8, 4};
  CHECK(error_of(bad) == "the ends of polygons are not ascending");
  bad.ends = {4, 9};
  CHECK(error_of(bad) == "the last polygon exceeds the corners: 9, expected 8");
  bad = model;
  bad.appearances.resize(1);
  CHECK(error_of(bad) == "appearances: 1, expected 2");
  bad = model;
  bad.texture_coordinates.resize(7);
  CHECK(error_of(bad) == "texture coordinates: 7, expected 8");
}

TEST_CASE("groups huge and tiny models", "[outline]") {
  for (const float scale : {1e38f, 1e-30f, 1e-37f}) {
    PolygonModel model = sphere_model(6);
    for (glm::vec3& p : model.positions) p *= scale;
    OutlineOptions options;
    options.tolerance = 0.1 * scale;
    options.outline_tolerance = 0.05 * scale;
    const OutlineGroups made = groups_of(model, options);
    INFO(scale);
    CHECK(made.groups.size() > 5);
    CHECK(made.groups.size() < 100);
    require_sound(model, made);
  }
}

TEST_CASE("treats NaN options as 0", "[outline]") {
  PolygonModel model;
  add_cube(model);
  OutlineOptions options;
  options.tolerance = options.angle = options.merge_tolerance = options.merge_angle = options.outline_tolerance =
      std::nan("");
  CHECK(groups_of(model, options).groups.size() == 6);
  options.tolerance = options.angle = options.merge_tolerance = options.merge_angle = options.outline_tolerance =
      INFINITY;
  require_sound(model, groups_of(model, options));
  options.tolerance = options.angle = -1;
  require_sound(model, groups_of(model, options));
}

TEST_CASE("groups any polygons between any points", "[outline]") {
  std::mt19937 random(1);
  for (int round = 0; round < 300; ++round) {
    PolygonModel model;
    const std::size_t points = 3 + random() % 12, polygons = 1 + random() % 60;
    const bool flat = random() % 2 == 0;
    for (std::size_t i = 0; i < points; ++i) {
      const auto number = [&] { return static_cast<float>(random() % 4); };
      model.positions.emplace_back(number(), number(), flat ? 0.0f : number());
      if (random() % 50 == 0) {
        const auto bits = static_cast<std::uint32_t>(random());
        std::memcpy(&model.positions.back().x, &bits, sizeof bits);
      }
    }
    for (std::size_t i = 0; i < polygons; ++i) {
      for (std::size_t k = 0; k < random() % 9; ++k)
        model.corners.push_back(static_cast<std::uint32_t>(random() % (points + (random() % 40 == 0))));
      model.ends.push_back(static_cast<std::uint32_t>(model.corners.size()));
      model.appearances.push_back(static_cast<std::uint32_t>(random() % 2));
    }
    if (random() % 3 == 0)
      for (std::size_t i = 0; i < model.corners.size(); ++i)
        model.texture_coordinates.emplace_back(random() % 2, random() % 50 == 0 ? kNan : 0.0f);
    OutlineOptions options;
    const auto some = [&] { return random() % 2 == 0 ? 0.0 : static_cast<double>(random() % 100) / 50; };
    options.tolerance = some();
    options.angle = some();
    options.merge_tolerance = some();
    options.outline_tolerance = some();
    options.groups = random() % 4;
    options.threads = 1 + static_cast<unsigned>(random() % 2);
    INFO(round);
    require_sound(model, groups_of(model, options));
  }
}

TEST_CASE("ends on hubs, stars and long chains", "[outline]") {
  constexpr int kCount = 20000;
  const auto at = [](int i, double radius, double height) {
    const double angle = 2 * std::numbers::pi * i / kCount;
    return glm::vec3(radius * std::cos(angle), radius * std::sin(angle), height);
  };
  PolygonModel model;
  std::size_t most = 10;  // groups
  SECTION("triangles around a polygon of as many corners") {
    std::vector<glm::vec3> hub;
    for (int i = 0; i < kCount; ++i) hub.push_back(at(i, 1, 0));
    add_polygon(model, hub);
    for (int i = 0; i < kCount; ++i) add_polygon(model, {at(i, 1, 0), at(i + 1, 1.5, 0.001), at(i + 1, 1, 0)});
  }
  SECTION("triangles around a point") {
    for (int i = 0; i < kCount; ++i) add_polygon(model, {{0, 0, 0.3f}, at(i, 1, 0), at(i + 1, 1, 0)});
  }
  SECTION("triangles at one edge") {
    most = kCount;  // no two polygons are neighbours
    for (int i = 0; i < kCount; ++i) add_polygon(model, {{0, 0, -1}, {0, 0, 1}, at(i, 1, 0)});
  }
  SECTION("a strip that bends more and more") {
    for (int i = 0; i < kCount; ++i) {
      const auto x = static_cast<float>(i) / kCount, next = static_cast<float>(i + 1) / kCount;
      add_polygon(model,
                  {{x, 0, x * x * x}, {next, 0, next * next * next}, {next, 1, next * next * next}, {x, 1, x * x * x}});
    }
  }
  OutlineOptions options;
  options.tolerance = 0.05;
  options.outline_tolerance = 0.01;
  const OutlineGroups made = groups_of(model, options);
  CHECK(made.groups.size() > 0);
  CHECK(made.groups.size() <= most);
  require_sound(model, made);
}

}  // namespace gs::qnv
