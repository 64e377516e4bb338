#include "tests/app/late_worlds.h"

#include <string>

namespace gs::app::x3d_inlines_test {
namespace {

using late_worlds::Site;
using late_worlds::World;

const std::string kX3d = "#X3D V3.3 utf8\nPROFILE Immersive\n";

void set(World& world, std::size_t root, const char* field, vrml::FieldValue value) {
  CHECK(world.runtime->send(world.scene(), world.root(root), field, value));
  world.runtime->step(world.time += 1);
}

std::string said(const World& world) {
  std::string text;
  for (const Diagnostic& diagnostic : world.opened.diagnostics.entries()) text += diagnostic.text() + "\n";
  return text;
}

}  // namespace

TEST_CASE("loads and removes the content of an X3D Inline by its field load") {
  Site files;
  files.put("world.wrl", kX3d + "Inline { load FALSE url \"box.x3dv\" }");
  files.put("box.x3dv", kX3d + "Shape { geometry Box { } }");
  World world(files, World::Begins::with_all_that_it_names);
  CHECK(said(world).empty());
  CHECK(world.items() == 0);
  set(world, 0, "load", vrml::SFBool{true});
  world.load();
  CHECK(world.items() == 1);
  set(world, 0, "load", vrml::SFBool{false});
  world.load();
  CHECK(world.items() == 0);
  CHECK(said(world).empty());
}

TEST_CASE("scales an Inline if its text has another unit of length") {
  Site files;
  files.put("world.wrl", kX3d + "UNIT length centimetre 0.01\nInline { url \"box.x3dv\" }");
  files.put("box.x3dv", kX3d + "UNIT length millimetre 0.001\nShape { geometry Box { size 20 20 20 } }\n"
                               "Inline { url \"metre.wrl\" }");
  files.put("metre.wrl", late_worlds::kHeader + "Shape { geometry Box { } }");
  for (const World::Begins begins : {World::Begins::with_all_that_it_names, World::Begins::with_its_own_file}) {
    World world(files, begins);
    if (begins == World::Begins::with_its_own_file) world.load();
    CHECK(said(world).empty());
    const render::RenderList& list = world.list();
    REQUIRE(list.items.size() == 2);
    // The boxes have edges of 2 cm and 2 m.
    CHECK(list.bounds.upper.x == Approx(100));
    CHECK(world.scene().roots().size() == 1);
  }
}

TEST_CASE("connects nodes that X3D files import, when their Inline is loaded and after its url was set") {
  Site files;
  files.put("world.wrl", kX3d +
                             "DEF I Inline { url \"one.x3dv\" } DEF From Transform { } DEF To Transform { }\n"
                             "IMPORT I.Moved AS M\n"
                             "ROUTE From.translation TO M.translation ROUTE M.translation TO To.translation");
  files.put("one.x3dv", kX3d + "DEF T Transform { } EXPORT T AS Moved");
  files.put("two.x3dv", kX3d + "Group { } DEF U Transform { } EXPORT U AS Moved");
  for (const World::Begins begins : {World::Begins::with_all_that_it_names, World::Begins::with_its_own_file}) {
    World world(files, begins);
    if (begins == World::Begins::with_its_own_file) world.load();
    const auto received = [&] { return world.scene().get<vrml::SFVec3f>(world.root(2), "translation"); };
    set(world, 1, "translation", vrml::SFVec3f(1, 2, 3));
    CHECK(received() == vrml::SFVec3f(1, 2, 3));
    world.set_url(world.root(0), "two.x3dv");
    world.load();
    set(world, 1, "translation", vrml::SFVec3f(4, 5, 6));
    CHECK(received() == vrml::SFVec3f(4, 5, 6));
    world.set_url(world.root(0), "");
    world.load();
    set(world, 1, "translation", vrml::SFVec3f(7, 8, 9));
    CHECK(received() == vrml::SFVec3f(4, 5, 6));
    CHECK(said(world).empty());
  }
}

TEST_CASE("reports the files of an X3D world to a LoadSensor") {
  Site files;
  files.put("world.wrl", kX3d +
                             "DEF I Inline { url \"one.x3dv\" } DEF J Inline { url \"none.x3dv\" }\n"
                             "DEF L LoadSensor { watchList USE I } DEF M LoadSensor { watchList [ USE I USE J ] }\n"
                             "DEF K Inline { load FALSE url \"one.x3dv\" } DEF N LoadSensor { watchList USE K }");
  files.put("one.x3dv", kX3d + "Group { }");
  World world(files);
  const auto value = [&](std::size_t root, const char* event) {
    const vrml::NodeId sensor = world.root(root);
    const auto* last = world.runtime->execution().cascade().last_value(
        world.scene(), sensor, *world.scene().node(sensor).type->find(event));
    return std::get<vrml::SFBool>(*last);
  };
  world.runtime->step(world.time += 1);
  CHECK(value(2, "isActive"));
  CHECK(value(3, "isActive"));
  CHECK_FALSE(value(5, "isActive"));
  world.load();
  world.runtime->execution().loads().end();
  world.runtime->step(world.time += 1);
  CHECK_FALSE(value(2, "isActive"));
  CHECK(value(2, "isLoaded"));
  CHECK_FALSE(value(3, "isActive"));
  CHECK_FALSE(value(3, "isLoaded"));
  CHECK_FALSE(value(5, "isLoaded"));
  set(world, 4, "load", vrml::SFBool{true});
  world.load();
  world.runtime->step(world.time += 1);
  CHECK(value(5, "isLoaded"));
}

}  // namespace gs::app::x3d_inlines_test
