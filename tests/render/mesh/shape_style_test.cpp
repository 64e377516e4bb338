#include "render/scene/shape_style.h"

#include "render/rays/item_bvh.h"
#include "tests/render/drawing.h"
#include "tests/render/x3d_scene.h"

#include <bit>
#include <set>
#include <string>

namespace gs::render::shape_style_test {
using namespace gs::render::testing;
namespace {

const std::string kWhite = "appearance Appearance { ";
/// Square from -4 to 4 that fills the image of camera_at({0, 0, 10}).
const std::string kWall = "geometry Rectangle2D { size 20 20 }";

glm::vec3 at_center(const Image& image) { return pixel(image, image.width / 2, image.height / 2); }
std::size_t bright(const Image& image) {
  std::size_t count = 0;
  for (std::uint32_t y = 0; y < image.height; ++y)
    for (std::uint32_t x = 0; x < image.width; ++x) count += pixel(image, x, y).x > 127 ? 1 : 0;
  return count;
}

}  // namespace

TEST_CASE("has a pattern of its own for each type of hatches and dashes") {
  std::set<ShapeStyle::Hatch> hatches;
  for (int style = 1; style <= 19; ++style) {
    const ShapeStyle::Hatch& rows = hatch_pattern(style);
    int drawn = 0;
    for (const std::uint32_t row : rows) drawn += std::popcount(row);
    CHECK(drawn > 30);
    CHECK(drawn < 700);
    hatches.insert(rows);
  }
  CHECK(hatches.size() == 19);
  CHECK(hatch_pattern(0) == hatch_pattern(1));
  CHECK(hatch_pattern(20) == hatch_pattern(1));
  CHECK(line_pattern(1) == ShapeStyle::kSolidLine);
  CHECK(line_pattern(99) == ShapeStyle::kSolidLine);
  std::set<std::uint32_t> lines;
  for (const int type : {2, 3, 4, 5, 9, 10, 11, 12, 13}) lines.insert(line_pattern(type));
  CHECK(lines.size() == 9);
}

TEST_CASE("draws lines as wide as LineProperties say") {
  Drawing drawing;
  const auto lines = [&](const std::string& properties) {
    return bright(drawing.draw(
        x3d_list("Shape { " + kWhite + properties + " } geometry Polyline2D { lineSegments [ -20 0.1 20 0.1 ] } }")));
  };
  const std::size_t thin = lines("");
  CHECK(thin == 64);
  CHECK(lines("lineProperties LineProperties { linewidthScaleFactor 5 }") == 5 * 64);
  CHECK(lines("lineProperties LineProperties { linewidthScaleFactor 5 applied FALSE }") == 64);
}

TEST_CASE("lights wide lines with normals (X3D 11.4)") {
  Drawing drawing;
  const auto list = x3d_list(
      "Shape { appearance Appearance { material Material { diffuseColor 1 0.5 0 } lineProperties LineProperties { "
      "linewidthScaleFactor 9 } } geometry LineSet { vertexCount 2 normal Normal { vector [ 0 0 1 0 0 1 ] } coord "
      "Coordinate { point [ -4 0 0 4 0 0 ] } } }");
  check_color(at_center(drawing.draw(list, camera_at({0, 0, 10}))), {1, 0.5f, 0}, 3);
}

TEST_CASE("draws the dashes of a line type") {
  Drawing drawing;
  const auto lines = [&](const std::string& type) {
    return bright(drawing.draw(x3d_list("Shape { " + kWhite + " lineProperties LineProperties { linetype " + type +
                                        " } } geometry Polyline2D { lineSegments [ -20 0.1 20 0.1 ] } }")));
  };
  CHECK(lines("1") == 64);
  const std::size_t dashed = lines("2");
  CHECK(dashed > 20);
  CHECK(dashed < 44);
  CHECK(lines("4") < 64);
}

TEST_CASE("draws points as large as PointProperties say") {
  Drawing drawing;
  const auto points = [&](const std::string& properties) {
    return bright(
        drawing.draw(x3d_list("Shape { " + kWhite + properties + " } geometry Polypoint2D { point [ 0.05 0.05 ] } }")));
  };
  CHECK(points("") == 4);
  CHECK(points("pointProperties PointProperties { pointSizeScaleFactor 6 }") == 36);
  // At 10 m, the size is 60 / 10.
  CHECK(points("pointProperties PointProperties { pointSizeScaleFactor 60 attenuation 0 1 0 pointSizeMaxValue 100 }") ==
        36);
  CHECK(points("pointProperties PointProperties { pointSizeScaleFactor 60 attenuation 0 1 0 pointSizeMaxValue 4 }") ==
        16);
}

TEST_CASE("covers each point of PointProperties with the texture") {
  Drawing drawing;
  const Image image = drawing.draw(
      x3d_list("Shape { appearance Appearance { texture PixelTexture { image 2 2 3 0xff0000 0x00ff00 0x0000ff 0xffff00 "
               "} pointProperties PointProperties { pointSizeScaleFactor 40 } } geometry Polypoint2D { point [ 0.05 "
               "0.05 ] } }"));
  // The first row of a PixelTexture is the lower one.
  CHECK(pixel(image, 22, 42).x > 200);
  CHECK(pixel(image, 42, 42).y > 200);
  CHECK(pixel(image, 22, 22).z > 200);
  CHECK(pixel(image, 42, 22).x > 200);
  CHECK(pixel(image, 4, 4) == glm::vec3(0));
}

TEST_CASE("draws hatches of FillProperties with and without the filling") {
  Drawing drawing;
  const auto wall = [&](const std::string& properties) {
    return drawing.draw(
        x3d_list("Shape { appearance Appearance { material Material { diffuseColor 0 0 0 emissiveColor 0 0 1 } "
                 "fillProperties FillProperties { " +
                 properties + " } } " + kWall + " }"));
  };
  const Image hatched = wall("hatchColor 1 0 0 hatchStyle 1");
  std::size_t red = 0, blue = 0;
  for (std::uint32_t y = 0; y < 64; ++y) {
    red += pixel(hatched, 10, y).x > 200 ? 1 : 0;
    blue += pixel(hatched, 10, y).z > 200 ? 1 : 0;
  }
  CHECK(red == 8);
  CHECK(blue == 56);
  const Image open = wall("filled FALSE hatchColor 1 0 0");
  CHECK(bright(open) == 8 * 64);
  CHECK(pixel(open, 10, 1).z < 10);
  CHECK(at_center(wall("filled FALSE hatched FALSE")).z < 10);
  CHECK(at_center(wall("hatched FALSE")).z > 200);
}

TEST_CASE("blends surfaces with the alpha of a ColorRGBA") {
  Drawing drawing;
  const auto color = [&](const std::string& rgba) {
    return at_center(drawing.draw(x3d_list(
        "Shape { geometry TriangleSet { coord Coordinate { point [ -9 -9 0, 9 -9 0, 0 9 0 ] } color ColorRGBA { "
        "color [ " +
        rgba + ", " + rgba + ", " + rgba + " ] } } }")));
  };
  check_color(color("1 0 0 0.5"), {0.5f, 0, 0}, 2);
  check_color(color("1 0 0 1"), {1, 0, 0}, 2);
  check_color(color("1 0 0 0"), {0, 0, 0}, 2);
}

TEST_CASE("clips the shapes of a group by its ClipPlane") {
  const std::string wall = "Shape { " + kWhite + "} " + kWall + " }";
  Drawing drawing;
  const Image half = drawing.draw(x3d_list("Group { children [ " + wall + " ClipPlane { plane 1 0 0 0 } ] }"));
  CHECK(pixel(half, 10, 32).x < 10);
  CHECK(pixel(half, 54, 32).x > 200);
  CHECK(bright(half) == 32 * 64);
  SECTION("in the space of the plane") {
    const Image moved = drawing.draw(x3d_list(
        "Transform { translation 100 0 0 children [ ClipPlane { plane 1 0 0 100 } Transform { translation -100 "
        "0 0 children " +
        wall + " } ] }"));
    CHECK(bright(moved) == 32 * 64);
  }
  SECTION("but not the shapes beside the group") {
    CHECK(bright(drawing.draw(x3d_list("Group { children [ ClipPlane { plane 1 0 0 0 } ] } " + wall))) == 64 * 64);
  }
  SECTION("by six planes at once") {
    std::string planes;
    for (const char* plane : {"1 0 0 1", "-1 0 0 1", "0 1 0 1", "0 -1 0 1", "0 0 1 1", "0 0 -1 1"})
      planes += std::string("ClipPlane { plane ") + plane + " } ";
    const std::size_t left = bright(drawing.draw(x3d_list(planes + wall)));
    CHECK(left > 100);
    CHECK(left < 400);
  }
  SECTION("unless the plane is not enabled") {
    CHECK(bright(drawing.draw(x3d_list("ClipPlane { plane 1 0 0 0 enabled FALSE } " + wall))) == 64 * 64);
  }
}

TEST_CASE("finds nothing on the line of sight where a ClipPlane has clipped it") {
  const RenderList list = x3d_list("Group { children [ ClipPlane { plane 0 0 -1 0 } Shape { geometry Box {} } ] }");
  ItemBvh rays;
  const auto hit = rays.nearest(list, {{0.2, 0.3, 10}, {0, 0, -1}});
  REQUIRE(hit);
  CHECK(hit->point.z == Approx(-1));
  CHECK(hit->triangle.distance == Approx(11));
}

TEST_CASE("applies a LocalFog to its group, and a FogCoordinate to vertices") {
  Drawing drawing;
  const std::string wall = "Shape { " + kWhite + "} " + kWall + " } ";
  const Image local =
      drawing.draw(x3d_list("Group { children [ LocalFog { color 1 0 0 visibilityRange 20 } " + wall + " ] }"));
  check_color(at_center(local), {1, 0.5f, 0.5f}, 4);
  CHECK(at_center(drawing.draw(x3d_list("Group { children LocalFog { visibilityRange 20 color 1 0 0 } } " + wall))).y >
        250);
  const Image depths = drawing.draw(x3d_list(
      "Fog { color 1 0 0 visibilityRange 1000 } Shape { " + kWhite +
      "} geometry TriangleSet { coord Coordinate { point [ -9 -9 0, 9 -9 0, 0 9 0 ] } fogCoord FogCoordinate { "
      "depth [ 0.5 0.5 0.5 ] } } }"));
  check_color(at_center(depths), {1, 0.5f, 0.5f}, 4);
}

TEST_CASE("draws nothing of shapes and groups that are not visible") {
  const std::string shape = "Shape { geometry Box {} }";
  CHECK(x3d_list(shape).items.size() == 1);
  CHECK(x3d_list("Shape { visible FALSE geometry Box {} }").items.empty());
  for (const char* group : {"Group", "Transform", "Collision", "Billboard", "CADLayer", "CADPart", "StaticGroup"}) {
    CHECK(x3d_list(std::string(group) + " { children " + shape + " }").items.size() == 1);
    CHECK(x3d_list(std::string(group) + " { visible FALSE children " + shape + " }").items.empty());
  }
  CHECK(x3d_list("Group { visible FALSE children PointLight {} }").lights.empty());
}

TEST_CASE("draws the shape of a CADFace in its CADPart") {
  const RenderList list = x3d_list(
      "CADAssembly { children CADLayer { children CADPart { translation 1 2 3 children CADFace { shape Shape { "
      "geometry "
      "QuadSet { coord Coordinate { point [ 0 0 0, 1 0 0, 1 1 0, 0 1 0 ] } } } } } } }");
  REQUIRE(list.items.size() == 1);
  CHECK(glm::dvec3(list.items[0].world_from_node[3]) == glm::dvec3(1, 2, 3));
}

TEST_CASE("shows the children of a CADLayer of X3D 3 by its list `visible`") {
  const auto items = [](const std::string& version, const std::string& visible) {
    const auto scene = std::make_shared<vrml::SceneGraph>("layer.x3dv");
    Diagnostics diagnostics;
    (void)vrml::parse("#X3D V" + version + " utf8\nCADLayer { " + visible + " children [ " +
                          "Transform { translation 1 0 0 children Shape { geometry Box { } } } "
                          "Transform { translation 2 0 0 children Shape { geometry Box { } } } "
                          "Transform { translation 3 0 0 children Shape { geometry Box { } } } ] }",
                      *scene, diagnostics);
    CHECK(diagnostics.errors() == 0);
    MeshCache meshes;
    std::multiset<double> places;
    for (const DrawItem& item : collect(*scene, {}, meshes).items) places.insert(item.world_from_node[3].x);
    return places;
  };
  CHECK(items("3.3", "") == std::multiset<double>{1, 2, 3});
  CHECK(items("3.3", "visible [ TRUE FALSE TRUE ]") == std::multiset<double>{1, 3});
  CHECK(items("3.0", "visible FALSE") == std::multiset<double>{2, 3});
  CHECK(items("4.0", "visible FALSE").empty());
  CHECK(items("4.0", "visible TRUE").size() == 3);
}

TEST_CASE("draws an imported node also where a group uses it") {
  const auto outer = x3d_scene(
      "DEF I Inline { } IMPORT I.Part Transform { translation 0 5 0 children USE Part } Shape { geometry Sphere { } }");
  const auto collected = [&] {
    MeshCache meshes;
    return collect(*outer, {}, meshes);
  };
  CHECK(collected().items.size() == 1);
  std::shared_ptr<vrml::SceneGraph> inner = x3d_scene(
      "Shape { geometry Cone { } } DEF P Transform { translation 1 0 0 children Shape { geometry Box { } } } EXPORT P "
      "AS "
      "Part");
  outer->inlines().attach(outer->roots()[0], inner);
  const RenderList list = collected();
  REQUIRE(list.items.size() == 4);
  std::multiset<std::pair<double, double>> places;
  for (const DrawItem& item : list.items) places.emplace(item.world_from_node[3].x, item.world_from_node[3].y);
  CHECK(places == std::multiset<std::pair<double, double>>{{0, 0}, {0, 0}, {1, 0}, {1, 5}});
}

TEST_CASE("draws the box of a node with bboxDisplay") {
  const RenderList list =
      x3d_list("Transform { translation 1 0 0 bboxDisplay TRUE children Shape { geometry Box {} } }");
  REQUIRE(list.items.size() == 2);
  CHECK(list.items[1].mesh->primitive == vrml::Mesh::Primitive::lines);
  CHECK(list.items[1].mesh->bounds.upper == glm::vec3(1, 1, 1));
  CHECK(glm::dvec3(list.items[1].world_from_node[3]) == glm::dvec3(1, 0, 0));
  const RenderList given = x3d_list("Shape { bboxDisplay TRUE bboxSize 4 6 8 geometry Sphere {} }");
  REQUIRE(given.items.size() == 2);
  CHECK(given.items[1].mesh->bounds.upper == glm::vec3(2, 3, 4));
}

}  // namespace gs::render::shape_style_test
