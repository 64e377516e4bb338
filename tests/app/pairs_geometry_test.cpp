// Tests of geometries that must look alike: IndexedFaceSets of the same faces, and other notations.
#include "tests/app/pairs.h"
#include "vrml/syntax/parser.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace gs::app::pairs_geometry_test {

using namespace pairs;

namespace {

/// Beginning of each world: a view obliquely from above, and a light.
const std::string kScene =
    "NavigationInfo { headlight FALSE }\n"
    "Viewpoint { position 2.2 2.4 5 orientation -0.74 0.66 0.12 0.55 }\n"
    "DirectionalLight { direction -0.3 -1 -0.6 ambientIntensity 0.4 }\n";
/// Texture with four colours. None is black.
const std::string kTexture =
    "PixelTexture { image 4 2 3 0xff4040 0x40ff40 0x4040ff 0xffff40 0xff40ff 0x40ffff 0xffffff 0x808080 }";
const std::string kDressed =
    "appearance Appearance { material Material { specularColor 0.3 0.3 0.3 } texture " + kTexture + " }";

std::string shape(const std::string& geometry, const std::string& appearance = kDressed) {
  return "Shape { " + appearance + " geometry " + geometry + " }\n";
}
std::string colored(const std::string& color) {
  return "appearance Appearance { material Material { diffuseColor " + color + " } }";
}
std::string glowing(const std::string& color) {
  return "appearance Appearance { material Material { emissiveColor " + color + " } }";
}

/// Returns the mesh of a geometry node with this number of segments.
vrml::Mesh mesh_of(const std::string& geometry, int segments) {
  vrml::SceneGraph scene("text.wrl");
  Diagnostics diagnostics;
  (void)vrml::parse("#VRML V2.0 utf8\nShape { geometry " + geometry + " }", scene, diagnostics);
  REQUIRE(diagnostics.entries().empty());
  return vrml::tessellate(scene, scene.get<vrml::SFNode>(scene.roots()[0], "geometry"), {.segments = segments});
}

/// Checks that a curved geometry looks like one of its levels of detail.
template <class Text>
void check_alike_in_some_fineness(Studio& studio, const std::string& what, const std::string& a, const Text& b) {
  INFO(what);
  const render::Image first = studio.picture(a);
  CHECK(shown_pixels(first) > 120);
  std::size_t least = first.pixels.size();
  for (const int segments : render::ShapeResources::kSegments)
    least = std::min(least, compare_pictures(first, studio.picture(b(segments))).pixels);
  CHECK(least <= 12);
  (void)check_vrml1(studio, Files{{"main.wrl", a}}, 12);
}

const char* const kGeometries[] = {
    "Box { size 2 1 1.5 }",
    "Cone { bottomRadius 0.8 height 1.7 }",
    "Cylinder { side FALSE bottom FALSE }",
    "Cylinder { radius 0.7 height 1.5 }",
    "Cylinder { top FALSE bottom FALSE radius 0.7 }",
    "Sphere { radius 1.1 }",
    "ElevationGrid { xDimension 4 zDimension 3 xSpacing 0.5 zSpacing 0.6 height [ 0 0.3 0 0.2 0.5 0 0.6 0 0.1 0.7 0 "
    "0.3 ] }",
    "ElevationGrid { xDimension 3 zDimension 3 creaseAngle 2 height [ 0 0.3 0 0.2 0.5 0 0.6 0 0.1 ] }",
    "Extrusion { spine [ -0.8 -0.8 0, 0 0 0.3, 0.8 0.5 0 ] crossSection [ 0.5 0.5, 0.5 -0.5, 0 -0.2, -0.5 -0.5, -0.4 "
    "0.6, 0.5 0.5 ] }",
    "Extrusion { crossSection [ 0.9 0, 0.5 -0.8, -0.4 -0.9, -1 0, -0.5 0.7, 0 1 ] solid FALSE creaseAngle 1 beginCap "
    "FALSE endCap FALSE }",
};

}  // namespace

TEST_CASE("draws every geometry like the IndexedFaceSet of its triangles (VRML97 4.6.3, 6.23)") {
  Studio studio;
  for (const std::string geometry : kGeometries)
    check_alike_in_some_fineness(studio, geometry, kScene + shape(geometry),
                                 [&](int segments) { return kScene + shape(faces_of(mesh_of(geometry, segments))); });
  CHECK(studio.old_worlds() >= 4);
}

TEST_CASE("draws equal pictures of equal shapes by different geometry nodes") {
  Studio studio;
  const auto alike = [&](const std::string& what, const std::string& a, const std::string& b) {
    check_alike(studio, what, kScene + a, kScene + b);
  };
  // A Box has six faces with the whole texture each, upright seen from outside (6.7).
  alike("Box and its six faces", shape("Box { size 2 1 1.5 }"),
        shape("IndexedFaceSet { coord Coordinate { point [ -1 -0.5 0.75, 1 -0.5 0.75, 1 0.5 0.75, -1 0.5 0.75, "
              "-1 -0.5 -0.75, 1 -0.5 -0.75, 1 0.5 -0.75, -1 0.5 -0.75 ] } "
              "coordIndex [ 0 1 2 3 -1 5 4 7 6 -1 1 5 6 2 -1 4 0 3 7 -1 3 2 6 7 -1 4 5 1 0 -1 ] "
              "texCoord TextureCoordinate { point [ 0 0, 1 0, 1 1, 0 1 ] } "
              "texCoordIndex [ 0 1 2 3 -1 0 1 2 3 -1 0 1 2 3 -1 0 1 2 3 -1 0 1 2 3 -1 0 1 2 3 -1 ] }"));
  alike("Box and the default Extrusion",
        "Transform { translation 0 0.5 0 children " + shape("Box { size 2 1 2 }", colored("1 0.5 0.2")) + " }",
        shape("Extrusion { }", colored("1 0.5 0.2")));
  alike("ElevationGrid and its faces",
        shape("ElevationGrid { xDimension 3 zDimension 2 xSpacing 0.7 zSpacing 1.2 height [ 0 0.5 0.1 0.3 0 0.6 ] }"),
        shape("IndexedFaceSet { coord Coordinate { point [ 0 0 0, 0.7 0.5 0, 1.4 0.1 0, 0 0.3 1.2, 0.7 0 1.2, 1.4 0.6 "
              "1.2 ] } "
              "coordIndex [ 0 3 4 1 -1 1 4 5 2 -1 ] texCoord TextureCoordinate { point [ 0 0, 0.5 0, 1 0, 0 1, 0.5 1, "
              "1 1 ] } }"));
  // A tube with texture counter-clockwise from the back, like a Cylinder's (6.14, 6.18).
  check_alike_in_some_fineness(
      studio, "Cylinder and Extrusion", kScene + shape("Cylinder { radius 0.7 height 1.4 top FALSE bottom FALSE }"),
      [](int segments) {
        std::string section;
        for (int i = 0; i <= segments; ++i) {
          const double angle = 2 * std::numbers::pi * (i % segments) / segments;
          section += number(-0.7 * std::sin(angle)) + number(-0.7 * std::cos(angle));
        }
        return kScene + shape("Extrusion { crossSection [ " + section +
                              " ] spine [ 0 -0.7 0, 0 0.7 0 ] creaseAngle 1 beginCap FALSE endCap FALSE }");
      });
  alike(
      "repeated points of an Extrusion",
      shape("Extrusion { spine [ 0 -1 0, 0.3 0 0, 0 1 0 ] crossSection [ 0.5 0.5, 0.5 -0.5, -0.5 -0.5, 0.5 0.5 ] }"),
      shape("Extrusion { spine [ 0 -1 0, 0 -1 0, 0.3 0 0, 0.3 0 0, 0 1 0 ] crossSection [ 0.5 0.5, 0.5 -0.5, 0.5 -0.5, "
            "-0.5 -0.5, 0.5 0.5, 0.5 0.5 ] }"));
  CHECK(studio.old_worlds() >= 4);
}

TEST_CASE("draws equal pictures of faces in any notation (VRML97 6.23)") {
  Studio studio;
  const auto alike = [&](const std::string& what, const std::string& a, const std::string& b,
                         const std::string& appearance = kDressed) {
    check_alike(studio, what, kScene + shape("IndexedFaceSet { " + a + " }", appearance),
                kScene + shape("IndexedFaceSet { " + b + " }", appearance));
  };
  // An L of six corners that faces +Z, and a roof of two faces.
  const std::string l = "coord Coordinate { point [ -1 -1 0, 1 -1 0, 1 0 0, 0 0 0, 0 1 0, -1 1 0 ] } ";
  const std::string roof =
      "coord Coordinate { point [ -1 -0.5 1, 0 0.3 1, 1 -0.5 1, -1 -0.5 -1, 0 0.3 -1, 1 -0.5 -1 ] } ";
  const std::string faces = "coordIndex [ 0 1 4 3 -1 1 2 5 4 -1 ] ";
  alike("concave and cut", l + "convex FALSE coordIndex [ 0 1 2 3 4 5 -1 ]",
        l + "coordIndex [ 0 1 2 3 -1 0 3 4 5 -1 ]");
  alike("without the last -1", roof + "coordIndex [ 0 1 4 3 -1 1 2 5 4 ]", roof + faces);
  alike("clockwise", roof + "ccw FALSE coordIndex [ 3 4 1 0 -1 4 5 2 1 -1 ]", roof + faces);
  alike("repeated corners", roof + "coordIndex [ 0 0 1 4 4 3 0 -1 1 2 2 5 4 -1 ]", roof + faces);
  alike("faces of one and two corners", roof + "coordIndex [ 2 -1 0 1 4 3 -1 5 2 -1 1 2 5 4 -1 ]", roof + faces);
  alike(
      "colours by an index",
      roof + faces + "color Color { color [ 1 0 0, 0 1 0, 0 0 1 ] } colorIndex [ 0 1 2 0 -1 1 1 0 2 -1 ]",
      "coord Coordinate { point [ -1 -0.5 1, 0 0.3 1, 0 0.3 -1, -1 -0.5 -1, 0 0.3 1, 1 -0.5 1, 1 -0.5 -1, 0 0.3 -1 ] } "
      "coordIndex [ 0 1 2 3 -1 4 5 6 7 -1 ] color Color { color [ 1 0 0, 0 1 0, 0 0 1, 1 0 0, 0 1 0, 0 1 0, 1 0 0, 0 0 "
      "1 ] }",
      colored("1 1 1"));
  alike("colours by face", roof + faces + "colorPerVertex FALSE color Color { color [ 1 0.2 0.2, 0.2 1 0.2 ] }",
        roof + faces + "colorPerVertex FALSE color Color { color [ 0.2 1 0.2, 0 0 0, 1 0.2 0.2 ] } colorIndex [ 2 0 ]",
        colored("1 1 1"));
  alike("flat normals, given and made", roof + faces,
        roof + faces +
            "normalPerVertex FALSE normal Normal { vector [ -0.6246950 0.7808688 0, 0.6246950 0.7808688 0 ] }");
  alike("smooth normals, given and made", roof + faces + "creaseAngle 3",
        roof + faces +
            "normal Normal { vector [ -0.6246950 0.7808688 0, 0 1 0, 0.6246950 0.7808688 0, -0.6246950 0.7808688 0, 0 "
            "1 0, "
            "0.6246950 0.7808688 0 ] }");
  // S is along the longest side of the box, T along the next one; the longest side scales both. The order X, Y, Z
  // decides between equal sides.
  alike("default texture coordinates", roof + faces,
        roof + faces + "texCoord TextureCoordinate { point [ 0 1, 0.5 1, 1 1, 0 0, 0.5 0, 1 0 ] }");
  alike("seen from behind",
        "solid FALSE coord Coordinate { point [ -1 -1 0, -1 1 0, 1 1 0, 1 -1 0 ] } coordIndex [ 0 1 2 3 ] "
        "texCoord TextureCoordinate { point [ 0 0, 0 1, 1 1, 1 0 ] }",
        "coord Coordinate { point [ -1 -1 0, 1 -1 0, 1 1 0, -1 1 0 ] } coordIndex [ 0 1 2 3 ] "
        "texCoord TextureCoordinate { point [ 0 0, 1 0, 1 1, 0 1 ] }");
  CHECK(studio.old_worlds() >= 22);
}

TEST_CASE("draws equal pictures of lines and points in any notation (VRML97 6.24, 6.36)") {
  Studio studio;
  const std::string points = "coord Coordinate { point [ -1 -1 0, 1 -1 0, 1 1 0, -1 1 0, -1 0 1, 1 0 1 ] } ";
  const auto lines = [&](const std::string& rest, const std::string& appearance = glowing("1 0 0")) {
    return shape("IndexedLineSet { " + points + rest + " }", appearance);
  };
  const auto alike = [&](const std::string& what, const std::string& a, const std::string& b) {
    INFO(what);
    const render::Image first = studio.picture(kScene + a), second = studio.picture(kScene + b);
    CHECK(shown_pixels(first) > 10);
    CHECK(compare_pictures(first, second).pixels <= 4);
    for (const std::string* const world : {&a, &b}) (void)check_vrml1(studio, Files{{"main.wrl", kScene + *world}}, 4);
  };
  alike("polylines in one node and two", lines("coordIndex [ 0 1 2 -1 3 4 5 ]"),
        lines("coordIndex [ 0 1 2 ]") + lines("coordIndex [ 3 4 5 ]"));
  alike("colours by polyline and by Material",
        lines("coordIndex [ 0 1 2 -1 3 4 5 ] colorPerVertex FALSE color Color { color [ 0 1 0, 0 0 1 ] }"),
        lines("coordIndex [ 0 1 2 ]", glowing("0 1 0")) + lines("coordIndex [ 3 4 5 ]", glowing("0 0 1")));
  alike("colours by an index",
        lines("coordIndex [ 0 1 2 -1 3 4 5 ] color Color { color [ 0 1 0, 0 0 1 ] } colorIndex [ 0 0 0 -1 1 1 1 ]"),
        lines("coordIndex [ 0 1 2 ]", glowing("0 1 0")) + lines("coordIndex [ 3 4 5 ]", glowing("0 0 1")));
  alike("lights do not count", lines("coordIndex [ 0 1 2 ]"),
        "PointLight { location 0 0 2 }" + lines("coordIndex [ 0 1 2 ]"));
  alike("points by Color and by Material",
        shape("PointSet { coord Coordinate { point [ -1 -1 0, 1 -1 0, 1 1 0, -1 1 0 ] } color Color { color [ 1 0 0, 1 "
              "0 0, 1 0 0, 1 0 0 ] } }"),
        shape("PointSet { coord Coordinate { point [ -1 -1 0, 1 -1 0, 1 1 0, -1 1 0 ] } }", glowing("1 0 0")));
  CHECK(studio.old_worlds() >= 10);
}

}  // namespace gs::app::pairs_geometry_test
