#include "tests/vrml/events/trace.h"
#include "vrml/scene/coordinates/geo_tiles.h"

#include <glm/gtc/matrix_transform.hpp>

#include <memory>
#include <string>

// Tests of GeoLOD (X3D 25.3.4). The test takes the part of the loader.
namespace gs::vrml::traces {
namespace {

const std::string kTerrain =
    "DEF L GeoLOD { geoSystem \"GC\" center 0 0 0 range 10 rootUrl \"root.x3dv\" child1Url \"a.x3dv\" child2Url "
    "[ \"\" ] child3Url \"c.x3dv\" }";

struct Terrain : X3DWorld {
  explicit Terrain(const std::string& text = kTerrain) : X3DWorld(text) {}

  void look_from(double distance) {
    execution().viewer().set(glm::translate(glm::dmat4(1), glm::dvec3(0, 0, distance)));
  }
  [[nodiscard]] const GeoTiles& tiles() { return *scene().inlines().tiles_of(node("L")); }
  /// Gives a tile its content, as a loader does.
  void load(NodeId tile) {
    auto content = std::make_shared<SceneGraph>("tile.x3dv");
    Diagnostics diagnostics;
    (void)parse("#X3D V3.3 utf8\nPROFILE Full\nShape { geometry Box { } }", *content, diagnostics);
    execution().loads().note(scene().node(tile), UrlLoad::loaded);
    scene().inlines().attach(tile, std::move(content));
    execution().scenes().attach(scene());
  }
  void fail(NodeId tile) { execution().loads().note(scene().node(tile), UrlLoad::failed); }
  [[nodiscard]] bool loads(NodeId tile) { return may_load(scene().node(tile)); }
  /// Returns the first URLs of the changed nodes with url fields since the last call.
  std::string requested() {
    std::string urls;
    for (const NodeChange& change : execution().changes().take())
      if (change.scene->node(change.node).type->url_content == UrlContent::scene)
        urls += change.scene->get<MFString>(change.node, "url")[0].str() + ' ';
    return urls;
  }
};

}  // namespace

TEST_CASE("shows the root of a GeoLOD until its children are loaded, and again out of range (X3D 25.3.4)") {
  Terrain world;
  world.look_from(20);
  world.start();
  CHECK(world.take_at(1).empty());
  CHECK(world.requested() == "root.x3dv ");
  CHECK(world.tiles().children.empty());
  world.look_from(5);
  CHECK(world.take_at(2).empty());
  CHECK(world.requested() == "a.x3dv c.x3dv ");
  REQUIRE(world.tiles().children.size() == 2);
  CHECK(world.tiles().shown() == &world.tiles().root);
  const NodeId first = world.tiles().children[0], second = world.tiles().children[1];
  world.load(first);
  CHECK(world.take_at(3).empty());
  world.load(second);
  const Lines refined = world.take_at(4);
  REQUIRE(refined.size() == 2);
  CHECK(refined[0].find("4 L.children") == 0);
  CHECK(refined[1] == "4 L.level_changed 1");
  CHECK(world.tiles().shown() == &world.tiles().children);
  CHECK(world.take_at(5).empty());
  world.look_from(10);
  const Lines left = world.take_at(6);
  CHECK(left.back() == "6 L.level_changed 0");
  CHECK(world.tiles().shown() == &world.tiles().root);
  CHECK_FALSE(world.loads(first));
  CHECK_FALSE(world.loads(second));
}

TEST_CASE("loads the children of a GeoLOD again when the viewer comes back") {
  Terrain world;
  world.look_from(5);
  world.start();
  world.step(1);
  const NodeId first = world.tiles().children[0], second = world.tiles().children[1];
  world.load(first);
  world.fail(second);
  CHECK(world.take_at(2, "level") == Lines{"2 L.level_changed 1"});  // one of the tiles is enough
  world.look_from(50);
  CHECK(world.take_at(3, "level") == Lines{"3 L.level_changed 0"});
  world.execution().lifetime().remove_content(world.scene(), first);
  world.step(4);
  CHECK(world.execution().viewer().idle().count() == 1);
  (void)world.requested();
  world.look_from(5);
  CHECK(world.take_at(5, "level").empty());
  CHECK(world.requested() == "a.x3dv c.x3dv ");
  CHECK(world.tiles().children[0] == first);
  world.load(first);
  CHECK(world.take_at(6, "level").empty());
  world.load(second);
  CHECK(world.take_at(7, "level") == Lines{"7 L.level_changed 1"});
}

TEST_CASE("keeps the root of a GeoLOD if no child can be loaded, or there are no children") {
  Terrain world;
  world.look_from(5);
  world.start();
  world.step(1);
  for (const NodeId tile : world.tiles().children) world.fail(tile);
  CHECK(world.take_at(2).empty());
  Terrain leaf(
      "DEF L GeoLOD { geoSystem \"GC\" range 10 rootNode [ DEF S Shape { geometry Box { } } ] child1Url \"\" }");
  leaf.look_from(5);
  leaf.start();
  CHECK(leaf.take_at(1).empty());
  CHECK_FALSE(leaf.scene().inlines().tiles_of(leaf.node("L")));
}

TEST_CASE("sends the rootNode of a GeoLOD as its children out of range") {
  Terrain world(
      "DEF L GeoLOD { geoSystem \"GC\" range 10 rootNode [ DEF S Shape { geometry Box { } } ] child2Url \"b.x3dv\" }");
  world.look_from(5);
  world.start();
  world.step(1);
  world.load(world.tiles().children[0]);
  CHECK(world.take_at(2, "level") == Lines{"2 L.level_changed 1"});
  CHECK(world.tiles().root.empty());
  world.look_from(11);
  CHECK(world.take_at(3) == Lines{"3 L.children [ S ]", "3 L.level_changed 0"});
}

TEST_CASE("measures the range of a GeoLOD from geospatial coordinates, at the nearest instance") {
  Terrain world(
      "DEF L GeoLOD { center 48 11 500 range 100 child1Url \"a.x3dv\" geoOrigin DEF O GeoOrigin { geoCoords 48 11 500 "
      "} } "
      "Transform { translation 1000 0 0 children USE L }");
  world.look_from(500);
  world.start();
  world.step(1);
  CHECK_FALSE(world.scene().inlines().tiles_of(world.node("L")));
  world.execution().viewer().set(glm::translate(glm::dmat4(1), glm::dvec3(1000, 0, 99)));
  world.step(2);
  REQUIRE(world.scene().inlines().tiles_of(world.node("L")));
  CHECK(world.tiles().children.size() == 1);
}

TEST_CASE("frees the tiles of a GeoLOD that was made at run time, with the GeoLOD") {
  Terrain world("DEF G Group { }");
  world.look_from(5);
  world.start();
  Diagnostics diagnostics;
  const std::size_t before = world.scene().nodes().count();
  const RunTimeNodes made = read_into(
      world.scene(), "made", "GeoLOD { geoSystem \"GC\" rootUrl \"r\" child1Url \"c\" }", diagnostics, &world.scene());
  REQUIRE(made.roots.size() == 1);
  world.execution().scenes().attach(world.scene());
  world.send("G.addChildren", made.roots);
  world.step(1);
  const GeoTiles tiles = *world.scene().inlines().tiles_of(made.roots[0]);
  REQUIRE(tiles.children.size() == 1);
  CHECK(world.execution().lifetime().remove_unheld() == 0);
  CHECK(world.scene().contains(tiles.children[0]));
  world.send("G.removeChildren", made.roots);
  CHECK(world.execution().lifetime().remove_unheld() == 3);
  CHECK_FALSE(world.scene().contains(tiles.children[0]));
  CHECK_FALSE(world.scene().contains(tiles.root[0]));
  CHECK_FALSE(world.scene().inlines().tiles_of(made.roots[0]));
  CHECK(world.scene().nodes().count() <= before + 3);
}

}  // namespace gs::vrml::traces
