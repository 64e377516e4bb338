#include "app/session/documents/world_reader.h"
#include "tests/app/late_worlds.h"

#include <catch2/catch.hpp>

#include <chrono>
#include <memory>
#include <string>
#include <thread>

namespace gs::app::late_nodes_test {

using late_worlds::kHeader;
using late_worlds::Site;
using late_worlds::World;

TEST_CASE("delivers events of the rest while an Inline and an EXTERNPROTO never load (4.5.3, 4.9.1)") {
  Site site;
  site.put("world.wrl", kHeader +
                            "DEF T TimeSensor { loop TRUE cycleInterval 2 } DEF I PositionInterpolator { key [ 0 1 ] "
                            "keyValue [ 0 0 0, 8 0 0 ] } DEF M Transform { children Shape { geometry Box { } } } "
                            "ROUTE T.fraction_changed TO I.set_fraction ROUTE I.value_changed TO M.translation "
                            "Inline { url \"never.wrl\" } EXTERNPROTO E [ exposedField SFVec3f at ] \"lib.wrl\" "
                            "E { at 1 1 1 } ROUTE I.value_changed TO M.translation");
  site.never("never.wrl");
  site.never("lib.wrl");
  WorldReader reader("memory://a/world.wrl", site.options, {});
  std::shared_ptr<Document> document;
  while (!document || document->is_preview) {
    WorldReader::News news = reader.take();
    if (news.document) document = news.document;
    CHECK_FALSE(news.over);
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  REQUIRE(document->runtime);
  CHECK(document->list->items.size() == 1);
  const double start = document->runtime->execution().now();
  CHECK(document->runtime->step(start + 1));
  const vrml::SceneGraph& scene = *document->world.scene;
  CHECK(scene.get<vrml::SFVec3f>(scene.roots()[2], "translation").x > 0);
  const auto behind = document->runtime->next_time();
  CHECK(behind.has_value());
  reader.retire();
}

TEST_CASE("attaches Inlines to the running world as they load, including nested ones (4.5.3)") {
  Site site;
  site.put("world.wrl",
           kHeader + "Inline { url \"slow.wrl\" } Shape { geometry Box { } } Inline { url \"outer.wrl\" }");
  site.put("slow.wrl", kHeader + std::string(30, ' ') + "Shape { geometry Sphere { } }", 2000);
  site.put("outer.wrl", kHeader +
                            "DEF S TimeSensor { loop TRUE } Shape { geometry Cone { } appearance Appearance { texture "
                            "ImageTexture { url \"grey.pgm\" } } } Inline { url \"inner.wrl\" } Inline { url "
                            "\"never.wrl\" }");
  site.put("inner.wrl", kHeader + "Shape { geometry Cylinder { } } Inline { url \"slow.wrl\" }", 4000);
  site.put("grey.pgm", std::string("P5 1 1 255\n") + static_cast<char>(9));
  site.never("never.wrl");
  World world(site);
  const auto pictures = [&] {
    int count = 0;
    for (const render::DrawItem& item : world.list().items) count += item.texture.image ? 1 : 0;
    return count;
  };
  for (int i = 0; i < 200 && (world.items() < 5 || pictures() < 1); ++i) world.step_for(std::chrono::milliseconds(20));
  CHECK(world.items() == 5);  // box, cone, cylinder, and the sphere twice
  CHECK(pictures() == 1);
  CHECK(world.loading.state().waiting >= 1);
  const vrml::SceneGraph* outer = world.scene().inlines().of(world.root(2));
  REQUIRE(outer);
  CHECK(world.runtime->execution().scenes().has(outer));
  CHECK(world.runtime->next_time().has_value());  // its TimeSensor runs
}

TEST_CASE("withdraws a partly visible Inline until it is loaded completely") {
  Site site;
  site.put("world.wrl", kHeader + "Shape { geometry Box { } } Inline { url \"long.wrl\" }");
  std::string text = kHeader + "DEF First Shape { geometry Box { } }\n";
  for (int i = 0; i < 400; ++i) text += "Shape { geometry Sphere { } }\n";  // the first 4 KiB decide the type
  site.put("long.wrl", text, 16000);
  WorldLoading loading("memory://a/world.wrl", site.options);
  // Reads until a preview contains a part.
  while (loading.collect({0, 0, 10}).items.size() < 5) (void)loading.step(std::chrono::milliseconds(5));
  REQUIRE(loading.root_is_read());
  LoadedWorld opened = loading.take();
  render::MeshCache meshes;
  WorldRuntime runtime(opened, meshes);
  runtime.start(1000);
  const auto seen = runtime.look({0, 0, 10}, true);
  CHECK(seen->scene.list().items.size() == 1);
  CHECK(opened.scene->inlines().of(opened.scene->roots()[1]) == nullptr);
  while (!loading.done()) (void)loading.step(std::chrono::milliseconds(100));
  runtime.arrive(loading.take_updates());
  (void)runtime.show(*seen, {0, 0, 10});
  CHECK(seen->scene.list().items.size() == 402);
}

TEST_CASE("prefers set_url over an Inline of the file that is not loaded yet (6.25)") {
  Site site;
  site.put("world.wrl", kHeader + "Inline { url \"slow.wrl\" }");
  site.put("slow.wrl", kHeader + std::string(4000, ' ') + "Shape { geometry Cone { } } Shape { geometry Cone { } }",
           40);
  site.put("fast.wrl", kHeader + "Shape { geometry Box { } }");
  World world(site);
  CHECK(world.items() == 0);
  CHECK(world.runtime->send(world.scene(), world.root(0), "set_url",
                            vrml::FieldValue(vrml::MFString{vrml::SFString("fast.wrl")})));
  world.runtime->step(world.time += 1);
  world.load();
  CHECK(world.items() == 1);
}

TEST_CASE("gives instances the body of their EXTERNPROTO when it loads, and events from then on (4.9.1)") {
  Site site;
  site.put("world.wrl",
           kHeader +
               "EXTERNPROTO Ball [ exposedField SFVec3f at field MFString picture ] \"lib.wrl#Ball\" "
               "DEF A Ball { at 1 0 0 picture \"grey.pgm\" } DEF B Ball { } "
               "EXTERNPROTO None [ field MFNode children ] \"none.wrl\" None { children Shape { geometry Box { } } } ");
  site.put(
      "lib.wrl",
      kHeader +
          "PROTO Ball [ exposedField SFVec3f at 5 5 5 field MFString picture [ ] ] { Transform { translation IS at "
          "children Shape { geometry Sphere { } appearance Appearance { texture ImageTexture { url IS picture } "
          "} } } }",
      600);
  site.put("grey.pgm", std::string("P5 1 1 255\n") + static_cast<char>(9));
  World world(site);
  CHECK(world.items() == 0);
  const vrml::NodeId a = world.root(0), b = world.root(1);
  // The event is ignored until the PROTO is loaded.
  CHECK(world.runtime->send(world.scene(), a, "set_at", vrml::FieldValue(vrml::SFVec3f(9, 9, 9))));
  world.load();
  REQUIRE(world.items() == 3);  // two balls, and a Group instead of the missing PROTO
  const auto moved = [&](vrml::NodeId ball) {
    return world.scene().get<vrml::SFVec3f>(world.scene().resolve(ball), "translation");
  };
  CHECK(moved(a) == vrml::SFVec3f(1, 0, 0));
  CHECK(moved(b) == vrml::SFVec3f(5, 5, 5));
  CHECK(world.runtime->send(world.scene(), a, "set_at", vrml::FieldValue(vrml::SFVec3f(2, 0, 0))));
  CHECK(moved(a) == vrml::SFVec3f(2, 0, 0));
  int pictures = 0;
  for (const render::DrawItem& item : world.list().items) pictures += item.texture.image ? 1 : 0;
  CHECK(pictures == 1);
  CHECK(world.opened.diagnostics.warnings() == 1);
}

TEST_CASE("binds a Viewpoint of a late EXTERNPROTO body if none was bound (4.6.10)") {
  Site site;
  site.put("world.wrl", kHeader + "EXTERNPROTO View [ ] \"lib.wrl\" View { } NavigationInfo { } ");
  site.put("lib.wrl",
           kHeader + "PROTO View [ ] { Group { children [ Viewpoint { position 0 0 77 } NavigationInfo { } ] } }", 600);
  World world(site);
  CHECK(world.runtime->bound().viewpoint == nullptr);
  const vrml::Node* navigation = world.runtime->bound().navigation_info;
  CHECK(navigation);
  world.load();
  REQUIRE(world.runtime->bound().viewpoint);
  CHECK(world.list().viewpoints.size() == 1);
  CHECK(world.runtime->bound().navigation_info == navigation);
}

TEST_CASE("loads an Inline's own EXTERNPROTOs later") {
  Site site;
  site.put("world.wrl", kHeader + "Inline { url \"inner.wrl\" }");
  site.put("inner.wrl", kHeader + "Shape { geometry Box { } } EXTERNPROTO P [ ] \"lib.wrl\" P { } P { }");
  site.put("lib.wrl", kHeader + "PROTO P [ ] { Shape { geometry Cone { } } }" + std::string(200, ' '), 1000);
  World world(site);
  for (int i = 0; i < 100 && world.items() < 1; ++i) world.step_for(std::chrono::milliseconds(5));
  CHECK(world.items() == 1);
  world.load();
  CHECK(world.items() == 3);
}

TEST_CASE("loads the body of an EXTERNPROTO in a text that is read at run time (4.12.10, 4.9)") {
  Site site;
  site.put("world.wrl", kHeader + "Group { } PROTO Own [ ] { Shape { geometry Sphere { } } }");
  site.put("lib.wrl", kHeader + "PROTO P [ ] { Shape { geometry Cone { } } }");
  World world(site);
  world.load();
  const auto read = [&](const std::string& text) {
    Diagnostics diagnostics;
    const vrml::RunTimeNodes made = vrml::read_into(world.scene(), "script", text, diagnostics);
    CHECK(diagnostics.errors() == 0);
    world.runtime->execution().scenes().attach(world.scene());
    CHECK(world.runtime->send(world.scene(), world.root(0), "set_children", vrml::FieldValue(made.roots)));
    world.runtime->step(world.time += 1);
    return made.roots;
  };
  for (int round = 0; round < 5; ++round) {
    const std::size_t nodes = world.scene().nodes().count();
    read("EXTERNPROTO Q [ ] \"lib.wrl#P\" Q { } Q { } Shape { geometry Box { } }");
    CHECK(world.items() == 1);
    world.load();
    CHECK(world.items() == 3);
    // EXTERNPROTOs for a PROTO of the world's file, and for a missing file.
    read("EXTERNPROTO Own [ ] \"#Own\" Own { } EXTERNPROTO N [ ] \"none.wrl\" N { }");
    world.load();
    CHECK(world.items() == 1);
    (void)world.runtime->execution().lifetime().remove_unheld();
    CHECK(world.scene().texts().run_time_count() == 1);
    if (round > 1) CHECK(world.scene().nodes().count() == nodes);
  }
  // No node waits for the library any more.
  read("EXTERNPROTO Q [ ] \"lib.wrl#P\" Q { }");
  auto requests = world.runtime->take_url_requests();
  CHECK(requests.size() == 1);
  read("Shape { geometry Box { } }");
  (void)world.runtime->execution().lifetime().remove_unheld();
  world.loading.request(std::move(requests));
  world.load();
  CHECK(world.items() == 1);
}

TEST_CASE("shows the LOD level for the viewer's position as late levels load (6.26, 6.25)") {
  Site site;
  site.put("world.wrl", kHeader +
                            "LOD { range [ 20, 40 ] level [ Inline { url \"near.wrl\" } Inline { url \"middle.wrl\" } "
                            "Inline { url \"far.wrl\" } ] }");
  site.put("near.wrl", kHeader + std::string(40, ' ') + "Shape { geometry Box { } } Shape { geometry Box { } }", 1000);
  site.put("middle.wrl", kHeader + "Shape { geometry Cone { } }");
  site.put("far.wrl",
           kHeader + std::string(40, ' ') +
               "Shape { geometry Sphere { } } Shape { geometry Sphere { } } Shape { geometry Sphere { } }",
           2000);
  World world(site);
  const auto at = [&](double distance) { return world.list({0, 0, distance}).items.size(); };
  CHECK(at(10) == 0);  // nothing is loaded, and no other level replaces it
  world.load();
  CHECK(at(10) == 2);
  CHECK(at(30) == 1);
  CHECK(at(50) == 3);
  CHECK(at(10) == 2);
}

TEST_CASE("shows a QNV node's own vectors and fallback body in late parts") {
  Site site;
  site.put("world.wrl",
           kHeader +
               "Inline { url \"part.wrl\" } EXTERNPROTO Cloud [ field MFInt32 own ] \"lib.wrl\" Cloud { own "
               "[ 1 2 3 4 5 6 ] } Inline { url \"fallback.wrl\" }");
  site.put("part.wrl", kHeader + "Shape { geometry QNV { vectors [ 1 2 3 4 ] bboxSize 2 2 2 } }", 1000);
  site.put("lib.wrl",
           kHeader +
               "PROTO Cloud [ field MFInt32 own [ ] ] { Shape { geometry QNV { vectors IS own bboxSize 2 2 2 } } "
               "}",
           1000);
  site.put("fallback.wrl",
           kHeader +
               "PROTO QNV [ exposedField MFString url [ ] ] { Box { } } Shape { geometry QNV { url \"none.qnv\" } "
               "}",
           1000);
  World world(site);
  CHECK(world.items() == 0);
  CHECK(world.list().splats.empty());
  world.load();
  const auto& splats = world.list().splats;
  REQUIRE(splats.size() == 2);
  CHECK(splats[0].geometry->size() == 2);
  CHECK(splats[1].geometry->size() == 3);
  CHECK(world.items() == 1);
}

}  // namespace gs::app::late_nodes_test
