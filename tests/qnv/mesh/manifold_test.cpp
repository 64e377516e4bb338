#include "qnv/mesh/manifold.h"

#include "tests/qnv/codecs/displaced/displaced_shapes.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <limits>
#include <random>

namespace gs::qnv::displaced::manifold_test {
namespace {

void check_manifold(const SurfaceMesh& mesh) {
  CHECK(sides_once(mesh.triangles));
  CHECK(one_fan_a_vertex(mesh.triangles));
  CHECK(mesh.normals.size() == mesh.triangles.size());
  CHECK((mesh.colors.empty() || mesh.colors.size() == mesh.positions.size()));
  for (const Corners& t : mesh.triangles) {
    CHECK((t[0] != t[1] && t[1] != t[2] && t[2] != t[0]));
    CHECK(*std::max_element(t.begin(), t.end()) < mesh.positions.size());
  }
}

const glm::vec3 kA(0, 0, 0), kB(1, 0, 0), kC(0, 1, 0), kD(0, -1, 0), kE(0, 0, 1), kF(0, 0, -1);

}  // namespace

TEST_CASE("welds equal positions and keeps a closed surface closed") {
  const SurfaceMesh mesh = mesh_of(ball(7));
  check_manifold(mesh);
  CHECK(mesh.triangles.size() == 8 * 49);
  CHECK(mesh.positions.size() == 4 * 49 + 2);  // V - E + F = 2
  CHECK(rims_of(mesh.triangles) == 0);
}

TEST_CASE("cuts an edge where three or more triangles meet") {
  const SurfaceMesh mesh =
      mesh_of({triangle_of(kA, kB, kC), triangle_of(kB, kA, kD), triangle_of(kA, kB, kE), triangle_of(kB, kA, kF)});
  check_manifold(mesh);
  CHECK(mesh.triangles.size() == 4);
}

TEST_CASE("keeps one of several triangles with equal corners, whichever way they face") {
  const SurfaceMesh mesh = mesh_of({triangle_of(kA, kB, kC), triangle_of(kB, kC, kA), triangle_of(kC, kB, kA)});
  check_manifold(mesh);
  CHECK(mesh.triangles.size() == 1);
  check_manifold(mesh_of(two_sided_sheet()));
  CHECK(mesh_of(two_sided_sheet()).triangles.size() == 2);
}

TEST_CASE("gives each of two fans that meet at a vertex its own vertex") {
  const SurfaceMesh mesh = mesh_of({triangle_of(kA, kB, kC), triangle_of(kA, kD, kE)});
  check_manifold(mesh);
  CHECK(mesh.positions.size() == 6);
  Triangles two = ball(3);
  for (Triangle t : ball(3)) {
    for (glm::vec3& p : t.positions) p.x = p.x == -1 ? 1 : p.x + 2;  // the balls touch at a pole
    two.push_back(t);
  }
  const SurfaceMesh balls = mesh_of(two);
  check_manifold(balls);
  CHECK(components_of(balls.triangles) == 2);
  CHECK(rims_of(balls.triangles) == 0);
}

TEST_CASE("separates neighbours that face opposite ways") {
  const SurfaceMesh mesh = mesh_of({triangle_of(kA, kB, kC), triangle_of(kA, kB, kD)});
  check_manifold(mesh);
  CHECK(mesh.positions.size() == 6);
}

TEST_CASE("drops triangles without area or with positions that are not finite") {
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  const SurfaceMesh mesh = mesh_of({triangle_of(kA, kA, kC), triangle_of(kA, {nan, 0, 0}, kC),
                                    triangle_of({inf, 0, 0}, kB, kC), triangle_of(kA, kB, kC)});
  CHECK(mesh.triangles.size() == 1);
}

TEST_CASE("makes a manifold with colours of any set of triangles") {
  std::mt19937 random(9);
  for (std::size_t round = 0; round < 30; ++round) {
    // There are only few positions, so many triangles share corners.
    Triangles heap;
    for (int i = 0; i < 120; ++i) {
      const auto place = [&] { return glm::vec3(random() % 3, random() % 3, random() % 3); };
      const glm::vec3 a = place(), b = place(), c = place();
      heap.push_back(triangle_of(a, b, c, {static_cast<std::uint8_t>(random()), 9, 200}));
    }
    check_manifold(mesh_of(heap, true));
  }
}

TEST_CASE("returns a manifold with its neighbours and numbers vertices by first use") {
  const bool whole = GENERATE(true, false);
  const int size = GENERATE(6, 200);  // on one thread and on several
  Triangles heap = sheet(size);
  std::mt19937 random(5);
  if (!whole)
    for (std::size_t i = 0; i < heap.size(); i += 7) {
      // Reversed, repeated, or moved to another triangle.
      const auto change = random() % 3;
      if (change == 0) std::swap(heap[i].positions[0], heap[i].positions[1]);
      if (change == 1) heap.push_back(heap[i]);
      if (change == 2) heap[i].positions[0] = heap[random() % heap.size()].positions[2];
    }
  MeshBuilder builder(false);
  builder.add(heap);
  Neighbours beside;
  const SurfaceMesh mesh = builder.finish(&beside);
  CHECK(beside == neighbours_of(mesh.triangles));
  CHECK(sides_once(mesh.triangles));
  CHECK(one_fan_a_vertex(mesh.triangles));
  std::uint32_t named = 0;
  bool in_order = true;
  for (const Corners& t : mesh.triangles)
    for (const std::uint32_t v : t) {
      in_order = in_order && v <= named;
      named = std::max(named, v + 1);
    }
  CHECK(in_order);
  CHECK(named == mesh.positions.size());
}

TEST_CASE("stores each neighbour at the edge that the triangles share") {
  const SurfaceMesh mesh = mesh_of(sheet(12));
  const auto beside = neighbours_of(mesh.triangles);
  std::size_t ends = 0;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      if (beside[t][k] == kNone) {
        ++ends;
        continue;
      }
      const Corners& other = mesh.triangles[beside[t][k]];
      bool found = false;
      for (std::size_t l = 0; l < 3; ++l)
        found = found || (other[l] == mesh.triangles[t][(k + 1) % 3] && other[(l + 1) % 3] == mesh.triangles[t][k] &&
                          beside[beside[t][k]][l] == t);
      CHECK(found);
    }
  CHECK(ends == rims_of(mesh.triangles));
}

}  // namespace gs::qnv::displaced::manifold_test
