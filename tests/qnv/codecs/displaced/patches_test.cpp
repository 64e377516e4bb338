#include "qnv/codecs/displaced/patches.h"

#include "qnv/codecs/displaced/subdivision.h"
#include "tests/qnv/codecs/displaced/displaced_shapes.h"

#include <catch2/catch.hpp>

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

namespace gs::qnv::displaced::patches_test {
namespace {

Patches patches_of(const SurfaceMesh& mesh) {
  return {mesh.triangles, static_cast<std::uint32_t>(mesh.positions.size())};
}

/// Returns the square (0, 1, 2, 3), divided from 0 to 2.
Patches square() { return {{{0, 1, 2}, {0, 2, 3}}, 4}; }

}  // namespace

TEST_CASE("numbers each vertex of a level once, shared by the neighbouring patches") {
  for (const Triangles& shape : {ball(2), torus(7, 5), sheet(9)}) {
    const Patches patches = patches_of(mesh_of(shape));
    for (int level = 0; level <= 4; ++level) {
      const std::size_t n = std::size_t{1} << level;
      std::vector<int> seen(patches.vertices_at(level), 0);
      std::vector<std::uint32_t> grid;
      for (std::uint32_t p = 0; p < patches.size(); ++p) {
        patches.grid(p, level, grid);
        REQUIRE(grid.size() == (n + 1) * (n + 2) / 2);
        std::vector<std::uint32_t> sorted = grid;
        std::sort(sorted.begin(), sorted.end());
        CHECK(std::adjacent_find(sorted.begin(), sorted.end()) == sorted.end());
        for (const std::uint32_t v : grid) {
          REQUIRE(v < seen.size());
          ++seen[v];
        }
      }
      // All vertices occur. Vertices inside an edge occur once per adjacent patch.
      CHECK(std::find(seen.begin(), seen.end(), 0) == seen.end());
      for (std::uint32_t e = 0; e < patches.edges().size(); ++e)
        for (std::size_t t = 0; t + 1 < n; ++t)
          CHECK(seen[patches.edge_start(e, level) + t] == (patches.edges()[e].other == kNone ? 1 : 2));
      for (std::size_t v = patches.inner_start(0, level); v < seen.size(); ++v) CHECK(seen[v] == 1);
    }
  }
}

TEST_CASE("numbers edges by the first patch at them, starting at its corners") {
  const Patches patches = square();
  REQUIRE(patches.edges().size() == 5);
  CHECK(patches.edge(0, 2) == patches.edge(1, 0));
  CHECK(patches.edges()[2].from == 2);
  CHECK(patches.edges()[2].to == 0);
  CHECK(patches.owns(0, 2));
  CHECK(!patches.owns(1, 0));
  CHECK(patches.owner(3) == 1);
  CHECK(patches.vertices_at(0) == 4);
  CHECK(patches.vertices_at(1) == 9);
  CHECK(patches.vertices_at(2) == 25);
  // The rows of the grid begin with j = 0.
  std::vector<std::uint32_t> grid;
  patches.grid(1, 1, grid);
  CHECK(grid == std::vector<std::uint32_t>{0, 6, 2, 8, 7, 3});
  CHECK(row_start(0, 4) == 0);
  CHECK(row_start(1, 4) == 5);
  CHECK(row_start(4, 4) == 14);
}

TEST_CASE("places each new vertex of a level between two ends of an edge of the level before") {
  const Patches patches = patches_of(mesh_of(sheet(6)));
  for (int level = 1; level <= 3; ++level) {
    std::vector<int> visited(patches.vertices_at(level), 0);
    std::vector<bool> kept(patches.vertices_at(level - 1), false);
    visit_level(
        patches, patches.cut(), level,
        [&](const NewVertex& v) {
          ++visited[v.vertex];
          CHECK(v.a != v.b);
          CHECK(std::max(v.a, v.b) < kept.size());
        },
        [&](std::uint32_t v, std::uint32_t before) {
          ++visited[v];
          CHECK(!kept[before]);
          kept[before] = true;
        });
    CHECK(std::all_of(visited.begin(), visited.end(), [](int times) { return times == 1; }));
    CHECK(std::find(kept.begin(), kept.end(), false) == kept.end());
  }
}

TEST_CASE("splits vertices along creases between the patches on either side") {
  Patches patches = square();
  CHECK(patches.has_lines());  // boundary edges
  CHECK(patches.cut().base_vertices() == 4);
  std::vector<bool> creases(5, false);
  creases[2] = true;
  creases[0] = true;  // no crease at a boundary
  patches.set_creases(creases);
  CHECK(!patches.edges()[0].crease);
  CHECK(patches.edges()[2].crease);
  const Patches cut = patches.cut();
  CHECK(cut.base_vertices() == 6);
  CHECK(cut.edges().size() == 6);
  // A crease that ends inside a surface splits nothing at its end.
  Patches round = patches_of(mesh_of(ball(3)));
  CHECK(!round.has_lines());
  std::vector<bool> one(round.edges().size(), false);
  one[5] = true;
  round.set_creases(one);
  CHECK(round.has_lines());
  CHECK(round.cut().base_vertices() == round.base_vertices());
}

TEST_CASE("computes normals at creases and boundaries to the same bits on any number of threads") {
  for (const Triangles& shape : {ball(6), torus(9, 7), sheet(9)}) {
    Patches patches = patches_of(mesh_of(shape));
    std::vector<bool> creases(patches.edges().size(), false);
    for (std::size_t e = 0; e < creases.size(); e += 3) creases[e] = true;
    patches.set_creases(creases);
    const Patches cut = patches.cut();
    CHECK(cut.base_vertices() > patches.base_vertices());
    for (int level = 0; level <= 3; ++level) {
      std::vector<glm::vec3> places(patches.vertices_at(level));
      // The sum of these numbers depends on their order.
      for (std::size_t i = 0; i < places.size(); ++i) {
        const auto x = static_cast<float>(i);
        places[i] = {std::sin(1.7f * x), std::sin(2.3f * x + 1), std::sin(0.9f * x + 2)};
      }
      const std::vector<glm::vec3> normals = slot_normals(patches, cut, level, places, 1);
      REQUIRE(normals.size() == cut.vertices_at(level));
      std::size_t unit = 0;
      for (const glm::vec3& n : normals) unit += std::abs(glm::length(n) - 1) < 1e-5f ? 1 : 0;
      CHECK(unit == normals.size());
      for (const unsigned threads : {2u, 5u}) CHECK(slot_normals(patches, cut, level, places, threads) == normals);
    }
  }
}

}  // namespace gs::qnv::displaced::patches_test
