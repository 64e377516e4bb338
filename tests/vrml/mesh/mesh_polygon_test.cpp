#include "vrml/mesh/polygon.h"

#include <catch2/catch.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <numbers>
#include <random>

using namespace gs::vrml;

namespace {

using Polygon = std::vector<glm::vec3>;

struct Cut {
  std::size_t triangles = 0;
  double area = 0;          // sum of absolute areas
  double largest_back = 0;  // largest area of a triangle wound against the polygon
};

Cut cut(const Polygon& polygon) {
  PolygonTriangulator triangulator;
  const std::span<const std::uint32_t> indices = triangulator.triangulate(polygon);
  REQUIRE(indices.size() % 3 == 0);
  const glm::dvec3 normal = newell_vector(polygon);
  Cut result;
  result.triangles = indices.size() / 3;
  for (std::size_t i = 0; i < indices.size(); i += 3) {
    for (std::size_t j = i; j < i + 3; ++j) REQUIRE(indices[j] < polygon.size());
    const Polygon triangle = {polygon[indices[i]], polygon[indices[i + 1]], polygon[indices[i + 2]]};
    const glm::dvec3 area = newell_vector(triangle);
    result.area += glm::length(area) / 2;
    if (glm::dot(area, normal) < 0) result.largest_back = std::max(result.largest_back, glm::length(area) / 2);
  }
  return result;
}

double area_of(const Polygon& polygon) { return glm::length(newell_vector(polygon)) / 2; }

/// Checks that triangles cover a simple polygon exactly once.
void check_covered(const Polygon& polygon) {
  const Cut result = cut(polygon);
  CHECK(result.area == Approx(area_of(polygon)).epsilon(1e-6));
  CHECK(result.largest_back <= 1e-6 * area_of(polygon));
}

/// Returns a polygon around the origin, with radius(i) at angle i of n.
template <class Radius>
Polygon around(int n, const Radius& radius) {
  Polygon polygon;
  for (int i = 0; i < n; ++i) {
    const double angle = 2 * std::numbers::pi * i / n, r = radius(i);
    polygon.emplace_back(r * std::cos(angle), r * std::sin(angle), 0);
  }
  return polygon;
}

/// Returns the polygon in reverse, in the plane x = 0.
Polygon turned(Polygon polygon) {
  std::reverse(polygon.begin(), polygon.end());
  for (glm::vec3& p : polygon) p = {p.z, p.y, p.x};
  return polygon;
}

}  // namespace

TEST_CASE("returns a Newell vector that is normal to the polygon, with twice its area") {
  CHECK(newell_vector(Polygon{{0, 0, 5}, {2, 0, 5}, {2, 3, 5}, {0, 3, 5}}) == glm::dvec3(0, 0, 12));
  CHECK(newell_vector(Polygon{{0, 0, 0}, {1, 0, 0}}) == glm::dvec3(0));
}

TEST_CASE("returns no triangles for polygons with under three corners") {
  PolygonTriangulator triangulator;
  CHECK(triangulator.triangulate({}).empty());
  CHECK(triangulator.triangulate(Polygon{{0, 0, 0}, {1, 0, 0}}).empty());
}

TEST_CASE("cuts a concave quadrilateral at its reflex corner, whichever corner it is") {
  const Polygon dart = {{0, 0, 0}, {4, 0, 0}, {1, 1, 0}, {0, 4, 0}};
  for (std::ptrdiff_t shift = 0; shift < 4; ++shift) {
    Polygon polygon = dart;
    std::rotate(polygon.begin(), polygon.begin() + shift, polygon.end());
    CHECK(cut(polygon).triangles == 2);
    check_covered(polygon);
    check_covered(turned(polygon));
  }
}

TEST_CASE("covers simple polygons of n corners by n - 2 triangles") {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> between(0.3, 1.0);
  for (const int n : {5, 6, 12, 50, 301, 3000}) {
    const Polygon convex = around(n, [](int) { return 1.0; });
    const Polygon star = around(n, [](int i) { return i % 2 ? 1.0 : 0.4; });
    const Polygon ragged = around(n, [&](int) { return between(random); });
    for (const Polygon& polygon : {convex, star, ragged}) {
      CHECK(cut(polygon).triangles == static_cast<std::size_t>(n - 2));
      check_covered(polygon);
      check_covered(turned(polygon));
    }
  }
}

TEST_CASE("covers a spiral corridor with triangles") {
  Polygon spiral;
  for (int i = 0; i < 1000; ++i) {
    const double angle = 12 * std::numbers::pi * i / 1000;
    spiral.emplace_back((1 + angle) * std::cos(angle), (1 + angle) * std::sin(angle), 0);
  }
  for (int i = 999; i >= 0; --i) {
    const double angle = 12 * std::numbers::pi * i / 1000;
    spiral.emplace_back((2 + angle) * std::cos(angle), (2 + angle) * std::sin(angle), 0);
  }
  CHECK(cut(spiral).triangles == 1998);
  check_covered(spiral);
}

TEST_CASE("keeps holes open that are reached by cuts") {
  // The plate has rows of square holes. A cut from the left side leads along each row and back.
  Polygon plate = {{0, 0, 0}, {44, 0, 0}, {44, 40, 0}, {0, 40, 0}};
  for (int row = 9; row >= 0; --row) {
    const float y = 4.0f * static_cast<float>(row) + 2;
    plate.emplace_back(0, y, 0);
    for (int i = 0; i < 10; ++i) {
      const float x = 4.0f * static_cast<float>(i) + 3;
      for (const glm::vec3& p : {glm::vec3(x - 1, y, 0), {x - 1, y + 1, 0}, {x + 1, y + 1, 0}, {x + 1, y, 0}})
        plate.push_back(p);
    }
    for (int i = 9; i >= 0; --i) {
      const float x = 4.0f * static_cast<float>(i) + 3;
      for (const glm::vec3& p : {glm::vec3(x + 1, y, 0), {x + 1, y - 1, 0}, {x - 1, y - 1, 0}, {x - 1, y, 0}})
        plate.push_back(p);
    }
    plate.emplace_back(0, y, 0);
  }
  CHECK(area_of(plate) == Approx(44 * 40 - 100 * 4));
  check_covered(plate);
  check_covered(turned(plate));
}

TEST_CASE("triangulates polygons with coincident or collinear corners") {
  check_covered({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 0, 0}, {2, 2, 0}, {1, 2, 0}, {0, 2, 0}, {0, 1, 0}});
  check_covered({{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {3, 0, 0}, {3, 3, 0}});
  check_covered({{0, 0, 0}, {4, 0, 0}, {6, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}});  // with a spike
  CHECK(cut({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {4, 0, 0}}).area == 0);
  CHECK(cut(Polygon(9, glm::vec3(1, 2, 3))).area == 0);
}

TEST_CASE("covers polygons far from the origin and of any size") {
  const Polygon star = around(40, [](int i) { return i % 2 ? 1.0 : 0.4; });
  for (const float scale : {1e-18f, 1e-6f, 1e6f, 1e18f}) {
    Polygon scaled = star;
    for (glm::vec3& p : scaled) p *= scale;
    check_covered(scaled);
  }
  Polygon far = star;
  for (glm::vec3& p : far) p = p * 100.0f + glm::vec3(500000, 4000000, 300);
  check_covered(far);
}

TEST_CASE("returns some triangles for polygons that cross themselves") {
  std::mt19937 random(3);
  std::uniform_int_distribution<int> coarse(0, 9);
  std::uniform_real_distribution<float> fine(-1, 1);
  PolygonTriangulator triangulator;
  for (int round = 0; round < 400; ++round) {
    Polygon polygon(static_cast<std::size_t>(3 + round % 150));
    for (glm::vec3& p : polygon)
      p = round % 2 ? glm::vec3(fine(random), fine(random), fine(random))
                    : glm::vec3(coarse(random), coarse(random), 0);
    const std::span<const std::uint32_t> indices = triangulator.triangulate(polygon);
    REQUIRE(indices.size() <= 3 * (polygon.size() - 2));
    REQUIRE(std::all_of(indices.begin(), indices.end(), [&](std::uint32_t i) { return i < polygon.size(); }));
  }
  const Polygon huge = {{3e38f, 0, 0}, {-3e38f, 3e38f, 0}, {0, -3e38f, 0}, {1e-38f, 0, 0}, {3e38f, 3e38f, 3e38f}};
  CHECK(triangulator.triangulate(huge).size() <= 9);
}
