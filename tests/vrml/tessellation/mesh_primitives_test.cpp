#include "tests/vrml/mesh_checks.h"

#include <limits>
#include <numbers>

using namespace gs::vrml;
using namespace gs::vrml::test;

TEST_CASE("returns no mesh for a node that is no geometry") {
  const GeometryScene group("Group");
  CHECK(group.mesh().empty());
  CHECK(tessellate(group.scene, NodeId{}).empty());
  CHECK(tessellate(group.scene, NodeId{77, 1}).empty());
}

TEST_CASE("returns the mesh of the first node of a PROTO instance") {
  GeometryScene box("Box");
  const NodeId inner = box.instance_of(box.geometry);
  const NodeId outer = box.instance_of(inner);
  CHECK(triangles_of(tessellate(box.scene, outer)) == 12);
}

TEST_CASE("makes a Box of its size") {
  GeometryScene box("Box");
  box.set<SFVec3f>("size", {2, 4, 6});
  const Mesh mesh = box.mesh();
  check_promises(mesh);
  CHECK(mesh.positions.size() == 24);
  CHECK(triangles_of(mesh) == 12);
  CHECK(mesh.solid);
  CHECK(mesh.lit);
  CHECK(volume_of(mesh) == Approx(48));
  CHECK(area_of(mesh) == Approx(88));
  CHECK(normals_on_front(mesh));
  CHECK(mesh.bounds.lower == glm::vec3(-1, -2, -3));
  CHECK(mesh.bounds.upper == glm::vec3(1, 2, 3));

  SECTION("the texture is upright on every face, seen from outside") {
    CHECK(texture_at(mesh, {-1, -2, 3}, {0, 0, 1}) == glm::vec2(0, 0));
    CHECK(texture_at(mesh, {1, 2, 3}, {0, 0, 1}) == glm::vec2(1, 1));
    CHECK(texture_at(mesh, {1, -2, -3}, {0, 0, -1}) == glm::vec2(0, 0));
    CHECK(texture_at(mesh, {1, -2, 3}, {1, 0, 0}) == glm::vec2(0, 0));
    CHECK(texture_at(mesh, {-1, -2, -3}, {-1, 0, 0}) == glm::vec2(0, 0));
    CHECK(texture_at(mesh, {-1, 2, 3}, {0, 1, 0}) == glm::vec2(0, 0));
    CHECK(texture_at(mesh, {1, 2, -3}, {0, 1, 0}) == glm::vec2(1, 1));
    CHECK(texture_at(mesh, {-1, -2, -3}, {0, -1, 0}) == glm::vec2(0, 0));
    CHECK(texture_at(mesh, {1, -2, 3}, {0, -1, 0}) == glm::vec2(1, 1));
  }
  SECTION("sizes that are none") {
    for (const float bad : {-1.0f, kNaN, kInfinity}) {
      CHECK(box.set<SFVec3f>("size", {bad, 1, 1}).mesh().empty());
      CHECK(box.set<SFVec3f>("size", {1, bad, 1}).mesh().empty());
      CHECK(box.set<SFVec3f>("size", {1, 1, bad}).mesh().empty());
    }
  }
}

TEST_CASE("makes a Sphere of its radius") {
  GeometryScene sphere("Sphere");
  sphere.set<SFFloat>("radius", 2);
  const Mesh mesh = sphere.mesh({.segments = 64});
  check_promises(mesh);
  CHECK(triangles_of(mesh) == 2 * 64 * 31);
  CHECK(volume_of(mesh) == Approx(4.0 / 3 * std::numbers::pi * 8).epsilon(0.01));
  CHECK(volume_of(mesh) < 4.0 / 3 * std::numbers::pi * 8);
  CHECK(normals_on_front(mesh));
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) REQUIRE(near(mesh.positions[i], 2.0f * mesh.normals[i]));

  // The seam is at the back; s runs counter-clockwise from there, seen from above.
  CHECK(texture_at(mesh, {-2, 0, 0}, {-1, 0, 0}) == glm::vec2(0.25f, 0.5f));
  CHECK(texture_at(mesh, {0, 0, 2}, {0, 0, 1}) == glm::vec2(0.5f, 0.5f));
  CHECK(texture_at(mesh, {2, 0, 0}, {1, 0, 0}) == glm::vec2(0.75f, 0.5f));
  CHECK(texture_at(mesh, {0, 2, 0}, {0, 1, 0}).y == 1);
  CHECK(texture_at(mesh, {0, -2, 0}, {0, -1, 0}).y == 0);

  for (const int segments : {-5, 0, 1, 3, 4, 5}) {
    const Mesh coarse = sphere.mesh({.segments = segments});
    check_promises(coarse);
    CHECK(volume_of(coarse) > 0);
    CHECK(normals_on_front(coarse));
  }
  for (const float bad : {0.0f, -1.0f, kNaN, kInfinity}) CHECK(sphere.set<SFFloat>("radius", bad).mesh().empty());
}

TEST_CASE("makes a Cylinder of its radius and height") {
  GeometryScene cylinder("Cylinder");
  cylinder.set<SFFloat>("radius", 2).set<SFFloat>("height", 3);
  const MeshOptions fine{.segments = 256};
  const Mesh mesh = cylinder.mesh(fine);
  check_promises(mesh);
  CHECK(triangles_of(mesh) == 4 * 256);
  CHECK(volume_of(mesh) == Approx(std::numbers::pi * 4 * 3).epsilon(0.001));
  CHECK(normals_on_front(mesh));

  CHECK(near(texture_at(mesh, {0, 1.5f, 2}, {0, 0, 1}), {0.5f, 1}));
  CHECK(near(texture_at(mesh, {-2, -1.5f, 0}, {-1, 0, 0}), {0.25f, 0}));
  // The texture of the top is upright when the top is tilted towards +Z, so -Z is up. For the bottom, +Z is up.
  CHECK(near(texture_at(mesh, {0, 1.5f, -2}, {0, 1, 0}), {0.5f, 1}));
  CHECK(near(texture_at(mesh, {2, 1.5f, 0}, {0, 1, 0}), {1, 0.5f}));
  CHECK(near(texture_at(mesh, {0, -1.5f, 2}, {0, -1, 0}), {0.5f, 1}));
  CHECK(near(texture_at(mesh, {2, -1.5f, 0}, {0, -1, 0}), {1, 0.5f}));

  SECTION("parts") {
    cylinder.set("top", false);
    CHECK(triangles_of(cylinder.mesh(fine)) == 3 * 256);
    cylinder.set("side", false);
    const Mesh bottom = cylinder.mesh(fine);
    CHECK(area_of(bottom) == Approx(std::numbers::pi * 4).epsilon(0.001));
    CHECK(bottom.bounds.upper.y == -1.5f);
    CHECK(bottom.normals[0] == glm::vec3(0, -1, 0));
    check_promises(bottom);
    cylinder.set("bottom", false);
    CHECK(cylinder.mesh(fine).empty());
    CHECK(cylinder.mesh(fine).positions.empty());
  }
  SECTION("sizes that are none") {
    for (const float bad : {-1.0f, kNaN, kInfinity}) {
      CHECK(GeometryScene("Cylinder").set<SFFloat>("radius", bad).mesh().empty());
      CHECK(GeometryScene("Cylinder").set<SFFloat>("height", bad).mesh().empty());
      CHECK(GeometryScene("Cone").set<SFFloat>("bottomRadius", bad).mesh().empty());
      CHECK(GeometryScene("Cone").set<SFFloat>("height", bad).mesh().empty());
    }
  }
}

TEST_CASE("makes a Cone of its radius and height") {
  GeometryScene cone("Cone");
  cone.set<SFFloat>("bottomRadius", 3).set<SFFloat>("height", 4);
  const MeshOptions fine{.segments = 256};
  const Mesh mesh = cone.mesh(fine);
  check_promises(mesh);
  CHECK(triangles_of(mesh) == 2 * 256);
  CHECK(volume_of(mesh) == Approx(std::numbers::pi * 9 * 4 / 3).epsilon(0.001));
  CHECK(normals_on_front(mesh));
  CHECK(mesh.bounds.upper.y == 2);
  CHECK(mesh.bounds.lower.y == -2);
  CHECK(near(texture_at(mesh, {0, -2, 3}, {0, 0.6f, 0.8f}), {0.5f, 0}));
  CHECK(near(texture_at(mesh, {3, -2, 0}, {0.8f, 0.6f, 0}), {0.75f, 0}));
  CHECK(texture_at(mesh, {0, 2, 0}, {0, 0.6f, 0.8f}).y == 1);
  CHECK(near(texture_at(mesh, {0, -2, 3}, {0, -1, 0}), {0.5f, 1}));

  cone.set("bottom", false);
  CHECK(area_of(cone.mesh(fine)) == Approx(std::numbers::pi * 3 * 5).epsilon(0.001));
  cone.set("side", false);
  CHECK(cone.mesh(fine).empty());
}

TEST_CASE("makes a flat mesh of a Box, Cone or Cylinder with a size of 0") {
  struct Case {
    const char* type;
    const char* field;
    double area;  // area of both sides
    glm::vec3 normal;
  };
  for (const Case& flat : {Case{"Cylinder", "height", 2 * std::numbers::pi, {0, 1, 0}},
                           Case{"Cone", "height", 2 * std::numbers::pi, {0, 1, 0}}, Case{"Cylinder", "radius", 0, {}},
                           Case{"Cone", "bottomRadius", 0, {}}, Case{"Sphere", "radius", 0, {}}}) {
    INFO(flat.type << '.' << flat.field);
    GeometryScene scene(flat.type);
    scene.set<SFFloat>(flat.field, 0);
    CHECK_FALSE(scale_of_primitive(scene.scene, scene.geometry));
    const Mesh mesh = scene.mesh({.segments = 256});
    check_promises(mesh);
    CHECK(area_of(mesh) == Approx(flat.area).epsilon(1e-3));
    CHECK(mesh.empty() == (flat.area == 0));
    for (std::size_t t = 0; t < triangles_of(mesh); ++t) {
      const glm::dvec3 looks = glm::normalize(area_vector(mesh, t));
      REQUIRE(std::abs(glm::dot(looks, glm::dvec3(flat.normal))) == Approx(1));
      for (std::size_t i = 3 * t; i < 3 * t + 3; ++i)
        REQUIRE(glm::dot(looks, glm::dvec3(mesh.normals[mesh.indices[i]])) == Approx(1));
    }
  }
  for (int axis = 0; axis < 3; ++axis) {
    glm::vec3 size(2, 3, 5);
    size[axis] = 0;
    GeometryScene box("Box");
    box.set<SFVec3f>("size", size);
    const Mesh mesh = box.mesh();
    check_promises(mesh);
    CHECK_FALSE(scale_of_primitive(box.scene, box.geometry));
    CHECK(triangles_of(mesh) == 4);
    CHECK(area_of(mesh) == Approx(2 * size[(axis + 1) % 3] * size[(axis + 2) % 3]));
    CHECK(std::abs(mesh.normals[0][axis]) == 1);
    size[(axis + 1) % 3] = 0;
    CHECK(box.set<SFVec3f>("size", size).mesh().empty());
  }
}
