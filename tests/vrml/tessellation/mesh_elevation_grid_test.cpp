#include "tests/vrml/mesh_checks.h"

using namespace gs::vrml;
using namespace gs::vrml::test;

namespace {

GeometryScene grid(int columns, int rows, MFFloat heights) {
  GeometryScene scene("ElevationGrid");
  scene.set<SFInt32>("xDimension", columns).set<SFInt32>("zDimension", rows).set("height", std::move(heights));
  return scene;
}
MFFloat flat(int count) {
  MFFloat heights;
  heights.resize(static_cast<std::size_t>(count));
  return heights;
}

}  // namespace

TEST_CASE("places ElevationGrid vertices as the standard defines") {
  GeometryScene scene = grid(3, 2, {0, 1, 2, 3, 4, 5});
  scene.set<SFFloat>("xSpacing", 10).set<SFFloat>("zSpacing", 100).set<SFFloat>("creaseAngle", 3.2f);
  const Mesh mesh = scene.mesh();
  check_promises(mesh);
  REQUIRE(mesh.positions.size() == 6);
  CHECK(mesh.positions[1] == glm::vec3(10, 1, 0));
  CHECK(mesh.positions[5] == glm::vec3(20, 5, 100));
  CHECK(triangles_of(mesh) == 4);
  CHECK(mesh.texture_coordinates[0] == glm::vec2(0, 0));
  CHECK(mesh.texture_coordinates[1] == glm::vec2(0.5f, 0));
  CHECK(mesh.texture_coordinates[3] == glm::vec2(0, 1));
  CHECK(mesh.texture_coordinates[5] == glm::vec2(1, 1));
  CHECK(normals_on_front(mesh));
  for (const glm::vec3& normal : mesh.normals) CHECK(normal.y > 0);
}

TEST_CASE("applies ccw and solid of an ElevationGrid, and flat normals") {
  GeometryScene scene = grid(3, 3, flat(9));
  Mesh mesh = scene.mesh();
  check_promises(mesh);
  CHECK(triangles_of(mesh) == 8);
  CHECK(area_of(mesh) == Approx(4));
  for (std::size_t t = 0; t < 8; ++t) CHECK(area_vector(mesh, t).y > 0);
  CHECK(mesh.normals[0] == glm::vec3(0, 1, 0));
  CHECK(mesh.solid);
  mesh = scene.set("ccw", false).set("solid", false).mesh();
  for (std::size_t t = 0; t < 8; ++t) CHECK(area_vector(mesh, t).y < 0);
  CHECK(mesh.normals[0] == glm::vec3(0, -1, 0));
  CHECK_FALSE(mesh.solid);
}

TEST_CASE("smooths ElevationGrid edges below the crease angle") {
  GeometryScene roof = grid(3, 2, {0, 1, 0, 0, 1, 0});  // the slopes meet at 90 degrees
  CHECK(roof.set<SFFloat>("creaseAngle", 1.5f).mesh().positions.size() == 8);
  const Mesh smooth = roof.set<SFFloat>("creaseAngle", 1.6f).mesh();
  CHECK(smooth.positions.size() == 6);
  CHECK(near(smooth.normals[1], {0, 1, 0}));
}

TEST_CASE("uses an ElevationGrid's own colours, normals and texture coordinates") {
  GeometryScene scene = grid(3, 2, flat(6));
  scene.normals({{0, 1, 0}, {0, 1, 0}, {0, 1, 0}, {0, 1, 0}, {1, 0, 0}, {0, 1, 0}});
  scene.colors({kRed, kGreen, kBlue, kRed, kGreen, kBlue});
  scene.texture({{0, 0}, {1, 0}, {2, 0}, {0, 3}, {1, 3}, {2, 3}});
  Mesh mesh = scene.mesh();
  check_promises(mesh);
  REQUIRE(mesh.positions.size() == 6);
  CHECK(mesh.normals[4] == glm::vec3(1, 0, 0));
  CHECK(mesh.colors[4] == kGreen);
  CHECK(mesh.texture_coordinates[5] == glm::vec2(2, 3));

  scene.set("colorPerVertex", false).set("normalPerVertex", false).normals({{0, 1, 0}, {0, 0, 1}});
  mesh = scene.mesh();
  check_promises(mesh);
  CHECK(mesh.positions.size() == 8);
  for (std::size_t i = 0; i < 6; ++i) CHECK(mesh.colors[mesh.indices[i]] == kRed);
  for (std::size_t i = 6; i < 12; ++i) CHECK(mesh.colors[mesh.indices[i]] == kGreen);
  CHECK(mesh.normals[mesh.indices[6]] == glm::vec3(0, 0, 1));
  CHECK(mesh.texture_coordinates[mesh.indices[8]] == glm::vec2(2, 3));
}

TEST_CASE("tolerates wrong dimensions and counts of an ElevationGrid") {
  CHECK(GeometryScene("ElevationGrid").mesh().empty());
  CHECK(grid(1, 5, flat(5)).mesh().empty());
  CHECK(grid(5, 1, flat(5)).mesh().empty());
  CHECK(grid(-3, 2, flat(6)).mesh().empty());
  CHECK(grid(0, 0, flat(6)).mesh().empty());
  CHECK(triangles_of(grid(2, 2, flat(9)).mesh()) == 2);  // more heights than needed
  const Mesh cut = grid(2, 5, flat(7)).mesh();           // three whole rows of five
  CHECK(triangles_of(cut) == 4);
  CHECK(cut.bounds.upper.z == 2);
  CHECK(texture_at(cut, {1, 0, 2}, {0, 1, 0}) == glm::vec2(1, 0.5f));
  CHECK(grid(2147483647, 2147483647, flat(100)).mesh().empty());
  CHECK(triangles_of(grid(2, 2147483647, flat(8)).mesh()) == 6);
  // A spacing of 0 makes a wall, or no face if the heights are collinear.
  CHECK(area_of(grid(2, 2, {0, 2, 0, 2}).set<SFFloat>("xSpacing", 0).mesh()) == Approx(2));
  CHECK(grid(2, 2, flat(4)).set<SFFloat>("xSpacing", 0).mesh().empty());
  for (const float bad : {-1.0f, kNaN}) {
    CHECK(grid(2, 2, flat(4)).set("xSpacing", bad).mesh().empty());
    CHECK(grid(2, 2, flat(4)).set("zSpacing", bad).mesh().empty());
  }
  CHECK(grid(2, 2, flat(4)).set("zSpacing", std::numeric_limits<float>::infinity()).mesh().empty());
}

TEST_CASE("drops only the quadrilaterals at NaN heights of an ElevationGrid") {
  MFFloat heights = flat(16);
  heights.mutable_data()[0] = kNaN;
  for (const float crease : {0.0f, 1.0f}) {
    const Mesh mesh = grid(4, 4, heights).set("creaseAngle", crease).mesh();
    check_promises(mesh);
    CHECK(triangles_of(mesh) == 16);
  }
}
