#include "tests/app/late_worlds.h"

#include <glm/gtc/matrix_transform.hpp>

#include <string>

// Tests of the loading of GeoLODs (X3D 25.3.4).
namespace gs::app::geo_lod_test {
namespace {

using late_worlds::Site;
using late_worlds::World;

const std::string kX3d = "#X3D V3.3 utf8\nPROFILE Full\n";

std::string box(int size) {
  const std::string edge = std::to_string(size);
  return "Shape { geometry Box { size " + edge + ' ' + edge + ' ' + edge + " } } ";
}

void look_from(World& world, double distance) {
  world.runtime->execution().viewer().set(glm::translate(glm::dmat4(1), glm::dvec3(0, 0, distance)));
  world.runtime->step(world.time += 1);
}

Site terrain() {
  Site files;
  files.put("world.wrl",
            kX3d +
                "GeoLOD { geoSystem \"GC\" range 10 rootUrl \"tiles/root.x3dv\" child1Url \"tiles/a.x3dv\" "
                "child4Url \"tiles/b.x3dv\" }");
  files.put("tiles/root.x3dv", kX3d + box(1));
  files.put("tiles/a.x3dv", kX3d + box(2) + box(3));
  files.put("tiles/b.x3dv", kX3d + "GeoLOD { geoSystem \"GC\" range 5 rootNode " + box(4) + " child1Url \"c.x3dv\" }");
  files.put("tiles/c.x3dv", kX3d + box(5));
  return files;
}

}  // namespace

TEST_CASE("loads the tiles of nested GeoLODs near the viewer, and removes them far from it") {
  const Site files = terrain();
  for (const World::Begins begins : {World::Begins::with_all_that_it_names, World::Begins::with_its_own_file}) {
    World world(files, begins);
    look_from(world, 100);
    world.load();
    CHECK(world.items() == 1);
    const std::size_t scenes = world.runtime->execution().scenes().states().size();
    look_from(world, 8);
    CHECK(world.items() == 1);  // the root remains until the children are loaded
    world.load();
    world.runtime->step(world.time += 1);
    CHECK(world.items() == 3);
    CHECK(world.list().bounds.upper.x == Approx(2));
    look_from(world, 4);
    world.load();
    world.runtime->step(world.time += 1);
    CHECK(world.items() == 3);
    CHECK(world.list().bounds.upper.x == Approx(2.5));
    look_from(world, 100);
    CHECK(world.items() == 1);
    world.load();
    std::size_t live = 0;
    for (const vrml::SceneState& state : world.runtime->execution().scenes().states()) live += state.scene ? 1 : 0;
    CHECK(live == scenes);
    look_from(world, 4);
    world.load();
    for (int i = 0; i < 3; ++i) {
      world.runtime->step(world.time += 1);
      world.load();
    }
    CHECK(world.list().bounds.upper.x == Approx(2.5));
    CHECK(world.opened.diagnostics.errors() == 0);
  }
}

TEST_CASE("shows the root of a GeoLOD in a world without events") {
  const Site files = terrain();
  WorldLoading loading("memory://a/world.wrl", files.options);
  const LoadedWorld world = load_world(loading, "memory://a/world.wrl");
  render::MeshCache meshes;
  CHECK(render::collect(*world.scene, {}, meshes).items.size() == 1);
}

TEST_CASE("returns the memory of the tiles of a GeoLOD to the budget") {
  World world(terrain(), World::Begins::with_all_that_it_names);
  look_from(world, 100);
  std::uint64_t first = 0;
  for (int round = 0; round < 4; ++round) {
    look_from(world, 4);
    for (int i = 0; i < 3; ++i) {
      world.load();
      world.runtime->step(world.time += 1);
    }
    look_from(world, 100);
    world.load();
    (void)world.items();
    const std::uint64_t used = world.scene().budget()->used(Resource::nodes);
    if (round == 1) first = used;
    if (round > 1) CHECK(used == first);
  }
}

TEST_CASE("reports a missing tile of a GeoLOD, and shows the others") {
  Site files = terrain();
  files.put("world.wrl", kX3d + "GeoLOD { geoSystem \"GC\" range 10 rootNode " + box(1) +
                             " child1Url \"tiles/a.x3dv\" child2Url \"tiles/none.x3dv\" }");
  World world(files);
  look_from(world, 1);
  world.load();
  world.runtime->step(world.time += 1);
  CHECK(world.items() == 2);
}

TEST_CASE("ends the recursion of a GeoLOD with its own file as a child") {
  Site files;
  files.put("world.wrl", kX3d + "GeoLOD { geoSystem \"GC\" range 10 rootNode " + box(1) + " child1Url \"world.wrl\" }");
  World world(files);
  for (int i = 0; i < 100; ++i) {
    look_from(world, 1);
    world.load();
  }
  CHECK(world.runtime->execution().scenes().states().size() < 70);
  CHECK(world.items() == 1);
}

}  // namespace gs::app::geo_lod_test
