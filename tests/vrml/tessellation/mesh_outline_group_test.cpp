#include "vrml/mesh/mesh.h"
#include "vrml/syntax/parser.h"
#include "vrml/syntax/printer.h"

#include <catch2/catch.hpp>
#include <glm/geometric.hpp>

#include <cmath>
#include <string>
#include <vector>

using namespace gs;

using namespace gs::vrml;

namespace {

struct Outlines {
  SceneGraph scene{"outlines.wrl"};
  Diagnostics diagnostics;
  std::vector<NodeId> nodes;  // in the order of the text

  explicit Outlines(const std::string& text) {
    REQUIRE(parse("#VRML V2.0 utf8\n" + text, scene, diagnostics) == ParseOutcome::complete);
    for (std::uint32_t i = 1; i <= scene.nodes().count(); ++i)
      if (scene.nodes().at(i).type == built_in_node_type("OutlineGroup")) nodes.push_back(scene.nodes().id_at(i));
  }
  [[nodiscard]] Mesh mesh(std::size_t i = 0, NodeId refiner = {}) const {
    MeshOptions options;
    options.refiner = refiner;
    return tessellate(scene, nodes.at(i), options);
  }
};

double area(const Mesh& mesh) {
  double sum = 0;
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    const glm::vec3 a = mesh.positions[mesh.indices[i]], b = mesh.positions[mesh.indices[i + 1]],
                    c = mesh.positions[mesh.indices[i + 2]];
    const glm::vec3 cross = glm::cross(b - a, c - a);
    sum += std::sqrt(glm::dot(cross, cross)) / 2;
  }
  return sum;
}

// A square of 4 that replaces two triangles of a folded sheet (2 sqrt 3 each), and a square with a hole that remains.
const std::string kOutline =
    "outline [ 0 0 0, 2 0 0, 2 2 0, 0 2 0 ] outlineIndex [ 0 1 2 3 -1 ] groupSize [ 2 ] "
    "point [ 3 0 0, 5 0 0, 5 2 0, 3 2 0, 3.5 .5 0, 3.5 1.5 0, 4.5 1.5 0, 4.5 .5 0 ] "
    "coordIndex [ 0 1 2 3 0 4 5 6 7 4 -1 ] ";
const std::string kInner =
    "group [ 0 0 ] point [ 0 0 0, 2 0 0, 0 2 2, 2 0 0, 2 2 2, 0 2 2 ] coordIndex [ 0 1 2 -1 3 4 5 -1 ] ";
const double kFolded = 2 * 2 * std::sqrt(2.0);  // 2 wide, slope of 45 degrees

}  // namespace

TEST_CASE("fills an outline until all its polygons are received") {
  CHECK(area(Outlines("Shape { geometry OutlineGroup { " + kOutline + "} }").mesh()) == Approx(4 + 3));
  // Polygons in the same node.
  const std::string own = "outline [ 0 0 0, 2 0 0, 2 2 0, 0 2 0 ] outlineIndex [ 0 1 2 3 -1 ] groupSize [ 2 ] ";
  CHECK(area(Outlines("Shape { geometry OutlineGroup { " + own + kInner + "} }").mesh()) == Approx(kFolded));
  const std::string first = "group [ 0 ] point [ 0 0 0, 2 0 0, 0 2 2 ] coordIndex [ 0 1 2 -1 ] ";
  CHECK(area(Outlines("Shape { geometry OutlineGroup { " + own + first + "} }").mesh()) == Approx(4));
  // A complete group with a lost polygon lacks only that polygon.
  const std::string ended = "complete TRUE ";
  CHECK(area(Outlines("Shape { geometry OutlineGroup { " + own + first + ended + "} }").mesh()) == Approx(kFolded / 2));
  CHECK(area(Outlines("Shape { geometry OutlineGroup { " + own + ended + "} }").mesh()) == Approx(4));
}

TEST_CASE("accepts the polygons of an OutlineGroup in a second node") {
  const std::string base = "Shape { geometry DEF R OutlineGroup { " + kOutline + "} } ";
  const Outlines whole(base + "Shape { geometry OutlineGroup { refines USE R " + kInner + "} }");
  REQUIRE(whole.nodes.size() == 2);
  // The refined node draws the polygons of its refinement.
  CHECK(area(whole.mesh(0, whole.nodes[1])) == Approx(3 + kFolded));
  CHECK(whole.mesh(1).empty());
  const Outlines part(base +
                      "Shape { geometry OutlineGroup { refines USE R group [ 0 ] point [ 0 0 0, 2 0 0, 0 2 2 ] "
                      "coordIndex [ 0 1 2 -1 ] } }");
  CHECK(area(part.mesh(0, part.nodes[1])) == Approx(4 + 3));
  // Several outlines belong to one group, by its number. A group without an outline shows each polygon when it is
  // received.
  const Outlines numbered(
      "Shape { geometry DEF R OutlineGroup { outline [ 0 0 0, 1 0 0, 0 1 0, 5 0 0, 6 0 0, 5 1 0 ] "
      "outlineIndex [ 0 1 2 -1 3 4 5 -1 ] outlineGroup [ 1 1 ] groupSize [ 9 1 ] } } "
      "Shape { geometry OutlineGroup { refines USE R group [ 0 1 ] point [ 0 0 0, 3 0 0, 0 3 0, 9 0 0, 9 2 0, 9 0 2 ] "
      "coordIndex [ 0 1 2 -1 3 4 5 -1 ] } }");
  CHECK(area(numbered.mesh(0, numbered.nodes[1])) == Approx(4.5 + 2));
}

TEST_CASE("smooths polygons of an OutlineGroup where they meet, and keeps their textures") {
  const std::string roof =
      "point [ 0 0 0, 2 0 0, 2 1 1, 0 1 1, 0 1 1, 2 1 1, 2 2 0, 0 2 0 ] coordIndex [ 0 1 2 3 -1 4 5 6 7 -1 ] "
      "texCoord [ 0 0, 1 0, 1 .5, 0 .5, 0 .6, 1 .6, 1 1, 0 1 ] ";
  const auto top_normal = [&](const std::string& more) {
    const Mesh mesh = Outlines("Shape { geometry OutlineGroup { " + roof + more + "} }").mesh();
    REQUIRE(mesh.indices.size() == 12);
    REQUIRE(mesh.normals.size() == mesh.positions.size());
    double sum = 0;
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
      if (mesh.positions[i] == glm::vec3(2, 1, 1)) sum += std::abs(mesh.normals[i].y);
      const bool upper = mesh.texture_coordinates[i].y > 0.55f;
      CHECK(mesh.texture_coordinates[i].x == Approx(mesh.positions[i].x / 2));
      if (mesh.positions[i].y == 0) CHECK_FALSE(upper);
      if (mesh.positions[i].y == 2) CHECK(upper);
    }
    return sum;
  };
  CHECK(top_normal("") > 1.4);  // of both faces, 45 degrees each
  CHECK(top_normal("creaseAngle 3 ") == Approx(0).margin(1e-5));
}

TEST_CASE("tolerates wrong numbers in an OutlineGroup") {
  for (const char* text :
       {"outlineIndex [ 0 1 2 -1 ]", "outline [ 0 0 0 ] outlineIndex [ 0 0 0 -1 ]",
        "outline [ 0 0 0, 1 0 0, 0 1 0 ] outlineIndex [ 0 1 2147483647 ]", "coordIndex [ 5 6 7 -1 ] group [ 3 ]",
        "groupSize [ -5 2147483647 ] outlineGroup [ -1 7 ] group [ -9 ]", "refines NULL complete TRUE"})
    CHECK(Outlines("Shape { geometry OutlineGroup { " + std::string(text) + " } }").mesh().empty());
  // Polygons of unknown groups are shown.
  const Outlines strange(
      "Shape { geometry OutlineGroup { outline [ 0 0 0, 1 0 0, 0 1 0 ] outlineIndex [ 0 1 2 -1 ] outlineGroup [ 99 ] "
      "point [ 0 0 0, 2 0 0, 0 2 0 ] coordIndex [ 0 1 2 ] group [ -7 ] complete TRUE } }");
  CHECK(area(strange.mesh()) == Approx(0.5 + 2));
  // One node refines itself, and two nodes refine each other.
  Outlines circle("Shape { geometry DEF A OutlineGroup { " + kOutline + "} } Shape { geometry DEF B OutlineGroup { " +
                  kOutline + "refines USE A } }");
  circle.scene.set<SFNode>(circle.nodes[0], "refines", circle.nodes[1]);
  CHECK(circle.mesh(0, circle.nodes[1]).empty());
  circle.scene.set<SFNode>(circle.nodes[0], "refines", circle.nodes[0]);
  CHECK(circle.mesh(0, circle.nodes[0]).empty());
}

TEST_CASE("prefers the built-in OutlineGroup over a PROTO of equal name and interface") {
  const auto text = [](const std::string& interface) {
    return "PROTO OutlineGroup [ " + interface +
           " ] { IndexedFaceSet { coord Coordinate { point IS point } coordIndex IS coordIndex convex FALSE } }\n"
           "Shape { geometry OutlineGroup { point [ 0 0 0, 1 0 0, 0 1 0 ] coordIndex [ 0 1 2 -1 ] } }\n";
  };
  const std::string plain = "field MFVec3f point [] field MFInt32 coordIndex []";
  const Outlines native(text(plain));
  REQUIRE(native.nodes.size() == 1);
  CHECK(area(native.mesh()) == Approx(0.5));
  const std::string printed = print(native.scene);
  const Outlines again(printed.substr(printed.find('\n') + 1));
  CHECK(print(again.scene) == printed);
  CHECK(printed.find("PROTO OutlineGroup") != std::string::npos);
  CHECK(Outlines(text(plain + " field SFInt32 more 1")).nodes.empty());
  CHECK(Outlines(text("field MFVec3f point [] exposedField MFInt32 coordIndex []")).nodes.empty());
}
