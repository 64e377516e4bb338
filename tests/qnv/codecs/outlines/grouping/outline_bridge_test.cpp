#include "qnv/codecs/outlines/grouping/outline_groups.h"

#include "tests/qnv/outline_models.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <random>

namespace gs::qnv {
namespace {

// Polygon of rings in the plane z = 0.
struct Rings {
  std::vector<glm::vec3> positions;
  std::vector<std::uint32_t> ends;

  void add(const std::vector<glm::vec2>& ring, bool reversed = false) {
    for (const glm::vec2& p : ring) positions.emplace_back(p, 0.0f);
    const auto begin = positions.end() - static_cast<std::ptrdiff_t>(ring.size());
    if (reversed) std::reverse(begin, positions.end());
    ends.push_back(static_cast<std::uint32_t>(positions.size()));
  }
  void add_hole(float x, float y, float size) { add({{x, y}, {x, y + size}, {x + size, y + size}, {x + size, y}}); }
  [[nodiscard]] OutlinePolygon view() const {
    OutlinePolygon polygon;
    polygon.positions = positions;
    polygon.ring_ends = ends;
    return polygon;
  }
};

double turn(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  return (double{b.x} - a.x) * (double{c.y} - a.y) - (double{b.y} - a.y) * (double{c.x} - a.x);
}

// Checks that every corner occurs, that the area is the polygon's, and that no two edges cross.
void require_simple(const Rings& rings, double area) {
  const auto indices = bridged_ring(rings.view());
  REQUIRE(indices.size() == rings.positions.size() + 2 * (rings.ends.size() - 1));
  std::vector<glm::vec3> ring;
  std::vector<std::uint8_t> seen(rings.positions.size());
  for (const std::uint32_t i : indices) {
    REQUIRE(i < rings.positions.size());
    seen[i] = 1;
    ring.push_back(rings.positions[i]);
  }
  CHECK(std::count(seen.begin(), seen.end(), 0) == 0);
  CHECK(vector_area(ring).z == Approx(area));
  std::size_t crossings = 0;
  for (std::size_t i = 0; i < ring.size(); ++i)
    for (std::size_t j = i + 1; j < ring.size(); ++j) {
      const glm::vec3 &a = ring[i], &b = ring[(i + 1) % ring.size()], &c = ring[j], &d = ring[(j + 1) % ring.size()];
      crossings += turn(a, b, c) * turn(a, b, d) < 0 && turn(c, d, a) * turn(c, d, b) < 0;
    }
  REQUIRE(crossings == 0);
}

}  // namespace

TEST_CASE("keeps a ring without holes unchanged", "[outline]") {
  Rings rings;
  rings.add({{0, 0}, {2, 0}, {2, 2}, {0, 2}});
  CHECK(bridged_ring(rings.view()) == std::vector<std::uint32_t>{0, 1, 2, 3});
  CHECK(bridged_ring({}).empty());
}

TEST_CASE("connects holes by bridges, whatever their order is", "[outline]") {
  Rings rings;
  rings.add({{0, 0}, {10, 0}, {10, 3}, {0, 3}});
  SECTION("left to right") {
    for (int i = 0; i < 4; ++i) rings.add_hole(1.0f + 2.0f * static_cast<float>(i), 1, 1);
  }
  SECTION("right to left") {
    for (int i = 3; i >= 0; --i) rings.add_hole(1.0f + 2.0f * static_cast<float>(i), 1, 1);
  }
  require_simple(rings, 26);
}

TEST_CASE("avoids bridges across corners that hide each other", "[outline]") {
  Rings rings;  // a comb with its teeth between the left side and the hole
  rings.add({{0, 0}, {8, 0}, {8, 8}, {0, 8}, {0, 7}, {5, 4.2f}, {0, 6}, {0, 2}, {5, 3.8f}, {0, 1}});
  rings.add_hole(6, 3.5f, 1);
  glm::dvec3 outer = vector_area(std::vector(rings.positions.begin(), rings.positions.begin() + 10));
  require_simple(rings, outer.z - 1);
}

TEST_CASE("adds no bridge to holes that touch the outer ring or each other at a vertex", "[outline]") {
  Rings rings;
  rings.add({{0, 0}, {4, 0}, {4, 4}, {0, 4}, {0, 2}});
  rings.add({{0, 2}, {1, 3}, {2, 2}, {1, 1}});
  rings.add({{2, 2}, {3, 3}, {3, 1}});
  require_simple(rings, 16 - 2 - 1);
}

TEST_CASE("connects many holes at random positions", "[outline]") {
  std::mt19937 random(5);
  for (int round = 0; round < 40; ++round) {
    Rings rings;
    rings.add({{0, 0}, {8, 0}, {8, 8}, {0, 8}});
    std::vector<int> cells(64);
    for (int i = 0; i < 64; ++i) cells[static_cast<std::size_t>(i)] = i;
    std::shuffle(cells.begin(), cells.end(), random);
    double area = 64;
    for (int i = 0; i < 30; ++i) {
      const auto cell = static_cast<unsigned>(cells[static_cast<std::size_t>(i)]);
      const auto part = [&] { return static_cast<float>(random() % 16) / 64.0f; };
      const glm::vec2 corner(static_cast<float>(cell % 8) + part(), static_cast<float>(cell / 8) + part());
      std::vector<glm::vec2> hole{corner + glm::vec2(0.01f, 0.25f + part()), corner + glm::vec2(0.25f + part(), 0.7f),
                                  corner + glm::vec2(0.7f, 0.1f)};
      rings.add(hole);
      area += vector_area(std::vector(rings.positions.end() - 3, rings.positions.end())).z;
    }
    require_simple(rings, area);
  }
}

TEST_CASE("connects four hundred holes in rows", "[outline]") {
  Rings rings;
  rings.add({{0, 0}, {41, 0}, {41, 41}, {0, 41}});
  for (int x = 0; x < 20; ++x)
    for (int y = 0; y < 20; ++y)
      rings.add_hole(1.0f + 2.0f * static_cast<float>(x),
                     1.0f + 2.0f * static_cast<float>(y) + static_cast<float>(x % 2) * 0.5f, 1);
  const auto indices = bridged_ring(rings.view());
  REQUIRE(indices.size() == rings.positions.size() + 800);
  std::vector<glm::vec3> ring;
  for (const std::uint32_t i : indices) ring.push_back(rings.positions[i]);
  CHECK(vector_area(ring).z == Approx(41 * 41 - 400));
}

TEST_CASE("drops a hole outside its polygon", "[outline]") {
  Rings rings;
  rings.add({{0, 0}, {1, 0}, {1, 1}, {0, 1}});
  rings.add_hole(-5, 0, 1);
  CHECK(bridged_ring(rings.view()).size() == 4);
}

}  // namespace gs::qnv
