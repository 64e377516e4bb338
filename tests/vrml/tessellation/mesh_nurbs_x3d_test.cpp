#include "tests/vrml/mesh_checks.h"
#include "vrml/syntax/parser.h"
#include "vrml/tessellation/trimming.h"

#include <cmath>
#include <string>
#include <vector>

// Tests of the geometries of the X3D component NURBS.
namespace gs::vrml::test {
namespace {

/// X3D scene that consists of one geometry.
struct NurbsScene {
  SceneGraph scene{"test.x3dv"};
  Diagnostics diagnostics;

  explicit NurbsScene(const std::string& geometry) {
    scene.set_language(Language::x3d, 33);
    Parser(scene, diagnostics).parse_fragment("Shape { geometry " + geometry + " }");
    for (const Diagnostic& problem : diagnostics.entries()) UNSCOPED_INFO(problem.text());
    REQUIRE(diagnostics.errors() == 0);
  }
  [[nodiscard]] Mesh mesh() const { return tessellate(scene, scene.get<SFNode>(scene.roots()[0], "geometry"), {}); }
};

double mesh_area(const Mesh& mesh) {
  double area = 0;
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    const glm::vec3 a = mesh.positions[mesh.indices[i]];
    area += 0.5 * static_cast<double>(glm::length(
                      glm::cross(mesh.positions[mesh.indices[i + 1]] - a, mesh.positions[mesh.indices[i + 2]] - a)));
  }
  return area;
}

const std::string kFlatPatch =
    "controlPoint Coordinate { point [ 0 0 0, 2 0 0, 0 2 0, 2 2 0 ] } uDimension 2 vDimension 2 uOrder 2 vOrder 2 "
    "uKnot [ 0 0 4 4 ] vKnot [ 0 0 4 4 ] ";
const std::string kContour = "Contour2D { children ContourPolyline2D { controlPoint [ 1 1, 3 1, 3 3, 1 3, 1 1 ] } }";

}  // namespace

TEST_CASE("tessellates a NurbsPatchSurface like the NurbsSurface of VRML97 Amendment 1", "[x3d]") {
  const std::string numbers = "[ 0 0 0, 1 0 1, 2 0 0, 0 1 1, 1 1 2, 2 1 1, 0 2 0, 1 2 1, 2 2 0 ]";
  const std::string rest = " uDimension 3 vDimension 3 weight [ 1 1 1 1 2 1 1 1 1 ] uKnot [ 0 0 0 1 1 1 ] }";
  const Mesh x3d = NurbsScene("NurbsPatchSurface { controlPoint Coordinate { point " + numbers + " }" + rest).mesh();
  const Mesh in_doubles =
      NurbsScene("NurbsPatchSurface { controlPoint CoordinateDouble { point " + numbers + " }" + rest).mesh();
  SceneGraph scene;
  Diagnostics diagnostics;
  parse("#VRML V2.0 utf8\nShape { geometry NurbsSurface { controlPoint " + numbers + rest + " }", scene, diagnostics);
  REQUIRE(diagnostics.errors() == 0);
  const Mesh vrml97 = tessellate(scene, scene.get<SFNode>(scene.roots()[0], "geometry"), {});
  check_promises(x3d);
  REQUIRE(!x3d.empty());
  CHECK(x3d.positions == vrml97.positions);
  CHECK(in_doubles.positions == vrml97.positions);
  CHECK(x3d.normals == vrml97.normals);
  CHECK(x3d.indices == vrml97.indices);
}

TEST_CASE("draws a NurbsTrimmedSurface inside its contours, by the even-odd rule", "[x3d]") {
  const Mesh whole = NurbsScene("NurbsTrimmedSurface { " + kFlatPatch + "}").mesh();
  CHECK(mesh_area(whole) == Approx(4));
  const Mesh inside =
      NurbsScene("NurbsTrimmedSurface { " + kFlatPatch + "trimmingContour [ " + kContour + " ] }").mesh();
  check_promises(inside);
  CHECK(mesh_area(inside) == Approx(1));
  CHECK(inside.bounds.lower.x == Approx(0.5));
  CHECK(inside.bounds.upper.y == Approx(1.5));
  const std::string frame = "Contour2D { children ContourPolyline2D { controlPoint [ 0 0, 4 0, 4 4, 0 4 ] } }";
  const Mesh hole =
      NurbsScene("NurbsTrimmedSurface { " + kFlatPatch + "trimmingContour [ " + frame + kContour + " ] }").mesh();
  CHECK(mesh_area(hole) == Approx(3));
  for (const glm::vec3& normal : hole.normals) CHECK(normal.z == Approx(1));
}

TEST_CASE("trims by contours outside of the surface, of two corners and with equal corners", "[x3d]") {
  const auto area = [](const std::vector<std::vector<glm::dvec2>>& polygons) {
    double sum = 0;
    for (const auto& polygon : polygons)
      for (std::size_t i = 0; i < polygon.size(); ++i) {
        const glm::dvec2 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
        sum += (a.x * b.y - a.y * b.x) / 2;
      }
    return sum;
  };
  CHECK(area(trim({{{-1, -1}, {2, -1}, {2, 2}, {-1, 2}}}, 4, 4)) == Approx(1));
  CHECK(area(trim({{{2, 2}, {3, 2}, {3, 3}}}, 4, 4)) == 0);
  CHECK(area(trim({{{0.2, 0.2}, {0.8, 0.8}}}, 4, 4)) == Approx(0).margin(1e-12));
  CHECK(area(trim({{{0.2, 0.2}, {0.2, 0.2}, {0.8, 0.2}, {0.8, 0.2}, {0.2, 0.8}}}, 3, 5)) == Approx(0.18));
  CHECK(trim({}, 4, 4).empty());
  CHECK(trim({{}}, 4, 4).empty());
  CHECK(trim({{{0, 0}, {1, 0}, {1, 1}, {0, 1}}}, 7, 5).size() == 35);
}

TEST_CASE("swings a profile around the y axis in a NurbsSwungSurface", "[x3d]") {
  // A square of control points (w x, w y) with these weights is a circle of radius 3.
  const std::string circle =
      "NurbsCurve2D { order 3 knot [ 0 0 0 1 1 2 2 3 3 4 4 4 ] weight [ 1 0.70710678 1 0.70710678 1 0.70710678 1 "
      "0.70710678 1 ] controlPoint [ 3 0, 2.12132034 2.12132034, 0 3, -2.12132034 2.12132034, -3 0, "
      "-2.12132034 -2.12132034, 0 -3, 2.12132034 -2.12132034, 3 0 ] }";
  const Mesh tube = NurbsScene(
                        "NurbsSwungSurface { profileCurve ContourPolyline2D { controlPoint [ 1 0, 1 2 ] } "
                        "trajectoryCurve " +
                        circle + " }")
                        .mesh();
  check_promises(tube);
  REQUIRE(!tube.empty());
  for (const glm::vec3& point : tube.positions) CHECK(std::hypot(point.x, point.z) == Approx(3).epsilon(1e-5));
  CHECK(tube.bounds.upper.y == 2);
}

TEST_CASE("sweeps a cross-section along the trajectory of a NurbsSweptSurface", "[x3d]") {
  const Mesh box = NurbsScene(
                       "NurbsSweptSurface { crossSectionCurve ContourPolyline2D { controlPoint "
                       "[ 1 1, 1 -1, -1 -1, -1 1, 1 1 ] } trajectoryCurve NurbsCurve { order 2 controlPoint "
                       "Coordinate { point [ 0 0 0, 0 5 0 ] } } }")
                       .mesh();
  check_promises(box);
  CHECK(mesh_area(box) == Approx(40));
}

TEST_CASE("joins the ends of a closed NurbsCurve smoothly", "[x3d]") {
  const auto turn_at_seam = [](const std::string& closed) {
    const Mesh curve = NurbsScene("NurbsCurve { closed " + closed +
                                  " tessellation 64 controlPoint Coordinate { point "
                                  "[ 1 1 0, -1 1 0, -1 -1 0, 1 -1 0, 1 1 0 ] } }")
                           .mesh();
    const auto count = static_cast<std::size_t>(curve.positions.size());
    CHECK(glm::length(curve.positions[0] - curve.positions[count - 1]) < 1e-5F);
    return glm::dot(glm::normalize(curve.positions[1] - curve.positions[0]),
                    glm::normalize(curve.positions[count - 1] - curve.positions[count - 2]));
  };
  CHECK(turn_at_seam("TRUE") > 0.98F);
  CHECK(turn_at_seam("FALSE") < 0.1F);
}

TEST_CASE("keeps the knots of a closed circle of NURBS", "[x3d]") {
  const Mesh circle = NurbsScene(
                          "NurbsCurve { closed TRUE tessellation 32 knot [ 0 0 0 1 1 2 2 3 3 4 4 4 ] weight [ 1 "
                          "0.70710678 1 0.70710678 1 0.70710678 1 0.70710678 1 ] controlPoint CoordinateDouble { point "
                          "[ 1 0 0, 0.70710678 0.70710678 0, 0 1 0, -0.70710678 0.70710678 0, -1 0 0, -0.70710678 "
                          "-0.70710678 0, 0 -1 0, 0.70710678 -0.70710678 0, 1 0 0 ] } }")
                          .mesh();
  REQUIRE(circle.positions.size() == 33);
  for (const glm::vec3& point : circle.positions) CHECK(glm::length(point) == Approx(1).epsilon(1e-5));
}

TEST_CASE("draws nothing for NURBS geometries without valid control points", "[x3d]") {
  for (const char* geometry :
       {"NurbsPatchSurface { }", "NurbsPatchSurface { uDimension 2 vDimension 2000000000 }",
        "NurbsTrimmedSurface { trimmingContour [ Contour2D { } ] }", "NurbsSweptSurface { }", "NurbsSwungSurface { }",
        "NurbsCurve { order 40 controlPoint Coordinate { point [ 0 0 0, 1 1 1 ] } }",
        "NurbsCurve { controlPoint Normal { } }",
        "NurbsSwungSurface { profileCurve NurbsCurve2D { } trajectoryCurve ContourPolyline2D { } }"}) {
    CAPTURE(geometry);
    CHECK(NurbsScene(geometry).mesh().empty());
  }
}

}  // namespace gs::vrml::test
