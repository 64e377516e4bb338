#include "tests/vrml/mesh_checks.h"

using namespace gs::vrml;
using namespace gs::vrml::test;

namespace {

using Colors = std::vector<Color>;

GeometryScene lines(MFInt32 index) {
  GeometryScene set("IndexedLineSet");
  set.points({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {4, 0, 0}}).set("coordIndex", std::move(index));
  return set;
}

std::vector<float> ends(const Mesh& mesh) {
  check_promises(mesh);
  std::vector<float> result;
  for (const std::uint32_t i : mesh.indices) result.push_back(mesh.positions[i].x);
  return result;
}
Colors end_colors(const Mesh& mesh) {
  check_promises(mesh);
  Colors result;
  for (const std::uint32_t i : mesh.indices) result.push_back(mesh.colors[i]);
  return result;
}

}  // namespace

TEST_CASE("makes unlit segments of the polylines of an IndexedLineSet") {
  const Mesh mesh = lines({0, 1, 2, -1, 3, 4}).mesh();
  CHECK(mesh.primitive == Mesh::Primitive::lines);
  CHECK_FALSE(mesh.lit);
  CHECK(mesh.normals.empty());
  CHECK(mesh.colors.empty());
  CHECK(mesh.texture_coordinates.empty());
  CHECK(ends(mesh) == std::vector<float>{0, 1, 1, 2, 3, 4});
}

TEST_CASE("assigns IndexedLineSet colours per vertex and per polyline") {
  GeometryScene set = lines({0, 1, 2, -1, 3, 4, -1});
  SECTION("a vertex, by coordIndex, shared with the node") {
    const MFColor colors{kRed, kGreen, kBlue, kRed, kGreen};
    const Mesh mesh = set.colors(colors).mesh();
    CHECK(mesh.colors.shares_with(colors));
    CHECK(end_colors(mesh) == Colors{kRed, kGreen, kGreen, kBlue, kRed, kGreen});
  }
  SECTION("a vertex, by colorIndex") {
    set.colors({kRed, kGreen}).set("colorIndex", MFInt32{1, 0, 1, -1, 0, 0, -1});
    CHECK(end_colors(set.mesh()) == Colors{kGreen, kRed, kRed, kGreen, kRed, kRed});
  }
  SECTION("a polyline, in order") {
    set.colors({kRed, kGreen}).set("colorPerVertex", false);
    CHECK(end_colors(set.mesh()) == Colors{kRed, kRed, kRed, kRed, kGreen, kGreen});
  }
  SECTION("a polyline, by colorIndex") {
    set.colors({kRed, kGreen}).set("colorPerVertex", false).set("colorIndex", MFInt32{1, 0});
    CHECK(end_colors(set.mesh()) == Colors{kGreen, kGreen, kGreen, kGreen, kRed, kRed});
  }
  SECTION("too few: the last one goes on") {
    set.colors({kRed, kBlue}).set("colorPerVertex", false).set("colorIndex", MFInt32{0});
    CHECK(end_colors(set.mesh()) == Colors{kRed, kRed, kRed, kRed, kBlue, kBlue});
    set.set("colorPerVertex", true).set("colorIndex", MFInt32{});
    CHECK(end_colors(set.mesh()) == Colors{kRed, kBlue, kBlue, kBlue, kBlue, kBlue});
  }
  SECTION("a vertex in two polylines keeps both colours") {
    set.set("coordIndex", MFInt32{0, 1, -1, 1, 2}).set("colorPerVertex", false).colors({kRed, kGreen});
    const Mesh mesh = set.mesh();
    CHECK(mesh.positions.size() == 4);
    CHECK(end_colors(mesh) == Colors{kRed, kRed, kGreen, kGreen});
  }
}

TEST_CASE("drops only the segments at broken vertices of an IndexedLineSet") {
  CHECK(ends(lines({0, 1, 9, 2, 3, -1}).mesh()) == std::vector<float>{0, 1, 2, 3});
  CHECK(ends(lines({0, 0, 1, 1, -1, 4, -1, -1}).mesh()) == std::vector<float>{0, 1});
  CHECK(ends(lines({}).mesh()).empty());
  CHECK(ends(lines({3}).mesh()).empty());
  CHECK(ends(lines({2147483647, 0, -2147483647, 1}).mesh()).empty());
  GeometryScene set = lines({0, 1, 2});
  set.points({{0, 0, 0}, {kNaN, 0, 0}, {2, 0, 0}});
  CHECK(ends(set.mesh()).empty());
  CHECK(GeometryScene("IndexedLineSet").set("coordIndex", MFInt32{0, 1}).mesh().empty());
}

TEST_CASE("makes a smaller array for short lines out of many coordinates") {
  MFVec3f points;
  MFColor colors;
  for (int i = 0; i < 3000; ++i) {
    points.push_back({static_cast<float>(i), 0, 0});
    colors.push_back({static_cast<float>(i), 0, 0});
  }
  const Mesh mesh = GeometryScene("IndexedLineSet")
                        .points(points)
                        .colors(colors)
                        .set("coordIndex", MFInt32{7, 2999, -1, 7, 3000})
                        .mesh();
  CHECK(ends(mesh) == std::vector<float>{7, 2999});
  CHECK(mesh.positions.size() == 2);
  CHECK(mesh.colors[mesh.indices[1]].r == 2999);
}

TEST_CASE("makes points of a PointSet") {
  GeometryScene set("PointSet");
  CHECK(set.mesh().empty());
  const MFVec3f points{{0, 0, 0}, {1, 0, 0}, {kNaN, 0, 0}, {3, 2, 1}};
  const MFColor colors{kRed, kGreen, kBlue, kRed};
  set.points(points);
  Mesh mesh = set.mesh();
  CHECK(mesh.primitive == Mesh::Primitive::points);
  CHECK_FALSE(mesh.lit);
  CHECK(mesh.positions.shares_with(points));
  CHECK(ends(mesh) == std::vector<float>{0, 1, 3});
  CHECK(mesh.bounds.upper == glm::vec3(3, 2, 1));
  CHECK(mesh.colors.empty());

  mesh = set.colors(colors).mesh();
  CHECK(mesh.colors.shares_with(colors));
  CHECK(end_colors(mesh) == Colors{kRed, kGreen, kRed});
  CHECK(end_colors(set.colors({kRed, kGreen}).mesh()) == Colors{kRed, kGreen, kGreen});
  CHECK(end_colors(set.colors({kRed, kGreen, kBlue, kRed, kBlue}).mesh()) == Colors{kRed, kGreen, kRed});
  CHECK(set.points({{kNaN, kNaN, kNaN}}).mesh().empty());
}
