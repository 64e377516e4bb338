#include "app/session/session.h"

#include "app/simulation/simulation.h"
#include "tests/app/geometry_shapes.h"
#include "tests/app/one_world.h"
#include "tests/app/scratch_folder.h"
#include "tests/net/memory_network.h"

#include <catch2/catch.hpp>

#include <glm/geometric.hpp>

#include <chrono>
#include <cmath>
#include <thread>

namespace gs::app::session_test {

using namespace sessions;

TEST_CASE("moves with a held key by the time of the steps, equally each time") {
  const auto walk = [] {
    OneWorld world("NavigationInfo { type \"FLY\" speed 2 } Viewpoint { position 0 0 10 } Shape { geometry Box { } }");
    CHECK(world.place() == glm::vec3(0, 0, 10));
    CHECK_FALSE(world.frame.moving);
    world.frame = world.session.step(kStart, input_of({key(Kind::key_down, 'W')}));
    CHECK(world.frame.moving);
    for (int i = 1; i <= 60; ++i) world.frame = world.session.step(kStart + i / 60.0, input_of({}));
    const float gone = 10 - world.place().z;
    CHECK(gone > 1);
    CHECK(gone < 2.2f);  // a second at 2 m/s, with a soft start
    world.frame = world.session.step(kStart + 1, input_of({key(Kind::key_up, 'W')}));
    for (int i = 1; i <= 120; ++i) world.frame = world.session.step(kStart + 1 + i / 60.0, input_of({}));
    CHECK_FALSE(world.frame.moving);
    return world.place();
  };
  const glm::vec3 once = walk();
  CHECK(walk() == once);
}

TEST_CASE("sends the pointer to the world only outside panels") {
  OneWorld world("Viewpoint { } Group { children [ Shape { geometry Box { } } TouchSensor { } ] }");
  world.watch();
  (void)world.session.step(kStart + 0.1, input_of({pointer(Kind::pointer, 100, 50)}, true));
  CHECK(world.number_of_events("isOver") == 0);
  (void)world.session.step(kStart + 0.2, input_of({pointer(Kind::pointer, 100, 50)}));
  CHECK(world.number_of_events("isOver") == 1);
  (void)world.session.step(kStart + 0.3, input_of({pointer(Kind::button_down, 100, 50)}));
  CHECK(world.number_of_events("isActive") == 1);
  CHECK(world.session.panes().at(0).input.holding() == false);  // the sensor has grabbed it
  (void)world.session.step(kStart + 0.4, input_of({pointer(Kind::button_up, 100, 50)}));
  CHECK(world.number_of_events("touchTime") == 1);
  (void)world.session.step(kStart + 0.5, input_of({pointer(Kind::pointer, 100, 50)}, true));
  CHECK(world.number_of_events("isOver") == 2);  // isOver FALSE
}

TEST_CASE("EXAMINE turns about the point under the pointer at the start of the drag (6.29)") {
  const auto dragged = [](const glm::vec2& from) {
    OneWorld world(
        "NavigationInfo { type \"EXAMINE\" } Viewpoint { } Transform { translation 2 0 0 children Shape { geometry Box "
        "{ size 1 "
        "1 1 } } } Transform { translation -30 0 0 children Shape { geometry Box { size 1 1 1 } } }");
    (void)world.session.step(kStart + 0.1, input_of({pointer(Kind::button_down, from.x, from.y)}));
    const glm::dvec3 center = world.session.view()->navigation.center;
    (void)world.session.step(kStart + 0.2, input_of({pointer(Kind::pointer, from.x + 30, from.y + 5)}));
    const Navigation& after = world.session.view()->navigation;
    CHECK(glm::distance(after.pose.position, center) ==
          Approx(glm::distance(glm::dvec3(0, 0, 10), center)).epsilon(1e-4));
    return center;
  };
  // At a distance of 10 units, 50 pixels are 10 tan(pi / 8) units. The front of the box is half a unit nearer.
  const glm::dvec3 on_box = dragged({100 + 2.0f / 9.5f * 50 / std::tan(0.392699f), 50});
  CHECK(glm::distance(on_box, glm::dvec3(2, 0, 0.5)) < 0.02);
  CHECK(dragged({100, 20}).x < -5);  // a press on the sky turns about the centre of the world
}

TEST_CASE("uses a reader that has started before the session, unless the options differ") {
  for (const bool same : {true, false}) {
    const auto network = std::make_shared<net::MemoryNetwork>();
    net::MemoryResource world;
    world.bytes = test::bytes_of("#VRML V2.0 utf8\nShape { geometry Box { } }\n");
    network->put("memory://a/box.wrl", world);
    LoadOptions load;
    load.memory = net::MakeMemoryTransport{network};
    load.timeout_seconds = 60;
    SessionOptions options;
    options.files = {"memory://a/box.wrl"};
    options.early = read_early(options.files.front(), load, [] {});
    REQUIRE(options.early);
    if (!same) load.limits.memory /= 2;
    Session session(options, load, [] {});
    Frame frame;
    for (int i = 0; i < 2000 && !session.view(); ++i) {
      frame = session.step(kStart + i * 0.01, input_of({}));
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    REQUIRE(session.view());
    CHECK(session.view()->document->world.scene->roots().size() == 1);
    CHECK_FALSE(options.early->reader);
    if (same) CHECK(network->transfers().size() == 1);
  }
  LoadOptions load;
  CHECK_FALSE(read_early("box.wrl", load, [] {}));
  CHECK_FALSE(read_early("memory://a/box.wrl#Top", load, [] {}));
  load.follow = true;
  CHECK_FALSE(read_early("memory://a/box.wrl", load, [] {}));
}

TEST_CASE("advances time without a viewer") {
  OneWorld world("DEF T TimeSensor { loop TRUE }");
  world.watch();
  SessionInput hidden;
  hidden.look = false;
  for (int i = 1; i <= 5; ++i) (void)world.session.step(kStart + i * 0.1, hidden);
  CHECK(world.number_of_events("time") == 5);
}

TEST_CASE("jumps to a chosen Viewpoint in simulated time, and moves there in a window") {
  const std::string body = "DEF A Viewpoint { position 0 0 10 } DEF B Viewpoint { position 50 0 0 }";
  OneWorld simulated(body), window(body, false);
  for (OneWorld* world : {&simulated, &window}) {
    world->session.camera().bind_viewpoint(1);
    world->frame = world->session.step(kStart + 0.1, input_of({}));
  }
  CHECK(simulated.place() == glm::vec3(50, 0, 0));
  CHECK(window.place() != glm::vec3(50, 0, 0));
  CHECK(window.frame.moving);
  for (int i = 1; i <= 60; ++i) window.frame = window.session.step(kStart + 0.1 + i / 60.0, input_of({}));
  CHECK(glm::distance(window.place(), glm::vec3(50, 0, 0)) < 1e-4f);
  CHECK_FALSE(window.frame.moving);
}

TEST_CASE("follows an Anchor to a Viewpoint of its world, and reports a page to the caller (VRML97 6.2)") {
  const std::string click_here =
      "children Shape { geometry Box { size 20 20 1 } } } DEF V Viewpoint { position 0 0 77 }";
  const auto click = [](OneWorld& world) {
    (void)world.session.step(kStart + 0.1, input_of({pointer(Kind::pointer, 100, 50)}));
    Frame down = world.session.step(kStart + 0.2, input_of({pointer(Kind::button_down, 100, 50)}));
    Frame up = world.session.step(kStart + 0.3, input_of({pointer(Kind::button_up, 100, 50)}));
    down.web_pages.insert(down.web_pages.end(), up.web_pages.begin(), up.web_pages.end());
    world.frame = world.session.step(kStart + 0.4, input_of({}));
    return down.web_pages;
  };
  OneWorld inside("Viewpoint { } Anchor { url \"#V\" " + click_here);
  CHECK(click(inside).empty());
  CHECK(inside.place() == glm::vec3(0, 0, 77));
  OneWorld page("Viewpoint { } Anchor { url \"https://example.org/a.html\" " + click_here, false);
  CHECK(click(page) == std::vector<std::string>{"https://example.org/a.html"});
  // In simulated time no link leaves the world.
  OneWorld shut("Viewpoint { } Anchor { url [ \"https://example.org/a.html\" \"other.wrl\" ] " + click_here);
  CHECK(click(shut).empty());
  CHECK(shut.session.panes().documents().entries().size() == 1);
}

TEST_CASE("updates sensors at the viewer's position, first at the Viewpoint") {
  OneWorld world(
      "NavigationInfo { type \"FLY\" speed 4 } DEF T Transform { children Viewpoint { position 0 0 10 } } "
      "ProximitySensor { center 0 0 6 size 2 2 2 } Shape { geometry Box { } }");
  world.watch();
  auto& execution = world.document->runtime->execution();
  (void)world.session.step(kStart + 0.1, input_of({}));
  CHECK_FALSE(execution.viewer().is_set());
  (void)world.session.step(kStart + 0.2, input_of({key(Kind::key_down, 'W')}));
  for (int i = 1; i <= 120; ++i) (void)world.session.step(kStart + 0.2 + i / 60.0, input_of({}));
  CHECK(execution.viewer().is_set());
  CHECK(world.number_of_events("enterTime") == 1);
  CHECK(world.number_of_events("exitTime") == 1);
}

TEST_CASE("triggers no sensors along a jump, but those at its end (VRML97 6.53)") {
  OneWorld world(
      "DEF A Viewpoint { position 0 0 10 } DEF B Viewpoint { position 50 0 10 } "
      "ProximitySensor { center 25 0 10 size 20 2 2 } ProximitySensor { center 50 0 10 size 2 2 2 }",
      false);
  std::vector<double> entered;
  world.document->runtime->execution().cascade().observe([&](const vrml::SentEvent& event) {
    if (event.event->name == "enterTime") entered.push_back(event.time);
  });
  // Walking sends enterTime. Then the viewer jumps.
  (void)world.session.step(kStart + 0.1, input_of({key(Kind::key_down, 'W')}));
  (void)world.session.step(kStart + 0.2, input_of({key(Kind::key_up, 'W')}));
  for (int i = 1; i <= 60; ++i) (void)world.session.step(kStart + 0.2 + i / 60.0, input_of({}));
  CHECK(entered.empty());
  world.session.camera().bind_viewpoint(1);
  for (int i = 1; i <= 60; ++i) world.frame = world.session.step(kStart + 1.2 + i / 60.0, input_of({}));
  CHECK(world.place() == glm::vec3(50, 0, 10));
  REQUIRE(entered.size() == 1);
  CHECK(entered[0] < kStart + 1.2 + 2.5 / 60);
}

TEST_CASE("follows an Anchor to the first file that can be read (VRML97 6.2)") {
  const ScratchFolder folder;
  folder.write("there.wrl", "#VRML V2.0 utf8\nDEF V Viewpoint { position 0 0 33 } Shape { geometry Cone { } }\n");
  SessionOptions options;
  options.files = {folder.write("world.wrl",
                                "#VRML V2.0 utf8\nViewpoint { } Anchor { url [ \"missing.wrl#V\" \"none.wrl\" "
                                "\"there.wrl#V\" ] children Shape { geometry Box { size 20 20 1 } } }\n")};
  Session session(options, {}, [] {});
  Frame frame;
  std::size_t failures = 0;
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  const auto step = [&](std::vector<WindowEvent> events) {
    frame = session.step(world_time(), input_of(std::move(events)));
    failures += frame.notices.size();
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  };
  while ((!session.view() || !session.view()->document->runtime) && std::chrono::steady_clock::now() < deadline)
    step({});
  REQUIRE(session.view());
  for (const Kind kind : {Kind::pointer, Kind::button_down, Kind::button_up}) step({pointer(kind, 100, 50)});
  const auto there = [&] {
    return session.view() && session.view()->document->world.path == folder.path("there.wrl") &&
           session.view()->navigation.pose.position == glm::dvec3(0, 0, 33);
  };
  while (!there() && std::chrono::steady_clock::now() < deadline) step({});
  CHECK(there());
  CHECK(failures == 2);
}

TEST_CASE("reads files beside the steps, each in its viewport, and reports failures") {
  const ScratchFolder folder;
  const std::string box = folder.write("box.wrl", "#VRML V2.0 utf8\nShape { geometry Box { } }\n");
  const std::string cone = folder.write("cone.wrl", "#VRML V2.0 utf8\nShape { geometry Cone { } }\n");
  SessionOptions options;
  options.files = {box, folder.path("missing.wrl"), cone};
  Session session(options, {}, [] {});
  Frame frame;
  const auto& failure = session.panes().at(1).failure;
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  do {
    frame = session.step(world_time(), input_of({}));
    CHECK(frame.notices.empty());  // only the viewport shows the failure
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  } while ((frame.loading || !failure) && std::chrono::steady_clock::now() < deadline);
  CHECK(layout_of(session.panes().split()) == ViewportLayout::four);
  std::size_t shown = 0;
  for (const Frame::Picture& picture : frame.pictures) {
    CHECK(picture.place.pixels() == 100 * 50);
    if (picture.view) ++shown;
  }
  CHECK(shown == 2);
  REQUIRE(failure);
  CHECK(failure->path == folder.path("missing.wrl"));
  CHECK_FALSE(failure->error.empty());
}

TEST_CASE("reports no more news when all of a file is loaded, so that a window rests") {
  const ScratchFolder folder;
  SessionOptions options;
  options.files = {folder.write("box.wrl", "#VRML V2.0 utf8\nShape { geometry Box { } }\n")};
  Session session(options, {}, [] {});
  Frame frame = session.step(world_time(), input_of({}));
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  const auto rests = [&] { return frame.pictures.at(0).view && !frame.loading && !frame.news && !frame.changed; };
  while (!rests() && std::chrono::steady_clock::now() < deadline) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    frame = session.step(world_time(), input_of({}));
  }
  REQUIRE(rests());
  for (int i = 0; i < 20; ++i) {
    frame = session.step(world_time(), input_of({}));
    CHECK_FALSE(frame.news);
    CHECK_FALSE(frame.changed);
    CHECK_FALSE(frame.moving);
  }
}

TEST_CASE("moves the viewer by keys of --input in simulated time, bit for bit") {
  const auto walk = [] {
    Simulation simulation(world_of("NavigationInfo { type \"FLY\" } Viewpoint { } Shape { geometry Box { } }"),
                          {64, 64});
    Diagnostics diagnostics;
    const auto rows = read_input_rows(
        "{\"t\":0.1,\"key\":\"w\",\"down\":true}\n{\"t\":0.6,\"key\":\"w\",\"down\":false}\n"
        "{\"t\":0.7,\"key\":\"Left\",\"down\":true}\n{\"t\":0.9,\"key\":\"Left\",\"down\":false}\n",
        "in.jsonl", diagnostics);
    REQUIRE(rows.size() == 4);
    CHECK(simulation.plan(rows, "in.jsonl", diagnostics));
    simulation.run(2);
    return simulation.camera().world_from_camera;
  };
  const glm::dmat4 camera = walk();
  CHECK(camera[3].z < 9.9f);
  CHECK(camera[2].z < 0.999f);  // turned
  CHECK(walk() == camera);
}

}  // namespace gs::app::session_test
