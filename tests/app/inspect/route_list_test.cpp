#include "app/inspect/route_list.h"

#include "tests/app/worlds.h"

#include <catch2/catch.hpp>

#include <string>
#include <vector>

namespace gs::app::route_list_test {

using Lines = std::vector<std::string>;

struct Routed {
  explicit Routed(const std::string& body) : world(world_of(body)), execution(*world.scene) {
    execution.scenes().attach();
    execution.start(1000);
  }
  [[nodiscard]] NodeAt node(std::string_view name) const {
    for (std::uint32_t i = 1; i <= world.scene->nodes().count(); ++i)
      if (world.scene->nodes().at(i).name == name) return {world.scene.get(), world.scene->nodes().id_at(i)};
    return {};
  }
  Lines lines(const NodeAt& only = {}) {
    routes.set_only_selected(true);
    routes.refresh(&execution, only);
    Lines all;
    for (const RouteList::Row& row : routes.rows())
      all.push_back(label_of(row.from) + "." + row.event_out->name + " -> " + label_of(row.to) + "." +
                    row.event_in->name);
    return all;
  }
  void set(const char* name, const char* event, float value) {
    const NodeAt at = node(name);
    execution.cascade().begin_update();
    CHECK(execution.cascade().post(*at.scene, at.id, *at.scene->node(at.id).type->find_event_in(event), value));
    execution.cascade().drain();
  }

  LoadedWorld world;
  vrml::Execution execution;
  RouteList routes;
  EventWatch watch;
};

constexpr const char* kTwo =
    "DEF I ScalarInterpolator { key [ 0 1 ] keyValue [ 0 1 ] } DEF M Material {} DEF L PointLight {} "
    "ROUTE I.value_changed TO M.transparency ROUTE M.transparency TO L.intensity";

TEST_CASE("lists ROUTEs by name, in the order of creation, and filters them by node") {
  Routed world(kTwo);
  CHECK(world.lines() == Lines{"I.value_changed -> M.transparency", "M.transparency -> L.intensity"});
  CHECK(world.lines(world.node("L")) == Lines{"M.transparency -> L.intensity"});
  CHECK(world.routes.all() == 2);
  CHECK(world.lines(world.node("M")).size() == 2);
}

TEST_CASE("rebuilds the list only if ROUTEs changed") {
  Routed world(kTwo);
  (void)world.lines();
  const std::uint64_t made = world.routes.made();
  world.set("I", "set_fraction", 0.5f);
  (void)world.lines();
  CHECK(world.routes.made() == made);
  const NodeAt from = world.node("I"), to = world.node("L");
  const vrml::Route route{from.id, to.id, from.scene->node(from.id).type->find_event_out("value_changed"),
                          to.scene->node(to.id).type->find_event_in("radius")};
  CHECK(world.execution.routes().add(*world.world.scene, route));
  CHECK(world.lines().back() == "I.value_changed -> L.radius");
  CHECK(world.execution.routes().remove(*world.world.scene, route));
  CHECK(world.lines().size() == 2);
}

TEST_CASE("lists ROUTEs inside bodies of PROTO instances") {
  Routed world(
      "PROTO P [] { Group { children [ DEF T TimeSensor {} DEF S ScalarInterpolator {} ] } "
      "ROUTE T.fraction_changed TO S.set_fraction } P {} P {}");
  CHECK(world.lines() == Lines{"T.fraction_changed -> S.set_fraction", "T.fraction_changed -> S.set_fraction"});
}

TEST_CASE("highlights ROUTEs for half a second after an event, and counts events per second") {
  Routed world(kTwo);
  (void)world.lines();
  world.watch.watch(&world.execution);
  const auto light = [&](std::size_t row) {
    return RouteList::light_of(world.routes.rows()[row], world.watch, world.execution.now());
  };
  const auto a_second = [&](std::size_t row) {
    const RouteList::Row& one = world.routes.rows()[row];
    const EventWatch::Seen* const seen = world.watch.find(one.from, *one.event_out);
    return seen ? seen->a_second : -1;
  };
  CHECK(light(0) == 0);
  CHECK(a_second(0) == -1);
  CHECK_FALSE(world.watch.take_news());
  for (int i = 1; i <= 10; ++i) {
    world.execution.step(1000 + 0.05 * i);
    world.set("I", "set_fraction", 0.1f * static_cast<float>(i));
  }
  CHECK(world.watch.take_news());
  CHECK(light(0) > 0.9f);
  CHECK(light(1) > 0.9f);
  world.execution.step(1000.75);
  CHECK(light(0) == Approx(0.5).margin(0.01));
  world.execution.step(1001);
  (void)world.watch.take_news();
  CHECK(a_second(0) == Approx(10));
  CHECK(light(1) == Approx(0).margin(1e-6));
  // A second without events.
  world.execution.step(1002);
  (void)world.watch.take_news();
  CHECK(a_second(0) == 0);
}

TEST_CASE("notifies several watchers, but none that ended its watch") {
  Routed world(kTwo);
  int others = 0;
  world.execution.cascade().observe([&](const vrml::SentEvent&) { ++others; });
  world.watch.watch(&world.execution);
  world.set("I", "set_fraction", 0.5f);
  CHECK(others == 3);
  CHECK(world.watch.size() == 3);
  world.watch.watch(nullptr);
  CHECK(world.watch.size() == 0);
  world.set("I", "set_fraction", 0.25f);
  CHECK(others == 6);
  CHECK(world.watch.size() == 0);
}

}  // namespace gs::app::route_list_test
