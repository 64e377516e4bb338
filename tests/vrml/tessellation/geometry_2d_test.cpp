#include "tests/vrml/mesh_checks.h"

using namespace gs::vrml;
using namespace gs::vrml::test;

namespace {

GeometryScene geometry(std::string_view type) { return GeometryScene(type, Language::x3d); }

glm::vec3 first_end(const Mesh& mesh) { return mesh.positions[mesh.indices[0]]; }
glm::vec3 last_end(const Mesh& mesh) { return mesh.positions[mesh.indices[mesh.indices.size() - 1]]; }

}  // namespace

TEST_CASE("draws an Arc2D from its start angle to its end angle") {
  GeometryScene arc = geometry("Arc2D");
  arc.set("radius", 2.0f);
  const Mesh quarter = arc.mesh();
  check_promises(quarter);
  CHECK(quarter.primitive == Mesh::Primitive::lines);
  CHECK(glm::distance(first_end(quarter), {2, 0, 0}) < 1e-5f);
  CHECK(glm::distance(last_end(quarter), {0, 2, 0}) < 1e-5f);
  CHECK(quarter.bounds.lower.x >= -1e-5f);
  SECTION("a whole circle, if the angles are equal") {
    const Mesh circle = arc.set("startAngle", 1.0f).set("endAngle", 1.0f).mesh();
    CHECK(first_end(circle) == last_end(circle));
    CHECK(circle.bounds.lower.x == Approx(-2).epsilon(0.01));
  }
  SECTION("through 0, if the end is before the start") {
    const Mesh mesh = arc.set("startAngle", 4.7123889f).set("endAngle", 1.5707963f).mesh();
    CHECK(mesh.bounds.lower.x >= -1e-5f);
    CHECK(mesh.bounds.lower.y == Approx(-2));
    CHECK(mesh.bounds.upper.y == Approx(2));
  }
}

TEST_CASE("closes an ArcClose2D by two radii or by a chord") {
  GeometryScene arc = geometry("ArcClose2D");
  const Mesh pie = arc.mesh();
  check_promises(pie);
  CHECK(area_of(pie) == Approx(kPi / 4).epsilon(0.01));
  CHECK_FALSE(pie.solid);
  CHECK(normals_on_front(pie));
  const Mesh chord = arc.set("closureType", SFString("CHORD")).mesh();
  check_promises(chord);
  CHECK(area_of(chord) == Approx(kPi / 4 - 0.5).epsilon(0.02));
  CHECK(area_of(arc.set("endAngle", kPi * 1.5f).mesh()) == Approx(kPi * 0.75 + 0.5).epsilon(0.01));
  CHECK(arc.set("radius", -1.0f).mesh().empty());
}

TEST_CASE("draws a Disk2D, a ring or a circle by its inner radius") {
  GeometryScene disk = geometry("Disk2D");
  disk.set("outerRadius", 2.0f);
  const Mesh whole = disk.mesh();
  check_promises(whole);
  CHECK(area_of(whole) == Approx(4 * kPi).epsilon(0.01));
  CHECK(texture_at(whole, {0, 0, 0}, {0, 0, 1}) == glm::vec2(0.5f));
  const Mesh ring = disk.set("innerRadius", 1.0f).mesh();
  check_promises(ring);
  CHECK(area_of(ring) == Approx(3 * kPi).epsilon(0.01));
  CHECK(normals_on_front(ring));
  const Mesh circle = disk.set("innerRadius", 2.0f).mesh();
  CHECK(circle.primitive == Mesh::Primitive::lines);
  CHECK(geometry("Circle2D").set("radius", 2.0f).mesh().indices.size() == circle.indices.size());
}

TEST_CASE("draws the points and lines of the plane") {
  GeometryScene line = geometry("Polyline2D");
  line.set("lineSegments", MFVec2f{{0, 0}, {1, 0}, {1, 2}});
  CHECK(line.mesh().indices.size() == 4);
  CHECK(line.mesh().bounds.upper == glm::vec3(1, 2, 0));
  GeometryScene points = geometry("Polypoint2D");
  points.set("point", MFVec2f{{0, 0}, {1, 0}, {1, 2}});
  CHECK(points.mesh().primitive == Mesh::Primitive::points);
  CHECK(points.mesh().indices.size() == 3);
  CHECK(geometry("Polyline2D").mesh().empty());
  CHECK(geometry("Polypoint2D").mesh().empty());
}

TEST_CASE("draws a Rectangle2D with the whole texture") {
  const Mesh mesh = geometry("Rectangle2D").set("size", SFVec2f(4, 2)).mesh();
  check_promises(mesh);
  CHECK(area_of(mesh) == Approx(8));
  CHECK_FALSE(mesh.solid);
  CHECK(texture_at(mesh, {-2, -1, 0}, {0, 0, 1}) == glm::vec2(0, 0));
  CHECK(texture_at(mesh, {2, 1, 0}, {0, 0, 1}) == glm::vec2(1, 1));
  CHECK(geometry("Rectangle2D").set("size", SFVec2f(0, 2)).mesh().empty());
}

TEST_CASE("turns the triangles of a TriangleSet2D to the viewer") {
  GeometryScene set = geometry("TriangleSet2D");
  set.set("vertices", MFVec2f{{0, 0}, {2, 0}, {0, 2}, {0, 0}, {0, 2}, {-2, 0}, {1, 1}});
  const Mesh mesh = set.mesh();
  check_promises(mesh);
  CHECK(area_of(mesh) == Approx(4));
  CHECK(normals_on_front(mesh));
  set.set("vertices", MFVec2f{{0, 0}, {0, 2}, {2, 0}});
  CHECK(normals_on_front(set.mesh()));
}
