#include "tests/vrml/mesh_checks.h"

#include "vrml/tessellation/spine.h"

using namespace gs::vrml;
using namespace gs::vrml::test;

namespace {

GeometryScene extrusion() { return GeometryScene("Extrusion"); }

/// Returns a closed circle, counter-clockwise seen from +Y.
MFVec2f circle(int sides, float radius) {
  MFVec2f points;
  for (int i = 0; i < sides; ++i) {
    const float angle = 2 * kPi * static_cast<float>(i) / static_cast<float>(sides);
    points.push_back({radius * std::cos(angle), -radius * std::sin(angle)});
  }
  points.push_back(points.front());
  return points;
}
/// Returns a closed circle in the plane y = 0.
MFVec3f ring(int points, float radius) {
  MFVec3f spine;
  for (int i = 0; i < points; ++i) {
    const float angle = 2 * kPi * static_cast<float>(i) / static_cast<float>(points);
    spine.push_back({radius * std::cos(angle), 0, radius * std::sin(angle)});
  }
  spine.push_back(spine.front());
  return spine;
}
bool same_axes(const CrossSectionPlane& plane, glm::vec3 x, glm::vec3 y, glm::vec3 z) {
  return near(glm::vec3(plane.x), x) && near(glm::vec3(plane.y), y) && near(glm::vec3(plane.z), z);
}

}  // namespace

TEST_CASE("makes a box of a default Extrusion") {
  const Mesh mesh = extrusion().mesh();
  check_promises(mesh);
  CHECK(triangles_of(mesh) == 12);
  CHECK(volume_of(mesh) == Approx(4));  // 2 x 1 x 2
  CHECK(area_of(mesh) == Approx(16));
  CHECK(normals_on_front(mesh));
  CHECK(mesh.bounds.lower == glm::vec3(-1, 0, -1));
  CHECK(mesh.bounds.upper == glm::vec3(1, 1, 1));
  CHECK(mesh.solid);

  // Every corner of every face also occurs in a Box of that size.
  const Mesh box = GeometryScene("Box").set<SFVec3f>("size", {2, 1, 2}).mesh();
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    bool found = false;
    for (std::size_t j = 0; j < box.positions.size(); ++j)
      found |=
          near(mesh.positions[i], box.positions[j] + glm::vec3(0, 0.5f, 0)) && near(mesh.normals[i], box.normals[j]);
    CHECK(found);
  }
}

TEST_CASE("turns an Extrusion inside out on ccw FALSE") {
  const Mesh mesh = extrusion().set("ccw", false).set("solid", false).mesh();
  check_promises(mesh);
  CHECK(volume_of(mesh) == Approx(-4));
  CHECK(normals_on_front(mesh));
  CHECK_FALSE(mesh.solid);
}

TEST_CASE("adds the caps of an Extrusion as beginCap and endCap demand") {
  GeometryScene scene = extrusion();
  CHECK(triangles_of(scene.set("beginCap", false).mesh()) == 10);
  CHECK(triangles_of(scene.set("endCap", false).mesh()) == 8);
  const Mesh end = scene.set("endCap", true).mesh();
  CHECK(triangles_of(end) == 10);
  CHECK(area_vector(end, 9).y > 0);
  const Mesh begin = scene.set("endCap", false).set("beginCap", true).mesh();
  CHECK(area_vector(begin, 9).y < 0);

  SECTION("an open cross-section is closed for them") {
    GeometryScene open = extrusion();
    open.set("crossSection", MFVec2f{{1, 1}, {1, -1}, {-1, -1}, {-1, 1}});
    const Mesh mesh = open.mesh();
    check_promises(mesh);
    CHECK(triangles_of(mesh) == 6 + 4);
    CHECK(area_of(mesh) == Approx(3 * 2 + 2 * 4));
  }
  SECTION("concave ones") {
    GeometryScene angle = extrusion();
    angle.set("crossSection", MFVec2f{{0, 0}, {4, 0}, {4, -1}, {1, -1}, {1, -4}, {0, -4}, {0, 0}});
    for (const bool convex : {true, false}) {
      const Mesh mesh = angle.set("convex", convex).mesh();
      check_promises(mesh);
      CHECK(volume_of(mesh) == Approx(7));
      CHECK(area_of(mesh) == Approx(2 * 7 + 16));
      CHECK(normals_on_front(mesh));
    }
  }
  SECTION("a clockwise cross-section turns everything inside out") {
    const Mesh mesh = extrusion().set("crossSection", MFVec2f{{1, 1}, {-1, 1}, {-1, -1}, {1, -1}, {1, 1}}).mesh();
    CHECK(volume_of(mesh) == Approx(-4));
    CHECK(normals_on_front(mesh));
  }
  SECTION("also on a closed spine") {
    GeometryScene torus = extrusion();
    torus.set("crossSection", circle(8, 1)).set("spine", ring(12, 5));
    const std::size_t with = triangles_of(torus.mesh());
    CHECK(with - triangles_of(torus.set("beginCap", false).set("endCap", false).mesh()) == 12);
  }
}

TEST_CASE("maps textures of an Extrusion by the lengths of cross-section and spine") {
  GeometryScene scene = extrusion();
  scene.set("spine", MFVec3f{{0, 0, 0}, {0, 1, 0}, {0, 4, 0}});
  const Mesh mesh = scene.mesh();
  // Texture of the sides: S follows the length of the cross-section, T the length of the spine.
  CHECK(near(texture_at(mesh, {1, 0, 1}, {1, 0, 0}), {0, 0}));
  CHECK(near(texture_at(mesh, {1, 1, -1}, {1, 0, 0}), {0.25f, 0.25f}));
  CHECK(near(texture_at(mesh, {-1, 4, -1}, {-1, 0, 0}), {0.5f, 1}));
  CHECK(near(texture_at(mesh, {1, 4, 1}, {0, 0, 1}), {1, 1}));
  // Texture of the caps: S is along X, T along Z.
  CHECK(near(texture_at(mesh, {-1, 0, -1}, {0, -1, 0}), {0, 0}));
  CHECK(near(texture_at(mesh, {1, 4, 1}, {0, 1, 0}), {1, 1}));

  // The longer side of the cross-section maps to 0..1, the other side in proportion.
  const Mesh flat = scene.set("crossSection", MFVec2f{{3, 1}, {3, 0}, {-1, 0}, {-1, 1}, {3, 1}}).mesh();
  CHECK(near(texture_at(flat, {3, 0, 1}, {0, -1, 0}), {1, 0.25f}));
  CHECK(near(texture_at(flat, {-1, 4, 0}, {0, 1, 0}), {0, 0}));
}

TEST_CASE("applies scale and orientation of an Extrusion at each spine point") {
  GeometryScene scene = extrusion();
  SECTION("a frustum") {
    const Mesh mesh = scene.set("scale", MFVec2f{{1, 1}, {0.5f, 0.5f}}).mesh();
    check_promises(mesh);
    CHECK(volume_of(mesh) == Approx((4 + 1 + 2) / 3.0));
    CHECK(normals_on_front(mesh));
  }
  SECTION("one value for all, surplus values ignored, missing ones as the last") {
    const MFVec3f spine{{0, 0, 0}, {0, 1, 0}, {0, 2, 0}};
    CHECK(volume_of(scene.set("spine", spine).set("scale", MFVec2f{{2, 3}}).mesh()) == Approx(4 * 6 * 2));
    CHECK(volume_of(scene.set("scale", MFVec2f{{2, 3}, {2, 3}}).mesh()) == Approx(4 * 6 * 2));
    CHECK(volume_of(scene.set("scale", MFVec2f{{1, 1}, {1, 1}, {1, 1}, {9, 9}}).mesh()) == Approx(8));
    CHECK(volume_of(scene.set("scale", MFVec2f{}).set("orientation", MFRotation{}).mesh()) == Approx(8));
  }
  SECTION("a pyramid ends in a point") {
    const Mesh mesh = scene.set("scale", MFVec2f{{1, 1}, {0, 0}}).mesh();
    check_promises(mesh);
    CHECK(volume_of(mesh) == Approx(4.0 / 3));
    CHECK(normals_on_front(mesh));
  }
  SECTION("orientation turns in the plane of the cross-section") {
    // A quarter turn about Y takes X to -Z.
    scene.set("crossSection", MFVec2f{{3, 1}, {3, 0}, {0, 0}, {0, 1}, {3, 1}});
    const Mesh mesh = scene.set("orientation", MFRotation{{0, 2, 0, kPi / 2}}).mesh();
    CHECK(near(mesh.bounds.lower, {0, 0, -3}));
    CHECK(near(mesh.bounds.upper, {1, 1, 0}));
  }
  SECTION("an axis without direction turns nothing") {
    for (const Rotation& rotation : {Rotation{0, 0, 0, 1}, Rotation{0, 1, 0, kNaN}, Rotation{kNaN, 0, 0, 1}})
      CHECK(extrusion().set("orientation", MFRotation{rotation}).mesh().bounds.upper == glm::vec3(1, 1, 1));
  }
}

TEST_CASE("smooths the sides of an Extrusion and keeps the edges at its caps") {
  GeometryScene tube = extrusion();
  tube.set("crossSection", circle(24, 1)).set("spine", MFVec3f{{0, 0, 0}, {0, 1, 0}, {0, 2, 0}});
  const Mesh mesh = tube.set<SFFloat>("creaseAngle", 3.2f).mesh();
  check_promises(mesh);
  CHECK(normals_on_front(mesh));
  CHECK(volume_of(mesh) == Approx(12 * std::sin(2 * kPi / 24) * 2));
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const glm::vec3 outwards(mesh.positions[i].x, 0, mesh.positions[i].z);
    const bool cap = std::abs(mesh.normals[i].y) > 0.5f;
    CHECK((cap || near(mesh.normals[i], outwards, 1e-4f)));  // also at the seam
  }
  const Mesh sharp = tube.set<SFFloat>("creaseAngle", 0.1f).mesh();
  CHECK(sharp.positions.size() > mesh.positions.size());
}

TEST_CASE("closes and smooths a torus made by an Extrusion") {
  GeometryScene torus = extrusion();
  torus.set("crossSection", circle(32, 1)).set("spine", ring(64, 4)).set<SFFloat>("creaseAngle", 3.2f);
  torus.set("beginCap", false).set("endCap", false);
  const Mesh mesh = torus.mesh();
  check_promises(mesh);
  CHECK(triangles_of(mesh) == 2 * 32 * 64);
  CHECK(std::abs(volume_of(mesh)) == Approx(2 * kPi * kPi * 4).epsilon(0.02));
  CHECK(normals_on_front(mesh));
  CHECK(mesh.bounds.upper.x == Approx(5).epsilon(0.001));
  CHECK(mesh.bounds.upper.y == Approx(1).epsilon(0.001));
  const float side = volume_of(mesh) > 0 ? 1.0f : -1.0f;
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const glm::vec3 p = mesh.positions[i];
    const glm::vec3 middle = 4.0f * glm::normalize(glm::vec3(p.x, 0, p.z));
    CHECK(near(mesh.normals[i], side * glm::normalize(p - middle), 0.02f));
  }
}

TEST_CASE("aligns the cross-section planes of an Extrusion with its spine") {
  using Spine = std::vector<glm::vec3>;
  const glm::vec3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  SECTION("a straight spine turns the plane by the shortest way") {
    CHECK(same_axes(cross_section_planes(Spine{{0, 0, 0}, {0, 2, 0}})[0], x, y, z));
    CHECK(same_axes(cross_section_planes(Spine{{0, 0, 0}, {0, 1, 0}, {0, 3, 0}})[2], x, y, z));
    CHECK(same_axes(cross_section_planes(Spine{{0, 0, 0}, {3, 0, 0}})[1], -y, x, z));
    CHECK(same_axes(cross_section_planes(Spine{{0, 0, 0}, {0, 0, 1}})[0], x, z, -y));
    CHECK(same_axes(cross_section_planes(Spine{{0, 1, 0}, {0, 0, 0}})[0], -x, -y, z));
  }
  SECTION("a bend: Y halves it, Z is its axis, and the ends take it over") {
    const auto planes = cross_section_planes(Spine{{0, 0, 0}, {0, 1, 0}, {1, 1, 0}});
    const float half = std::sqrt(0.5f);
    // Z = (spine[2] - spine[1]) x (spine[0] - spine[1]) = X x -Y = -Z
    CHECK(same_axes(planes[0], -x, y, -z));
    CHECK(same_axes(planes[1], {-half, half, 0}, {half, half, 0}, -z));
    CHECK(same_axes(planes[2], y, x, -z));
  }
  SECTION("points in a line take Z from before, or at the start from the first bend") {
    const auto planes = cross_section_planes(Spine{{0, 0, 0}, {0, 1, 0}, {0, 2, 0}, {1, 2, 0}, {2, 2, 0}});
    for (const CrossSectionPlane& plane : planes) CHECK(near(glm::vec3(plane.z), -z));
  }
  SECTION("Z does not flip between bends to opposite sides") {
    const auto planes = cross_section_planes(Spine{{0, 0, 0}, {0, 1, 0}, {1, 2, 0}, {1, 3, 0}});
    for (const CrossSectionPlane& plane : planes) CHECK(near(glm::vec3(plane.z), -z));
  }
  SECTION("a closed spine has the same plane at both ends") {
    const auto planes = cross_section_planes(Spine{{1, 0, 0}, {0, 0, 1}, {-1, 0, 0}, {0, 0, -1}, {1, 0, 0}});
    CHECK(near(glm::vec3(planes[0].y), z));
    CHECK(near(glm::vec3(planes[4].y), z));
    CHECK(glm::vec3(planes[0].z) == glm::vec3(planes[4].z));
    CHECK(std::abs(planes[0].z.y) == Approx(1));
  }
  SECTION("points that coincide have the same plane") {
    const auto planes = cross_section_planes(Spine{{0, 0, 0}, {0, 1, 0}, {0, 1, 0}, {0, 1, 0}, {1, 1, 0}});
    CHECK(planes[1].y == planes[2].y);
    CHECK(planes[2].x == planes[3].x);
    const float half = std::sqrt(0.5f);
    CHECK(near(glm::vec3(planes[2].y), {half, half, 0}));
    for (const CrossSectionPlane& plane : cross_section_planes(Spine(4, glm::vec3(1, 2, 3))))
      CHECK(same_axes(plane, x, y, z));
  }
  SECTION("axes are always unit vectors at right angles") {
    const std::vector<Spine> spines = {{{0, 0, 0}, {1, 0, 0}, {0, 0, 0}},
                                       {{0, 0, 0}, {1, 0, 0}, {0, 0, 0}, {0, 1, 0}},
                                       {{0, 0, 0}, {kNaN, 0, 0}, {0, 1, 0}, {1, 1, 0}},
                                       {{1e30f, 0, 0}, {0, 1e-30f, 0}, {-1e30f, 1, 2}},
                                       {{0, 0, 0}, {0, -1, 1e-8f}, {0, -2, 0}}};
    for (const Spine& spine : spines)
      for (const CrossSectionPlane& plane : cross_section_planes(spine)) {
        CHECK(glm::length(plane.x) == Approx(1));
        CHECK(glm::length(plane.y) == Approx(1));
        CHECK(near(glm::vec3(glm::cross(plane.x, plane.y)), glm::vec3(plane.z)));
      }
  }
}

TEST_CASE("makes a surface of revolution from coincident spine points") {
  // The spine repeats one point. Each orientation turns the upright cross-section a little further about Y.
  GeometryScene scene = extrusion();
  MFVec3f spine;
  MFRotation turns;
  for (int i = 0; i <= 40; ++i) {
    spine.push_back({0, 0, 0});
    turns.push_back({0, 1, 0, 2 * kPi * static_cast<float>(i) / 40});
  }
  scene.set("spine", spine).set("orientation", turns).set("crossSection", MFVec2f{{1, 0}, {2, 0}});
  scene.set("beginCap", false).set("endCap", false);
  const Mesh mesh = scene.mesh();
  check_promises(mesh);
  CHECK(area_of(mesh) == Approx(kPi * 3).epsilon(0.01));
}

TEST_CASE("returns an empty mesh for an Extrusion that cannot be drawn") {
  CHECK(extrusion().set("spine", MFVec3f{}).mesh().empty());
  CHECK(extrusion().set("spine", MFVec3f{{0, 0, 0}}).mesh().empty());
  CHECK(extrusion().set("crossSection", MFVec2f{}).mesh().empty());
  CHECK(extrusion().set("crossSection", MFVec2f{{1, 1}}).mesh().empty());
  CHECK(triangles_of(extrusion().set("crossSection", MFVec2f{{1, 1}, {2, 2}}).mesh()) == 2);    // no caps
  CHECK(area_of(extrusion().set("spine", MFVec3f{{1, 1, 1}, {1, 1, 1}}).mesh()) == Approx(8));  // only the caps

  SECTION("numbers that are none take only the faces at them") {
    const Mesh mesh =
        extrusion().set("spine", MFVec3f{{0, 0, 0}, {0, 1, 0}, {0, kNaN, 0}, {0, 3, 0}, {0, 4, 0}}).mesh();
    check_promises(mesh);
    CHECK(triangles_of(mesh) == 2 * 8 + 4);
    check_promises(extrusion().set("crossSection", MFVec2f{{1, 1}, {kNaN, -1}, {-1, -1}, {-1, 1}, {1, 1}}).mesh());
    check_promises(extrusion().set("scale", MFVec2f{{kNaN, 1}}).mesh());
  }
}
