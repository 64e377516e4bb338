#include "qnv/mesh/simplify/simplify.h"

#include "qnv/mesh/simplify/simplifier.h"
#include "tests/qnv/codecs/displaced/displaced_shapes.h"

#include <glm/geometric.hpp>

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <span>
#include <vector>

namespace gs::qnv::displaced::simplify_test {
namespace {

void check_manifold(const SurfaceMesh& mesh) {
  CHECK(sides_once(mesh.triangles));
  CHECK(one_fan_a_vertex(mesh.triangles));
}

}  // namespace

TEST_CASE("simplifies a closed surface to the requested count, and keeps it closed and near") {
  const SurfaceMesh mesh = mesh_of(ball(30));
  for (const std::size_t wanted : {4000, 1000, 300, 60}) {
    const SurfaceMesh small = simplify(mesh, wanted);
    check_manifold(small);
    CHECK(small.triangles.size() <= wanted);
    CHECK(small.triangles.size() >= wanted - 2);
    CHECK(rims_of(small.triangles) == 0);
    CHECK(euler_characteristic(small.triangles) == 2);
    // The sagitta of triangles of area a = 4 pi / n is about a / 6.
    for (const glm::vec3& p : small.positions)
      CHECK(glm::length(p) == Approx(1).margin(12.0 / static_cast<double>(wanted)));
  }
}

TEST_CASE("keeps the hole of a torus") {
  const SurfaceMesh small = simplify(mesh_of(torus(60, 30)), 150);
  check_manifold(small);
  CHECK(small.triangles.size() <= 150);
  CHECK(euler_characteristic(small.triangles) == 0);
}

TEST_CASE("keeps both boundaries of a sheet with a hole") {
  const SurfaceMesh mesh = mesh_of(sheet(60)), small = simplify(mesh, 200);
  check_manifold(small);
  CHECK(small.triangles.size() <= 200);
  CHECK(euler_characteristic(mesh.triangles) == 0);
  CHECK(euler_characteristic(small.triangles) == 0);
  CHECK(rims_of(small.triangles) > 8);
}

TEST_CASE("keeps every component, however few triangles are requested") {
  Triangles many;
  for (int i = 0; i < 12; ++i)
    for (Triangle t : ball(3 + i % 3)) {
      for (glm::vec3& p : t.positions) p = p * (i % 2 ? 0.05f : 1.0f) + glm::vec3(3 * i, 0, 0);
      many.push_back(t);
    }
  many.push_back(triangle_of({0, 4, 0}, {1, 4, 0}, {0, 5, 0}));
  const SurfaceMesh small = simplify(mesh_of(many), 1);
  check_manifold(small);
  CHECK(components_of(small.triangles) == 13);
  CHECK(small.triangles.size() >= 12 * 4 + 1);
  CHECK(small.triangles.size() < 12 * 30);
  // All parts but the last become tetrahedra.
  CHECK(euler_characteristic(small.triangles) == 12 * 2 + 1);
}

TEST_CASE("simplifies a mesh in parts without cracks on any number of threads") {
  const std::array<SurfaceMesh, 3> meshes{mesh_of(ball(24)), mesh_of(torus(60, 30)), mesh_of(sheet(50))};
  for (const SurfaceMesh& mesh : meshes)
    for (const std::size_t parts : {2, 8}) {
      const SurfaceMesh thin = thinned(mesh, 200, parts, 1), other = thinned(mesh, 200, parts, 3);
      CHECK(thin.triangles == other.triangles);
      CHECK(thin.positions == other.positions);
      check_manifold(thin);
      CHECK(euler_characteristic(thin.triangles) == euler_characteristic(mesh.triangles));
      CHECK(components_of(thin.triangles) == 1);
      CHECK((rims_of(thin.triangles) == 0) == (rims_of(mesh.triangles) == 0));
      CHECK(thin.triangles.size() < mesh.triangles.size() * 3 / 4);
      CHECK(thin.triangles.size() > 750);  // four times the requested number, within rounding
    }
}

TEST_CASE("simplifies the parts of a mesh with any number of ranks") {
  const SurfaceMesh mesh = mesh_of(torus(60, 30));
  const SurfaceMesh alone = thinned(mesh, 200, 8, 1);
  for (const std::uint32_t count : {2u, 3u, 11u}) {
    std::vector<std::vector<std::byte>> parts(count);
    // Runs the other ranks first, so that rank 0 finds their parts.
    for (std::uint32_t rank = count; rank-- > 0;) {
      const SimplifyRanks ranks{rank, count, [&](std::span<const std::byte> own) {
                                  parts[rank].assign(own.begin(), own.end());
                                  std::vector<std::byte> all;
                                  for (const auto& part : parts) all.insert(all.end(), part.begin(), part.end());
                                  return all;
                                }};
      const SurfaceMesh thin = thinned(mesh, 200, 8, 1, ranks);
      CHECK(thin.triangles == (rank == 0 ? alone.triangles : std::vector<Corners>{}));
      CHECK(thin.positions == (rank == 0 ? alone.positions : std::vector<glm::vec3>{}));
    }
  }
}

TEST_CASE("sorts edge costs in order, equal ones by insertion") {
  CostQueue queue;
  std::mt19937 random(5);
  std::vector<double> costs;
  Candidate next{};
  CHECK(!queue.pop(next));
  for (std::uint32_t i = 0; i < 3000; ++i) {
    costs.push_back(i % 50 == 0 ? 0.0
                                : std::ldexp(1 + static_cast<double>(random() % 1000) / 1000,
                                             static_cast<int>(random() % 60) - 50));
    queue.push(costs.back(), {i, 0, 0});
  }
  double last = 0;
  std::size_t count = 0;
  for (; queue.pop(next); ++count) {
    CHECK(costs[next.u] >= last / 1.032);
    last = std::max(last, costs[next.u]);
    // An entry of lower cost than the next one comes first.
    if (count == 1500) {
      queue.push(1e-40, {77, 1, 0});
      REQUIRE(queue.pop(next));
      CHECK(next.v == 1);
    }
  }
  CHECK(count == 3000);
  for (std::uint32_t i = 0; i < 10; ++i) queue.push(0.25, {i, 0, 0});
  for (std::uint32_t i = 0; i < 10; ++i) {
    REQUIRE(queue.pop(next));
    CHECK(next.u == i);
  }
}

TEST_CASE("simplifies an empty mesh to an empty mesh") {
  CHECK(simplify({}, 10).triangles.empty());
  const SurfaceMesh one = mesh_of({triangle_of({0, 0, 0}, {1, 0, 0}, {0, 1, 0})});
  CHECK(simplify(one, 0).triangles.size() == 1);
}

}  // namespace gs::qnv::displaced::simplify_test
