#include "qnv/codecs/outlines/grouping/outline_groups.h"

#include "tests/qnv/outline_models.h"

#include <catch2/catch.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

namespace gs::qnv {
namespace {

using PlaceKey = std::tuple<float, float, float>;
PlaceKey place_key(const glm::vec3& p) { return {p.x, p.y, p.z}; }

// Counts of outlines along each directed edge.
std::map<std::pair<PlaceKey, PlaceKey>, int> outline_edges(const OutlineGroups& made) {
  std::map<std::pair<PlaceKey, PlaceKey>, int> edges;
  for (const OutlineGroup& group : made.groups)
    for (std::size_t i = 0; i < group.outline.size(); ++i)
      for (std::size_t r = 0; r < group.outline[i].rings(); ++r) {
        const auto ring = group.outline[i].ring(r);
        for (std::size_t k = 0; k < ring.size(); ++k)
          ++edges[{place_key(ring[k]), place_key(ring[(k + 1) % ring.size()])}];
      }
  return edges;
}

void require_closed(const OutlineGroups& made) {
  const auto edges = outline_edges(made);
  std::size_t wrong = 0;
  for (const auto& [edge, count] : edges) {
    const auto back = edges.find({edge.second, edge.first});
    wrong += count != 1 || back == edges.end() || back->second != 1;
  }
  REQUIRE(wrong == 0);
}

bool same_polygons(const OutlinePolygons& a, const OutlinePolygons& b) {
  return a.positions == b.positions && a.texture_coordinates == b.texture_coordinates && a.ring_ends == b.ring_ends &&
         a.polygon_ends == b.polygon_ends && a.areas == b.areas;
}

bool same_groups(const OutlineGroups& a, const OutlineGroups& b) {
  return a.group_of == b.group_of &&
         std::equal(a.groups.begin(), a.groups.end(), b.groups.begin(), b.groups.end(),
                    [](const OutlineGroup& x, const OutlineGroup& y) {
                      return x.normal == y.normal && x.offset == y.offset && x.deviation == y.deviation &&
                             x.area == y.area && same_polygons(x.outline, y.outline) && same_polygons(x.inner, y.inner);
                    });
}

}  // namespace

TEST_CASE("groups a cube of twelve triangles into six squares", "[outline]") {
  PolygonModel model;
  add_cube(model);
  for (const double tolerance : {0.0, 0.01}) {
    OutlineOptions options;
    options.tolerance = tolerance;
    const OutlineGroups made = groups_of(model, options);
    REQUIRE(made.groups.size() == 6);
    CHECK(made.counts.merged == 6);
    CHECK(made.counts.border_edges == 0);
    CHECK(made.counts.unusual_edges == 0);
    std::set<PlaceKey> normals;
    for (const OutlineGroup& group : made.groups) {
      CHECK(group.polygons == 2);
      CHECK(group.area == 1.0);
      CHECK(group.deviation == 0.0);
      CHECK(group.inner.empty());
      REQUIRE(group.outline.size() == 1);
      REQUIRE(group.outline[0].rings() == 1);
      REQUIRE(group.outline[0].ring(0).size() == 4);
      CHECK(vector_area(group.outline[0].ring(0)) == glm::dvec3(group.normal));
      CHECK(group.offset ==
            std::max({group.normal.x, group.normal.y, group.normal.z}));  // 1 for sides at 1, 0 for sides at 0
      normals.insert(place_key(group.normal + 0.0f));
    }
    CHECK(normals.size() == 6);
    require_closed(made);
  }
}

TEST_CASE("separates polygons of different appearance", "[outline]") {
  PolygonModel model;
  add_square(model, 0, 0, 7);
  add_square(model, 1, 0, 9);
  add_square(model, 2, 0, 9);
  const OutlineGroups made = groups_of(model);
  REQUIRE(made.groups.size() == 2);
  CHECK(made.groups[0].appearance == 9);
  CHECK(made.groups[0].area == 2.0);
  CHECK(made.groups[1].appearance == 7);
  CHECK(made.group_of == std::vector<std::uint32_t>{1, 0, 0});
}

TEST_CASE("splits an open sheet with one bend into two groups", "[outline]") {
  PolygonModel model;
  for (int i = 0; i < 4; ++i) add_square(model, static_cast<float>(i), 0);
  for (int i = 0; i < 4; ++i) {
    const auto x = static_cast<float>(i);
    add_polygon(model, {{x, 1, 0}, {x + 1, 1, 0}, {x + 1, 1, 1}, {x, 1, 1}});
  }
  OutlineOptions options;
  options.tolerance = 0.2;
  const OutlineGroups made = groups_of(model, options);
  REQUIRE(made.groups.size() == 2);
  for (const OutlineGroup& group : made.groups) CHECK(group.area == 4.0);
  CHECK(made.counts.border_edges == 12);  // per half, a long side and two short ones
}

TEST_CASE("groups coplanar polygons across an edge that a third polygon shares", "[outline]") {
  PolygonModel model;
  add_square(model, 0, 0);
  add_square(model, -1, 0);
  add_polygon(model, {{0, 0, 0}, {0, 1, 0}, {0, 1, 1}, {0, 0, 1}});  // perpendicular, on the common edge
  const OutlineGroups made = groups_of(model);
  REQUIRE(made.groups.size() == 2);
  CHECK(made.groups[0].area == 2.0);
  CHECK(made.groups[1].area == 1.0);
  CHECK(made.counts.unusual_edges == 1);
}

TEST_CASE("cuts a Moebius strip where its sides turn over", "[outline]") {
  PolygonModel model;
  constexpr int kCount = 60;
  const auto at = [](int i, double side) {
    const double turn = 2 * std::numbers::pi * i / kCount, twist = turn / 2;
    const double radius = 3 + side * std::cos(twist);
    return glm::vec3(radius * std::cos(turn), radius * std::sin(turn), side * std::sin(twist));
  };
  for (int i = 0; i < kCount; ++i) {
    const bool last = i + 1 == kCount;  // here the two sides swap
    add_polygon(model, {at(i, -1), at(i, 1), at(last ? 0 : i + 1, last ? -1 : 1), at(last ? 0 : i + 1, last ? 1 : -1)});
  }
  OutlineOptions options;
  options.tolerance = 0.3;
  const OutlineGroups made = groups_of(model, options);
  CHECK(made.counts.unusual_edges == 1);
  CHECK(made.counts.border_edges == 2 * kCount);
  CHECK(made.groups.size() > 4);
  CHECK(made.groups.size() < 30);
  std::uint32_t polygons = 0;
  for (const OutlineGroup& group : made.groups) polygons += group.polygons;
  CHECK(polygons == kCount);
}

TEST_CASE("keeps duplicate polygons once per facing", "[outline]") {
  PolygonModel model;
  add_cube(model);
  add_cube(model);
  OutlineGroups made = groups_of(model);
  CHECK(made.groups.size() == 6);
  CHECK(made.counts.duplicates == 12);
  CHECK(std::count(made.group_of.begin(), made.group_of.end(), OutlineGroups::kNoGroup) == 12);
  add_cube(model, true);
  made = groups_of(model);
  CHECK(made.counts.duplicates == 12);
  REQUIRE(made.groups.size() == 12);
  for (const OutlineGroup& group : made.groups) CHECK(group.area == 1.0);
}

TEST_CASE("keeps groups of a sphere within the tolerances", "[outline]") {
  const PolygonModel model = sphere_model(24);
  OutlineOptions options;
  options.tolerance = 0.02;
  options.angle = 0.5;
  options.outline_tolerance = GENERATE(0.0, 0.03);
  options.groups = GENERATE(std::size_t{0}, std::size_t{300});
  const OutlineGroups made = groups_of(model, options);
  CHECK(made.counts.polygons == 8 * 24 * 24);
  // A cap of height 0.04 covers 0.02 of the sphere, so there are at least 50.
  CHECK(made.groups.size() >= 50);
  CHECK(made.groups.size() < 200 + options.groups);
  if (options.groups > 0) CHECK(made.groups.size() == 300);
  std::vector<double> areas(made.groups.size());
  std::vector<std::uint32_t> counts(made.groups.size());
  double whole = 0;
  for (std::size_t i = 0; i < model.ends.size(); ++i) {
    const std::array<glm::vec3, 3> corners{model.positions[3 * i], model.positions[3 * i + 1],
                                           model.positions[3 * i + 2]};
    REQUIRE(made.group_of[i] < made.groups.size());
    const OutlineGroup& group = made.groups[made.group_of[i]];
    const glm::dvec3 area = vector_area(corners);
    areas[made.group_of[i]] += glm::length(area);
    ++counts[made.group_of[i]];
    whole += glm::length(area);
    REQUIRE(glm::dot(glm::normalize(area), glm::dvec3(group.normal)) > std::cos(0.5) - 1e-6);
    for (const glm::vec3& p : corners)
      REQUIRE(std::fabs(glm::dot(glm::dvec3(group.normal), glm::dvec3(p)) - group.offset) <= group.deviation + 1e-6);
  }
  double sum = 0;
  for (std::size_t i = 0; i < made.groups.size(); ++i) {
    const OutlineGroup& group = made.groups[i];
    CHECK(group.deviation <= 0.02 + 1e-9);
    CHECK(group.polygons == counts[i]);
    REQUIRE(group.area == Approx(areas[i]));
    REQUIRE(area_of(surface_of(group)) == Approx(areas[i]));
    if (i > 0) REQUIRE(group.area <= made.groups[i - 1].area);
    REQUIRE(std::is_sorted(group.inner.areas.rbegin(), group.inner.areas.rend()));
    sum += group.area;
  }
  CHECK(sum == Approx(whole));
  require_closed(made);
}

TEST_CASE("simplifies outlines to fewer corners that still meet", "[outline]") {
  const PolygonModel model = sphere_model(24);
  OutlineOptions options;
  options.tolerance = 0.02;
  std::size_t before = 0;
  for (const double tolerance : {0.0, 0.003, 0.01, 0.03}) {
    options.outline_tolerance = tolerance;
    const OutlineGroups made = groups_of(model, options);
    std::size_t corners = 0;
    for (const OutlineGroup& group : made.groups) corners += group.outline.positions.size();
    if (before > 0) CHECK(corners < before);
    before = corners;
    require_closed(made);
  }
}

TEST_CASE("groups polygons equally on any number of threads", "[outline]") {
  const PolygonModel model = sphere_model(40);
  OutlineOptions options;
  options.tolerance = 0.01;
  options.outline_tolerance = 0.004;
  options.threads = 1;
  const OutlineGroups first = groups_of(model, options);
  for (const unsigned threads : {2u, 3u, 7u}) {
    options.threads = threads;
    CHECK(same_groups(first, groups_of(model, options)));
  }
}

TEST_CASE("makes the requested number of groups", "[outline]") {
  const PolygonModel model = sphere_model(32);
  OutlineOptions options;
  options.tolerance = INFINITY;
  options.angle = 1.2;
  for (const std::size_t count : {500u, 180u, 40u}) {
    options.groups = count;
    CHECK(groups_of(model, options).groups.size() == count);
  }
}

TEST_CASE("stops grouping on cancellation", "[outline]") {
  Progress progress;
  progress.cancelled = true;
  const auto made = group_outlines(sphere_model(4), {}, &progress);
  REQUIRE(std::holds_alternative<OutlineError>(made));
  CHECK(std::get<OutlineError>(made).message == "cancelled");
}

}  // namespace gs::qnv
