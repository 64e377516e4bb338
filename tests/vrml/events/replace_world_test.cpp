#include "tests/vrml/events/run_time_nodes.h"

#include <string>

namespace gs::vrml::traces {

TEST_CASE("replaces the world by the nodes of replaceWorld and removes all others (4.12.10.8)") {
  World world(
      "DEF V Viewpoint { } DEF Kept Group { children DEF Inner Group { } } DEF Ticks TimeSensor { loop TRUE } "
      "DEF I Inline { }");
  world.scene().inlines().attach(world.node("I"), std::make_shared<SceneGraph>("part.wrl", world.scene().budget()));
  world.execution().scenes().attach();
  world.start();
  SceneGraph& scene = world.scene();
  const NodeId inner = world.node("Inner"), ticks = world.node("Ticks");
  std::size_t places = 0;
  for (int round = 0; round < 300; ++round) {
    const MFNode made = read(world, "DEF W Viewpoint { } Transform { children Shape { } }");
    MFNode next = made;
    if (round == 0) next.push_back(inner);
    CHECK(world.execution().lifetime().replace_world(next));
    (void)world.take();
    world.step(round + 1);
    CHECK(world.execution().lifetime().replaced() == static_cast<std::uint32_t>(round + 1));
    CHECK(scene.roots() == next);
    CHECK(world.take("W.isBound").back() == std::to_string(round + 1) + " W.isBound TRUE");
    CHECK(scene.contains(inner) == (round == 0));
    CHECK(!scene.contains(ticks));
    CHECK(scene.inlines().all().empty());
    if (round == 3) places = scene.nodes().count();
    if (round > 3) CHECK(scene.nodes().count() == places);
  }
  CHECK(!world.execution().lifetime().replace_world(only(inner)));
  CHECK(world.execution().stacks().bound(*built_in_node_type("Viewpoint")).node == scene.roots()[0]);
}

TEST_CASE("replaces the world by nodes of an Inline's scene and removes the Inline (4.12.10.8)") {
  World world("DEF V Viewpoint { } DEF G Group { children DEF I Inline { } } DEF Ticks TimeSensor { loop TRUE }");
  const auto read_part = [&](const std::string& name, const std::string& text) {
    auto part = std::make_shared<SceneGraph>(name, world.scene().budget());
    Diagnostics diagnostics;
    (void)parse("#VRML V2.0 utf8\n" + text, *part, diagnostics);
    CHECK(diagnostics.errors() == 0);
    return part;
  };
  const auto outer = read_part("outer.wrl", "Inline { } DEF Gone TimeSensor { loop TRUE }");
  std::weak_ptr<SceneGraph> watched, watched_outer = outer;
  {
    auto part = read_part("part.wrl",
                          "DEF Kept Group { children [ DEF P Viewpoint { } DEF T TimeSensor { loop TRUE } DEF L "
                          "PointLight { } ] } Shape { } "
                          "ROUTE T.isActive TO L.on");
    watched = part;
    outer->inlines().attach(outer->roots()[0], std::move(part));
  }
  world.scene().inlines().attach(world.node("I"), outer);
  world.execution().scenes().attach();
  world.start();
  SceneGraph& part = *watched.lock();
  const NodeId kept = part.roots()[0], shape = part.roots()[1];
  std::size_t places = 0;
  for (int round = 0; round < 100; ++round) {
    Diagnostics diagnostics;
    MFNode next = read_into(part, "made.wrl", "DEF W Viewpoint { } Group { }", diagnostics).roots;
    world.execution().scenes().attach(part);
    if (round == 0) next.push_back(kept);
    CHECK(world.execution().lifetime().replace_world(part, next));
    world.step(round + 1);
    CHECK(world.execution().lifetime().replaced() == static_cast<std::uint32_t>(round + 1));
    REQUIRE(world.scene().roots().size() == 1);
    CHECK(world.scene().inlines().of(world.scene().roots()[0]) == &part);
    CHECK(world.scene().inlines().all().size() == 1);
    CHECK(part.roots() == next);
    CHECK(part.contains(kept) == (round == 0));
    CHECK(!part.contains(shape));
    CHECK(!world.execution().scenes().has(outer.get()));
    const NodeChange bound = world.execution().stacks().bound(built_in_node_type(NodeKind::viewpoint));
    CHECK(bound.scene == &part);
    CHECK(bound.node == next[0]);
    CHECK(world.execution().next_time().has_value() == (round == 0));
    if (round == 3) places = world.scene().nodes().count() + part.nodes().count();
    if (round > 3) CHECK(world.scene().nodes().count() + part.nodes().count() == places);
  }
  // Nodes of the file get reused slots.
  MFNode made = read(world, "Group { }");
  CHECK(world.execution().lifetime().replace_world(world.scene(), made));
  world.step(200);
  CHECK(world.scene().roots() == made);
  CHECK(watched.expired());
  SceneGraph foreign("foreign.wrl", world.scene().budget());
  CHECK(!world.execution().lifetime().replace_world(foreign, {}));
}

// Compares with a model that searches every node and every ROUTE each time.

}  // namespace gs::vrml::traces
