// Pictures of GeoLODs (X3D 25.3.4).

#include "tests/render/drawing.h"
#include "tests/render/x3d_scene.h"
#include "vrml/scene/coordinates/geo_tiles.h"

#include <string>

namespace gs::render::geo_lod_picture_test {
using namespace gs::render::testing;
namespace {

std::string glowing_box(const std::string& color, const std::string& place) {
  return "Transform { translation " + place +
         " children Shape { appearance Appearance { material Material { diffuseColor 0 0 0 emissiveColor " + color +
         " } } geometry Box { } } } ";
}

}  // namespace

TEST_CASE("draws either the root or the children of a GeoLOD", "[picture]") {
  const auto scene = x3d_scene("GeoLOD { geoSystem \"GC\" rootNode " + glowing_box("1 0 0", "0 0 0") +
                               " child1Url \"left\" child3Url \"right\" }");
  const vrml::NodeId lod = scene->roots()[0];
  MeshCache meshes;
  Drawing drawing;
  const auto picture = [&] { return drawing.draw(collect(*scene, {}, meshes)); };
  const Image root = picture();
  CHECK(pixel(root, 32, 32).r > 0.9f);
  CHECK(pixel(root, 32, 32).g < 0.1f);
  REQUIRE(vrml::make_child_tiles(*scene, lod));
  CHECK_FALSE(vrml::make_child_tiles(*scene, lod));
  vrml::GeoTiles& tiles = scene->inlines().tiles(lod);
  REQUIRE(tiles.children.size() == 2);
  scene->inlines().attach(tiles.children[0], x3d_scene(glowing_box("0 1 0", "-2 0 0")));
  scene->inlines().attach(tiles.children[1], x3d_scene(glowing_box("0 0 1", "2 0 0")));
  CHECK(picture().pixels == root.pixels);  // the tiles are still hidden
  tiles.refined = true;
  const auto flat = x3d_scene(glowing_box("0 1 0", "-2 0 0") + glowing_box("0 0 1", "2 0 0"));
  const Image children = picture();
  CHECK(children.pixels == drawing.draw(collect(*flat, {}, meshes)).pixels);
  CHECK(pixel(children, 32, 32).r < 0.1f);
  CHECK(children.pixels != root.pixels);
}

}  // namespace gs::render::geo_lod_picture_test
