#include "vrml/mesh/mesh_contacts.h"

#include <catch2/catch.hpp>

#include <glm/gtc/matrix_transform.hpp>

// Tests of intersections of meshes.
namespace gs::vrml {
namespace {

// Returns a tetrahedron with corners at the origin and at distance 1 on the axes.
Mesh tetrahedron() {
  Mesh mesh;
  mesh.positions = {glm::vec3(0), glm::vec3(1, 0, 0), glm::vec3(0, 1, 0), glm::vec3(0, 0, 1)};
  mesh.indices = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
  for (const glm::vec3& position : mesh.positions) mesh.bounds.add(position);
  return mesh;
}

glm::dmat4 moved(double x, double y, double z) { return glm::translate(glm::dmat4(1), glm::dvec3(x, y, z)); }

}  // namespace

TEST_CASE("distinguishes the inside of a closed mesh from its outside") {
  CHECK(is_inside(tetrahedron(), {0.1, 0.2, 0.3}));
  CHECK_FALSE(is_inside(tetrahedron(), {0.5, 0.5, 0.5}));
  CHECK_FALSE(is_inside(tetrahedron(), {-0.1, 0.2, 0.3}));
}

TEST_CASE("finds the points at which a line passes through a mesh") {
  std::vector<SurfacePoint> points;
  append_crossings(tetrahedron(), {0.25, 0.25, -1}, {0.25, 0.25, 3}, 10, points);
  REQUIRE(points.size() == 2);
  CHECK(points[0].point.z == Approx(0).margin(1e-9));
  CHECK(points[0].normal.z == Approx(-1));
  CHECK(points[1].point.z == Approx(0.5));
  points.clear();
  append_crossings(tetrahedron(), {0.25, 0.25, -1}, {0.25, 0.25, -0.5}, 10, points);
  CHECK(points.empty());
}

TEST_CASE("reports common points of two meshes, also if one is inside of the other") {
  const Mesh mesh = tetrahedron();
  CHECK(do_meet(mesh, moved(0.1, 0.1, 0.1), mesh));
  CHECK_FALSE(do_meet(mesh, moved(0.7, 0.7, 0.7), mesh));
  CHECK_FALSE(do_meet(mesh, moved(3, 0, 0), mesh));
  Mesh small = mesh;
  small.bounds = {};
  small.positions = {glm::vec3(0.1F), glm::vec3(0.2F, 0.1F, 0.1F), glm::vec3(0.1F, 0.2F, 0.1F),
                     glm::vec3(0.1F, 0.1F, 0.2F)};
  for (const glm::vec3& position : small.positions) small.bounds.add(position);
  CHECK(do_meet(small, glm::dmat4(1), mesh));
  CHECK(do_meet(mesh, glm::dmat4(1), small));
}

}  // namespace gs::vrml
