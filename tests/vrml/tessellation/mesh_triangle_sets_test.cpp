#include "tests/vrml/mesh_checks.h"

#include <string>

using namespace gs::vrml;
using namespace gs::vrml::test;

namespace {

const MFVec3f kSquare{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};

std::vector<glm::vec3> corners(const Mesh& mesh) {
  check_promises(mesh);
  std::vector<glm::vec3> result;
  for (const std::uint32_t i : mesh.indices) result.push_back(mesh.positions[i]);
  return result;
}
std::vector<Color> colors_of_corners(const Mesh& mesh) {
  check_promises(mesh);
  std::vector<Color> result;
  for (const std::uint32_t i : mesh.indices) result.push_back(mesh.colors[i]);
  return result;
}

}  // namespace

TEST_CASE("makes one triangle per three coordinates of a TriangleSet") {
  GeometryScene set("TriangleSet", Language::x3d);
  set.points({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, 0, 0}, {6, 0, 0}, {5, 1, 0}, {9, 9, 9}});
  const Mesh mesh = set.mesh();
  CHECK(triangles_of(mesh) == 2);
  CHECK(area_of(mesh) == Approx(1));
  CHECK(normals_on_front(mesh));
  CHECK(mesh.solid);
  CHECK(mesh.lit);
}

TEST_CASE("makes the triangles of an IndexedTriangleSet") {
  GeometryScene set("IndexedTriangleSet", Language::x3d);
  set.points(kSquare).set("index", MFInt32{0, 1, 2, 0, 2, 3, 0});
  SECTION("counter-clockwise") {
    const Mesh mesh = set.mesh();
    CHECK(triangles_of(mesh) == 2);
    CHECK(area_vector(mesh, 0).z > 0);
    CHECK(mesh.positions.shares_with(kSquare));
  }
  SECTION("clockwise") {
    const Mesh mesh = set.set("ccw", false).mesh();
    CHECK(area_vector(mesh, 0).z < 0);
    CHECK(normals_on_front(mesh));
  }
  SECTION("with end markers of an IndexedFaceSet") {
    CHECK(triangles_of(set.set("index", MFInt32{0, 1, 2, -1, 0, 2, 3, -1}).mesh()) == 2);
  }
  SECTION("without the triangles that have an invalid index") {
    CHECK(triangles_of(set.set("index", MFInt32{0, 1, 7, 0, 2, 3}).mesh()) == 1);
  }
  SECTION("not solid") { CHECK_FALSE(set.set("solid", false).mesh().solid); }
}

TEST_CASE("alternates the orientation of the triangles of a strip") {
  GeometryScene set("IndexedTriangleStripSet", Language::x3d);
  set.points({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0, 2, 0}}).set("index", MFInt32{0, 1, 2, 3, 4, -1, 1, 3, 2});
  const Mesh mesh = set.mesh();
  REQUIRE(triangles_of(mesh) == 4);
  for (std::size_t t = 0; t < 4; ++t) CHECK(area_vector(mesh, t).z > 0);
  GeometryScene counted("TriangleStripSet", Language::x3d);
  counted.points({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {5, 0, 0}, {6, 0, 0}, {5, 1, 0}})
      .set("stripCount", MFInt32{4, 3, 3});
  CHECK(triangles_of(counted.mesh()) == 3);
  CHECK(area_of(counted.mesh()) == Approx(1.5));
}

TEST_CASE("makes triangles around the first vertex of a fan") {
  GeometryScene set("TriangleFanSet", Language::x3d);
  set.points(kSquare).set("fanCount", MFInt32{4});
  CHECK(corners(set.mesh()) ==
        std::vector<glm::vec3>{kSquare[0], kSquare[1], kSquare[2], kSquare[0], kSquare[2], kSquare[3]});
  GeometryScene indexed("IndexedTriangleFanSet", Language::x3d);
  indexed.points(kSquare).set("index", MFInt32{3, 0, 1, 2, -1, 0, 1, 2});
  CHECK(triangles_of(indexed.mesh()) == 3);
  CHECK(area_vector(indexed.mesh(), 0).z > 0);
}

TEST_CASE("makes two triangles per quadrilateral of a QuadSet") {
  GeometryScene set("QuadSet", Language::x3d);
  CHECK(area_of(set.points(kSquare).mesh()) == Approx(1));
  GeometryScene indexed("IndexedQuadSet", Language::x3d);
  indexed.points(kSquare).set("index", MFInt32{0, 1, 2, 3, 3, 2, 1, 0, 0, 1});
  CHECK(triangles_of(indexed.mesh()) == 4);
}

TEST_CASE("assigns colours of a TriangleSet per vertex and per triangle") {
  GeometryScene set("IndexedTriangleSet", Language::x3d);
  set.points(kSquare).set("index", MFInt32{0, 1, 2, 0, 2, 3});
  SECTION("per vertex") {
    set.colors({kRed, kGreen, kBlue, kRed});
    CHECK(colors_of_corners(set.mesh()) == std::vector<Color>{kRed, kGreen, kBlue, kRed, kBlue, kRed});
  }
  SECTION("per triangle") {
    set.colors({kRed, kGreen}).set("colorPerVertex", false);
    CHECK(colors_of_corners(set.mesh()) == std::vector<Color>{kRed, kRed, kRed, kGreen, kGreen, kGreen});
  }
}

TEST_CASE("generates smooth normals at shared vertices of triangles") {
  GeometryScene set("IndexedTriangleSet", Language::x3d);
  set.points({{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {0, 1, 0}}).set("index", MFInt32{0, 1, 2, 0, 3, 1});
  const Mesh smooth = set.mesh();
  CHECK(smooth.positions.size() == 4);
  CHECK(smooth.normals[0].x == Approx(std::sqrt(0.5f)));
  CHECK(smooth.normals[0].y == Approx(std::sqrt(0.5f)));
  const Mesh flat = set.set("normalPerVertex", false).mesh();
  CHECK(flat.positions.size() == 6);
  CHECK(normals_on_front(flat));
}

TEST_CASE("maps a texture on the box of triangles without texCoord") {
  GeometryScene set("IndexedTriangleSet", Language::x3d);
  set.points(kSquare).set("index", MFInt32{0, 1, 2, 0, 2, 3});
  CHECK(set.mesh().texture_coordinates[2] == glm::vec2(1, 1));
  set.texture({{0, 0}, {3, 0}, {3, 3}, {0, 3}});
  CHECK(set.mesh().texture_coordinates[2] == glm::vec2(3, 3));
}

TEST_CASE("gives fog depths to the vertices of triangles") {
  GeometryScene set("IndexedTriangleSet", Language::x3d);
  set.points(kSquare).set("index", MFInt32{0, 1, 2, 0, 2, 3});
  set.property("fogCoord", "FogCoordinate", "depth", MFFloat{0, 0.5f});
  const Mesh mesh = set.mesh();
  REQUIRE(mesh.fog_depths.size() == mesh.positions.size());
  CHECK(mesh.fog_depths[0] == 0);
  CHECK(mesh.fog_depths[3] == 0.5f);
}

TEST_CASE("draws nothing for triangle sets without coordinates") {
  for (const char* type : {"TriangleSet", "IndexedTriangleSet", "TriangleFanSet", "TriangleStripSet",
                           "IndexedTriangleFanSet", "IndexedTriangleStripSet", "QuadSet", "IndexedQuadSet"}) {
    GeometryScene set(type, Language::x3d);
    CHECK(set.mesh().empty());
    CHECK(set.points({{0, 0, 0}, {kNaN, 0, 0}, {0, 1, 0}}).mesh().empty());
  }
}

TEST_CASE("makes the polylines of a LineSet") {
  GeometryScene set("LineSet", Language::x3d);
  set.points({{0, 0, 0}, {3, 4, 0}, {3, 5, 0}, {9, 0, 0}, {9, 1, 0}}).set("vertexCount", MFInt32{3, 2, 4});
  const Mesh mesh = set.mesh();
  check_promises(mesh);
  CHECK(mesh.primitive == Mesh::Primitive::lines);
  CHECK(mesh.indices.size() == 6);
  CHECK_FALSE(mesh.lit);
  SECTION("with lengths for patterns") {
    MeshOptions options;
    options.line_lengths = true;
    const Mesh measured = set.mesh(options);
    check_promises(measured);
    REQUIRE(measured.indices.size() == 6);
    std::vector<float> lengths;
    for (const std::uint32_t i : measured.indices) lengths.push_back(measured.texture_coordinates[i].x);
    CHECK(lengths == std::vector<float>{0, 5, 5, 6, 0, 1});
  }
  SECTION("lit, if they have normals") {
    set.normals({{0, 0, 2}, {0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {0, 0, 1}});
    CHECK(set.mesh().lit);
    CHECK(set.mesh().normals[0] == glm::vec3(0, 0, 1));
  }
}

TEST_CASE("keeps the field solid of primitives in X3D") {
  for (const char* type : {"Box", "Cone", "Cylinder", "Sphere"}) {
    GeometryScene primitive(type, Language::x3d);
    CHECK(primitive.mesh().solid);
    CHECK_FALSE(primitive.set("solid", false).mesh().solid);
    CHECK(GeometryScene(type).mesh().solid);
  }
}

TEST_CASE("keeps coordinates in double precision exact far from the origin") {
  GeometryScene set("TriangleSet", Language::x3d);
  const double far = 6'378'137;
  set.property("coord", "CoordinateDouble", "point", MFVec3d{{far, 0, 0}, {far + 0.001, 0, 0}, {far, 0.001, 0}});
  const Mesh mesh = set.mesh();
  check_promises(mesh);
  CHECK(triangles_of(mesh) == 1);
  CHECK(area_of(mesh) == Approx(0.5e-6).epsilon(1e-3));
  CHECK(mesh.origin.x + double{mesh.positions[mesh.indices[1]].x} == Approx(far + 0.001).epsilon(1e-12));
  GeometryScene near("PointSet", Language::x3d);
  near.property("coord", "CoordinateDouble", "point", MFVec3d{{1, 2, 3}, {4, 5, 6}});
  CHECK(near.mesh().origin == glm::dvec3(0));
  CHECK(near.mesh().bounds.upper == glm::vec3(4, 5, 6));
}

TEST_CASE("takes colours and opacities from a ColorRGBA in all geometries") {
  const MFColorRGBA colors{{1, 0, 0, 0.5f}, {0, 1, 0, 1}, {0, 0, 1, 0}};
  const auto check = [&](GeometryScene& scene) {
    scene.property("color", "ColorRGBA", "color", colors);
    const Mesh mesh = scene.mesh();
    check_promises(mesh);
    REQUIRE(mesh.opacities.size() == mesh.positions.size());
    CHECK(mesh.translucent);
    CHECK(mesh.colors[mesh.indices[0]] == kRed);
    CHECK(mesh.opacities[mesh.indices[0]] == 0.5f);
  };
  const MFVec3f triangle{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  for (const char* type : {"TriangleSet", "PointSet"}) {
    GeometryScene scene(type, Language::x3d);
    check(scene.points(triangle));
  }
  for (const char* type : {"IndexedFaceSet", "IndexedLineSet"}) {
    GeometryScene scene(type, Language::x3d);
    check(scene.points(triangle).set("coordIndex", MFInt32{0, 1, 2, -1}));
    scene.set("colorPerVertex", false);
    check(scene);
  }
  GeometryScene lines("LineSet", Language::x3d);
  check(lines.points(triangle).set("vertexCount", MFInt32{3}));
  GeometryScene grid("ElevationGrid", Language::x3d);
  check(grid.set("xDimension", 2).set("zDimension", 2).set("height", MFFloat{0, 0, 0, 0}));
}
