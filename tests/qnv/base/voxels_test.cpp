#include "qnv/base/voxels.h"

#include "qnv/base/morton.h"
#include "tests/qnv/surface_shapes.h"
#include "tests/watched.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <span>
#include <vector>

namespace gs::qnv {
namespace {

double area_of(std::span<const Voxel> voxels, const Cube& cube, int level) {
  const double edge = static_cast<double>(cube.edge) / (1 << level);
  double area = 0;
  for (const Voxel& voxel : voxels) area += static_cast<double>(voxel.moments.area) * edge * edge;
  return area;
}

void check_area(const Triangles& triangles, int level, double tolerance) {
  const Cube cube = Cube::around(box_of(triangles));
  const std::vector<Voxel> voxels = voxels_of(triangles, level);
  INFO("level " << level << ", " << voxels.size() << " voxels");
  CHECK(area_of(voxels, cube, level) == Approx(area_of(triangles)).epsilon(tolerance));
}

bool same(const std::vector<Voxel>& a, const std::vector<Voxel>& b) {
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i)
    if (a[i].key != b[i].key || std::memcmp(&a[i].moments, &b[i].moments, sizeof(SurfaceMoments)) != 0) return false;
  return true;
}

TEST_CASE("keeps the area of a triangle that is cut into many voxels") {
  const Triangles one{triangle_of({0, 0, 0}, {1, 0.2f, 0.3f}, {0.1f, 0.9f, 0.7f})};
  for (const int level : {1, 3, 5, 6, 8, 10}) check_area(one, level, 1e-4);
}

TEST_CASE("keeps the area of random triangles of all sizes", "[optimised]") {
  for (const int level : {2, 5, 7, 9}) check_area(random_triangles(90, 1, 5), level, 1e-4);
}

TEST_CASE("keeps the area of distant, huge and tiny surfaces") {
  check_area(sphere(20, 1, {4096, -8192, 2048}), 6, 1e-4);
  check_area(sphere(20, 1e9f), 6, 1e-4);
  check_area(sphere(20, 1e-9f), 6, 1e-4);
}

TEST_CASE("counts faces on voxel boundaries once") {
  // A cube with each face in a plane between voxels: 2 of 8 voxels per axis.
  SurfaceVoxelizer voxelizer(Cube{{0, 0, 0}, 8}, 3);
  voxelizer.add(box_shape({2, 2, 2}, {4, 4, 4}));
  double area = 0;
  for (const Voxel& voxel : voxelizer.finish()) area += voxel.moments.area;
  CHECK(area == Approx(24).epsilon(1e-6));
}

TEST_CASE("computes the moments of a plane as by hand") {
  // z = 0.25 in the unit cube at level 1: four voxels of a quarter each, at half height.
  SurfaceVoxelizer voxelizer(Cube{{0, 0, 0}, 1}, 1);
  const glm::vec3 a(0, 0, 0.25f), b(0.9999f, 0, 0.25f), c(0.9999f, 0.9999f, 0.25f), d(0, 0.9999f, 0.25f);
  voxelizer.add(Triangles{triangle_of(a, b, c, {10, 20, 30}), triangle_of(a, c, d, {10, 20, 30})});
  const std::vector<Voxel> voxels = voxelizer.finish();
  REQUIRE(voxels.size() == 4);
  for (std::size_t i = 0; i < 4; ++i) {
    const SurfaceMoments& m = voxels[i].moments;
    CHECK(voxels[i].key == i);
    CHECK(m.area == Approx(1).epsilon(1e-3));
    CHECK(m.position.z == Approx(0).margin(1e-6));
    CHECK(m.position.x == Approx(0).margin(1e-3));
    CHECK(m.normal.z == Approx(m.area));
    CHECK(m.color.y == Approx(20 * m.area));
    CHECK(m.spread[5] == Approx(m.area));
    CHECK(m.spread[0] == Approx(0).margin(1e-6));
  }
  const std::vector<Voxel> root = coarsen(voxels);
  REQUIRE(root.size() == 1);
  CHECK(root[0].moments.area == Approx(1).epsilon(1e-3));
  CHECK(root[0].moments.position.z == Approx(-0.25).epsilon(1e-3));
}

TEST_CASE("keeps area, position and colour on coarser levels") {
  const Triangles ball = sphere(24, 2, {5, 6, 7}, true);
  const Cube cube = Cube::around(box_of(ball));
  std::vector<Voxel> voxels = voxels_of(ball, 7);
  for (int level = 7; level > 0; --level) {
    INFO("level " << level);
    CHECK(area_of(voxels, cube, level) == Approx(area_of(ball)).epsilon(1e-4));
    glm::dvec3 middle(0);
    double area = 0;
    for (const Voxel& voxel : voxels) {
      middle += glm::dvec3(voxel.moments.position + (voxel_cell(voxel.key) + 0.5f) * voxel.moments.area);
      area += voxel.moments.area;
    }
    middle = glm::dvec3(cube.lower) + middle / area * (static_cast<double>(cube.edge) / (1 << level));
    CHECK(glm::length(middle - glm::dvec3(5, 6, 7)) < 1e-3);
    const std::vector<Voxel> next = coarsen(voxels);
    for (std::size_t i = 1; i < next.size(); ++i) REQUIRE(next[i - 1].key < next[i].key);
    voxels = next;
  }
  REQUIRE(voxels.size() == 1);
}

TEST_CASE("computes only possible moments in each voxel") {
  for (const Voxel& voxel : voxels_of(random_triangles(400, 3, 11), 6)) {
    const SurfaceMoments& m = voxel.moments;
    REQUIRE_EACH(m.area > 0);
    for (int axis = 0; axis < 3; ++axis) REQUIRE_EACH(std::abs(m.position[axis]) <= 0.501f * m.area);
    REQUIRE_EACH(glm::length(m.normal) <= 1.001f * m.area);
    REQUIRE_EACH(m.spread[0] + m.spread[3] + m.spread[5] == Approx(m.area).epsilon(1e-4));
  }
}

TEST_CASE("skips triangles that are degenerate, not finite or outside the cube") {
  const float infinity = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
  const Cube cube{{0, 0, 0}, 1};
  SurfaceVoxelizer voxelizer(cube, 6);
  const glm::vec3 a(0.2f, 0.2f, 0.2f), b(0.8f, 0.3f, 0.2f);
  Triangles bad{triangle_of(a, a, a), triangle_of(a, b, a), triangle_of(a, b, a + (b - a) * 0.5f)};
  for (const float value : {infinity, -infinity, nan, 1.5f, -0.5f, 1.0f, 3e38f, -3e38f})
    for (int axis = 0; axis < 3; ++axis)
      for (int corner = 0; corner < 3; ++corner) {
        Triangle t = triangle_of(a, b, {0.3f, 0.9f, 0.5f});
        t.positions[static_cast<std::size_t>(corner)][axis] = value;
        bad.push_back(t);
      }
  voxelizer.add(bad);
  double area = 0;
  for (const Voxel& voxel : voxelizer.finish()) area += voxel.moments.area;
  CHECK(area < 1e-3);
  // The face normal replaces normals that are not finite.
  SurfaceVoxelizer other(cube, 4);
  Triangle t = triangle_of({0.1f, 0.1f, 0.5f}, {0.9f, 0.1f, 0.5f}, {0.1f, 0.9f, 0.5f});
  t.normals = {glm::vec3(nan, 0, 0), glm::vec3(0, infinity, 0), glm::vec3(0)};
  other.add({&t, 1});
  for (const Voxel& voxel : other.finish()) REQUIRE(voxel.moments.normal.z == Approx(voxel.moments.area));
}

TEST_CASE("accepts empty cubes and cubes at the limits of floats") {
  for (const float size : {1e-38f, 1e-30f, 1e30f, 1.5e38f}) {
    Triangles some = sphere(4, size);
    const std::vector<Voxel> voxels = voxels_of(some, 3);
    for (const Voxel& voxel : voxels) REQUIRE_EACH(std::isfinite(voxel.moments.area));
  }
  const Triangles point{triangle_of({1, 1, 1}, {1, 1, 1}, {1, 1, 1})};
  CHECK(voxels_of(point, 16).empty());
  SurfaceVoxelizer nothing(Cube{}, 5);
  CHECK(nothing.finish().empty());
}

TEST_CASE("visits only the voxels that a long oblique triangle meets") {
  const Triangles sliver{triangle_of({0, 0, 0}, {1, 1, 1}, {1, 1.0001f, 1})};
  const std::vector<Voxel> voxels = voxels_of(sliver, kDeepestLevel);
  CHECK(voxels.size() > 65536);
  CHECK(voxels.size() < 1'000'000);
  const Cube cube = Cube::around(box_of(sliver));
  CHECK(area_of(voxels, cube, kDeepestLevel) == Approx(area_of(sliver)).epsilon(0.01));
}

TEST_CASE("gives the same bits for any number of threads and batches", "[optimised]") {
  Triangles many = random_triangles(900, 1, 17);
  const Triangles ball = sphere(80);
  many.insert(many.end(), ball.begin(), ball.end());
  const Cube cube = Cube::around(box_of(many));
  const std::vector<Voxel> expected = voxels_of(many, 7, 1);
  CHECK(same(voxels_of(many, 7, 2), expected));
  CHECK(same(voxels_of(many, 7, 7), expected));
  SurfaceVoxelizer voxelizer(cube, 7, 3);
  for (std::size_t i = 0; i < many.size();) {
    const std::size_t size = std::min<std::size_t>(1 + i % 13, many.size() - i);
    voxelizer.add(std::span(many).subspan(i, size));
    i += size;
  }
  CHECK(same(voxelizer.finish(), expected));
}

TEST_CASE("sums more triangles than the queue holds") {
  // 600,000 copies of a triangle exceed one batch.
  const Triangle t = triangle_of({0.1f, 0.1f, 0.2f}, {0.12f, 0.1f, 0.2f}, {0.1f, 0.12f, 0.21f});
  const std::vector<Triangle> copies(1000, t);
  SurfaceVoxelizer voxelizer(Cube{{0, 0, 0}, 1}, 2);
  for (int i = 0; i < 600; ++i) voxelizer.add(copies);
  const std::vector<Voxel> voxels = voxelizer.finish();
  REQUIRE(voxels.size() == 1);
  // The tolerance allows for 600,000 roundings of floats.
  CHECK(area_of(voxels, Cube{{0, 0, 0}, 1}, 2) == Approx(600000 * area_of(t)).epsilon(0.02));
}

}  // namespace
}  // namespace gs::qnv
