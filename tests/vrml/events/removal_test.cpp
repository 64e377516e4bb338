#include "tests/vrml/events/run_time_nodes.h"
#include "tests/watched.h"

#include <algorithm>
#include <map>
#include <random>
#include <set>
#include <string>

namespace gs::vrml::traces {
namespace {

// Everything that a text can contain: names, PROTOs with bodies and defaults, Scripts with fields, sensors, ROUTEs,
// long lists.
const char* const kAllKinds = R"(
  PROTO Lamp [ exposedField SFColor color 1 0 0 field MFNode parts [ Group { children Shape { } } ] ] {
    DEF Body Transform { children [ Group { children IS parts } DEF L PointLight { color IS color } ] }
    DEF Clock TimeSensor { loop TRUE }
    ROUTE Clock.isActive TO L.on
  }
  PROTO Pair [ ] { Group { children [ Lamp { } Lamp { color 0 1 0 parts [ ] } ] } }
  DEF Top Transform { children [
    Pair { } DEF Same Lamp { } USE Same
    Shape { geometry IndexedFaceSet { coord Coordinate { point [ 0 0 0, 1 0 0, 1 1 0, 0 1 0 ] }
                                      coordIndex [ 0 1 2 3 -1 0 1 2 3 -1 0 1 2 3 -1 ] } }
    DEF Touch TouchSensor { } DEF Near ProximitySensor { size 9 9 9 } Anchor { url "x" } Inline { }
    DEF Ticks TimeSensor { loop TRUE } DEF Moves PositionInterpolator { key [ 0 1 ] keyValue [ 0 0 0, 1 1 1 ] }
    DEF Bends CoordinateInterpolator { key [ 0 1 ] keyValue [ 0 0 0, 1 1 1 ] }
    DEF S Script { url "javascript:" field SFNode self USE Top eventIn SFTime touched eventOut MFNode made
                   field SFString a "" field SFString b "" field SFString c "" field SFString d "" field SFString e "" }
  ] }
  Viewpoint { description "run time" }
  ROUTE Ticks.fraction_changed TO Moves.set_fraction ROUTE Moves.value_changed TO Top.translation
  ROUTE Ticks.fraction_changed TO Bends.set_fraction ROUTE Touch.touchTime TO S.touched
)";

}  // namespace

TEST_CASE("frees the memory of nodes that were created and discarded at run time") {
  World world("DEF Kept Group { }");
  world.start();
  SceneGraph& scene = world.scene();
  struct Memory {
    std::size_t places, charged;
    std::uint64_t nodes, instances;
    bool operator==(const Memory&) const = default;
  } before{};
  const std::size_t rounds = 3000 / watched_step(29);
  for (std::size_t round = 0; round < rounds; ++round) {
    const MFNode made = read(world, kAllKinds);
    REQUIRE(made.size() == 2);
    world.send("Kept.addChildren", made);
    world.step(static_cast<double>(round));
    CHECK(scene.contains(made[0]));
    world.send("Kept.removeChildren", made);
    CHECK(world.execution().lifetime().remove_unheld() > 30);
    CHECK(!scene.contains(made[0]));
    CHECK(scene.texts().run_time_count() == 0);
    (void)world.take();
    const Memory now{scene.nodes().count(), scene.memory().charged(), scene.budget()->used(Resource::nodes),
                     scene.budget()->used(Resource::instances)};
    if (round == 2) before = now;
    if (round > 2) REQUIRE(now == before);
  }
  CHECK(before.instances == 0);
}

TEST_CASE("reuses slots for a million nodes that are created and removed", "[optimised]") {
  World world("DEF Kept Group { }");
  world.start();
  std::size_t most = 0;
  for (int round = 0; round < 1'000'000; ++round) {
    const MFNode made = read(world, "Transform { translation 1 2 3 }");
    world.send("Kept.set_children", made);
    if (round % 1000 == 0) world.step(round);
    most = std::max(most, world.scene().nodes().count());
  }
  (void)world.take();
  CHECK(most < 2000);  // the search runs after some hundreds of nodes
  CHECK(world.scene().budget()->used(Resource::nodes) < std::uint64_t{2} << 20);
}

TEST_CASE("gives unique ids to nodes of the root, its Inlines and run time, also in reused slots") {
  World world("DEF Kept Group { } DEF Part Inline { }");
  auto content = std::make_shared<SceneGraph>("part.wrl", world.scene().budget());
  Diagnostics diagnostics;
  (void)parse("#VRML V2.0 utf8\nGroup { } Group { }", *content, diagnostics);
  world.scene().inlines().attach(world.node("Part"), content);
  world.execution().scenes().attach();
  world.start();
  std::set<std::uint32_t> seen;
  const auto see = [&](NodeId id) { CHECK(seen.insert(id.generation).second); };
  for (std::uint32_t i = 1; i <= 2; ++i) see(world.scene().nodes().id_at(i)), see(content->nodes().id_at(i));
  CHECK(!content->contains(world.scene().nodes().id_at(1)));
  for (int round = 0; round < 1000; ++round) {
    const NodeId made = read(world, "Group { }")[0];
    see(made);
    CHECK(made.index == 3);
    CHECK(world.execution().lifetime().remove_unheld() == 1);
    CHECK(!world.scene().contains(made));
  }
}

TEST_CASE("gives a node that was created at run time the origin of its text") {
  World world("DEF Kept Group { }");
  world.start();
  const NodeId made = read(world, "DEF A Group { } PROTO P [ ] { Group { } } P { }")[0];
  CHECK(world.scene().node(made).text->file_name() == "made.wrl");
  CHECK(world.scene().node(made).name == "A");
  CHECK(world.scene().node(world.node("Kept")).text == &world.scene());
  Diagnostics diagnostics;
  CHECK(read_into(world.scene(), "url.wrl", "Group { childrn [ ] }", diagnostics).roots.size() == 1);
  REQUIRE(diagnostics.errors() == 1);
  CHECK(diagnostics.entries()[0].text().starts_with("url.wrl:1:9: error:"));
}

TEST_CASE("keeps nodes that fields, ROUTEs, PROTO instances or holds refer to") {
  World world("DEF Kept Transform { } DEF T TimeSensor { }");
  world.start();
  SceneGraph& scene = world.scene();
  Execution& execution = world.execution();

  SECTION("a field of a node that is held, and no field of one that is not") {
    const MFNode made = read(world, "DEF A Group { children Group { } } Group { }");
    const NodeId inner = scene.get<MFNode>(made[0], "children")[0];
    world.send("Kept.addChildren", only(made[0]));
    CHECK(execution.lifetime().remove_unheld() == 1);
    CHECK(scene.contains(inner));
    world.send("A.removeChildren", only(inner));
    CHECK(execution.lifetime().remove_unheld() == 1);
    CHECK(!scene.contains(inner));
  }
  SECTION("one who may yet use it, as often as he says so") {
    const NodeId made = read(world, "Group { }")[0];
    execution.lifetime().hold(scene, made);
    execution.lifetime().hold(scene, made);
    execution.lifetime().release(scene, made);
    CHECK(execution.lifetime().remove_unheld() == 0);
    execution.lifetime().release(scene, made);
    CHECK(execution.lifetime().remove_unheld() == 1);
    execution.lifetime().release(scene, made);  // the caller no longer uses the node
  }
  SECTION("its ROUTE to a node that is held, not one from such a node") {
    const MFNode made = read(world, "PositionInterpolator { } PositionInterpolator { }");
    const Route to = route_of(scene, made[0], "value_changed", world.node("Kept"), "translation");
    CHECK(execution.routes().add(scene, to));
    CHECK(execution.routes().add(scene, route_of(scene, world.node("T"), "fraction_changed", made[1], "set_fraction")));
    CHECK(execution.lifetime().remove_unheld() == 1);
    CHECK(scene.contains(made[0]));
    CHECK(!scene.contains(made[1]));
    CHECK(execution.routes().remove(scene, to));
    CHECK(execution.lifetime().remove_unheld() == 1);
  }
  SECTION("a ROUTE to it, if it is a Script") {
    const NodeId made = read(world, "Script { eventIn SFTime now }")[0];
    const Route to = route_of(scene, world.node("T"), "time", made, "now");
    CHECK(execution.routes().add(scene, to));
    CHECK(execution.lifetime().remove_unheld() == 0);
    CHECK(execution.routes().remove(scene, to));
    CHECK(execution.lifetime().remove_unheld() == 1);
  }
  SECTION("the nodes of a PROTO instance and the instance each other") {
    const NodeId made = read(world, "PROTO P [ ] { Group { } DEF I ScalarInterpolator { } DEF U Group { } } P { }")[0];
    const NodeId inner = scene.node(made).expansion[2];
    world.send("Kept.addChildren", only(inner));
    CHECK(execution.lifetime().remove_unheld() == 0);
    CHECK(scene.contains(made));
    CHECK(scene.texts().run_time_count() == 1);
    world.send("Kept.set_children", MFNode());
    CHECK(execution.lifetime().remove_unheld() == 4);
    CHECK(scene.texts().run_time_count() == 0);
  }
  SECTION("no circle of nodes holds itself") {
    const NodeId made = read(world, "DEF Top Group { children Script { field SFNode top USE Top } }")[0];
    world.send("Kept.set_children", only(made));
    CHECK(execution.lifetime().remove_unheld() == 0);
    world.send("Kept.set_children", MFNode());
    CHECK(execution.lifetime().remove_unheld() == 2);
  }
  SECTION("an event that a node has sent") {
    const MFNode made = read(world, "Group { } DEF S Script { eventOut SFNode out }");
    const MFNode receiver = read(world, "DEF R Script { eventIn SFNode in }");
    for (const NodeId id : {made[1], receiver[0]}) execution.lifetime().hold(scene, id);
    CHECK(execution.lifetime().remove_unheld() == 1);
  }
}

TEST_CASE("stops events of removed nodes and reuses their slots") {
  World world("DEF Kept Group { }");
  world.start();
  (void)world.take();
  for (int round = 0; round < 20; ++round) {
    const double now = round * 10;
    const MFNode made = read(world, "DEF Ticks TimeSensor { loop TRUE stopTime 0 startTime 0 }");
    world.send("Kept.set_children", made);
    (void)world.take();
    CHECK(world.take_at(now + 1, "Ticks.time").size() == 1);
    CHECK(world.take_at(now + 2, "Ticks.time").size() == 1);
    world.send("Kept.set_children", MFNode());
    CHECK(world.execution().lifetime().remove_unheld() == 1);
    (void)world.take();
    CHECK(world.take_at(now + 3, "time").empty());
    CHECK(!world.execution().next_time());
  }
}

TEST_CASE("unbinds a bound node that is deleted, as set_bind FALSE would (4.6.10)") {
  World world("DEF First Viewpoint { } DEF Kept Group { }");
  world.start();
  const MFNode made = read(world, "DEF Second Viewpoint { }");
  world.execution().lifetime().hold(world.scene(), made[0]);
  (void)world.take();
  world.send_at(1, "Second.set_bind", true);
  CHECK(world.take("isBound") == Lines{"1 First.isBound FALSE", "1 Second.isBound TRUE"});
  world.step(2);
  world.execution().lifetime().release(world.scene(), made[0]);
  CHECK(world.execution().lifetime().remove_unheld() == 1);
  CHECK(world.take("isBound") == Lines{"2 Second.isBound FALSE", "2 First.isBound TRUE"});
  CHECK(world.execution().stacks().bound(*built_in_node_type("Viewpoint")).node == world.node("First"));
}

TEST_CASE("removes an Inline with its whole content") {
  World world("DEF V Viewpoint { } DEF Part Inline { }");
  world.start();
  const std::uint64_t before = world.scene().budget()->used(Resource::nodes);
  std::vector<std::pair<const SceneGraph*, NodeId>> told;
  world.execution().lifetime().observe_removal(
      [&](SceneGraph& scene, NodeId node) { told.emplace_back(&scene, node); });
  for (int round = 1; round < 40; ++round) {
    const auto part = [&](const std::string& body) {
      auto content = std::make_shared<SceneGraph>("part.wrl", world.scene().budget());
      Diagnostics diagnostics;
      (void)parse("#VRML V2.0 utf8\n" + body, *content, diagnostics);
      return content;
    };
    auto outer = part("DEF W Viewpoint { } TimeSensor { loop TRUE } Inline { }");
    outer->inlines().attach(outer->roots()[2], part("Viewpoint { } TouchSensor { }"));
    const NodeId view = outer->roots()[0];
    const std::weak_ptr<SceneGraph> watched = outer;
    world.scene().inlines().attach(world.node("Part"), std::move(outer));
    world.execution().scenes().attach();
    world.step(round);
    SceneGraph& scene = *watched.lock();
    CHECK(world.execution().send(scene, view, *scene.node(view).type->find("set_bind"), FieldValue(true)));
    (void)world.take();
    world.step(round + 0.5);
    (void)world.take();
    world.execution().lifetime().remove_content(world.scene(), world.node("Part"));
    CHECK(watched.expired());
    CHECK(world.take("isBound") ==
          Lines{std::to_string(round) + ".5 W.isBound FALSE", std::to_string(round) + ".5 V.isBound TRUE"});
    CHECK(told.size() == 2);
    told.clear();
    // The node that shows the Inline is reported as changed.
    const auto changes = world.execution().changes().take();
    CHECK(std::any_of(changes.begin(), changes.end(),
                      [&](const NodeChange& one) { return one.node == world.node("Part"); }));
    CHECK(world.take_at(round + 0.75, "time").empty());
  }
  CHECK(world.scene().budget()->used(Resource::nodes) < before + (1 << 19));
}

TEST_CASE("removes exactly the unreferenced nodes under random operations") {
  for (std::uint32_t seed = 1; seed <= 40; seed += static_cast<std::uint32_t>(watched_step(9))) {
    World world(
        "PROTO P [ exposedField MFNode children [ ] ] { Group { children IS children } } DEF G0 Group { } "
        "DEF G1 Transform { } DEF G2 P { } DEF T TimeSensor { loop TRUE } DEF S Script { eventIn SFFloat in }");
    world.start();
    SceneGraph& scene = world.scene();
    Execution& execution = world.execution();
    std::mt19937 random(seed);
    const auto below = [&](std::size_t count) { return static_cast<std::size_t>(random() % count); };
    std::vector<NodeId> made;
    std::map<std::uint32_t, std::pair<NodeId, int>> holds;
    std::vector<Route> routes;
    std::vector<NodeId> parents = {world.node("G0"), world.node("G1"), world.node("G2")};
    const std::vector<NodeId> of_file = {world.node("T"), world.node("S")};
    const auto alive = [&](std::vector<NodeId>& list) {
      std::erase_if(list, [&](NodeId id) { return !scene.contains(id); });
    };
    const auto held_nodes = [&] {
      std::set<std::uint32_t> held;
      for (std::uint32_t i = 1; i <= scene.nodes().count(); ++i)
        if (scene.nodes().at(i).owner == 0 && !scene.nodes().at(i).in_prototype_body) held.insert(i);
      for (const auto& [index, hold] : holds)
        if (hold.second > 0) held.insert(index);
      for (std::size_t before = 0; before != held.size();) {
        before = held.size();
        for (const std::uint32_t index : std::vector<std::uint32_t>(held.begin(), held.end())) {
          const Node& node = scene.nodes().at(index);
          for (std::size_t slot = 0; slot < node.type->defaults.size(); ++slot) {
            if (const auto* one = std::get_if<SFNode>(&node.values[slot]); one && *one) held.insert(one->index);
            if (const auto* all = std::get_if<MFNode>(&node.values[slot]))
              for (const NodeId id : *all) held.insert(id.index);
          }
          if (node.instance != 0) held.insert(node.instance);
          for (std::uint32_t i = 0; node.expansion_first != 0 && i < node.type->prototype->nodes.size(); ++i)
            held.insert(node.expansion_first + i);
        }
        for (const Route& route : routes) {
          if (held.contains(route.to.index)) held.insert(route.from.index);
          const bool script = scene.node(route.to).type->kind == NodeType::Kind::script;
          if (script && held.contains(route.from.index)) held.insert(route.to.index);
        }
      }
      return held;
    };
    const char* const kTexts[] = {
        "Group { }",
        "Transform { children [ Group { } Shape { appearance Appearance { } } ] }",
        "PROTO Q [ exposedField MFNode children [ ] ] { Group { children IS children } Group { } } Q { children Q { } "
        "}",
        "ScalarInterpolator { }",
        "Script { eventIn SFFloat in eventOut SFFloat out field SFNode n Group { } }",
        "DEF A ScalarInterpolator { } DEF B ScalarInterpolator { } ROUTE A.value_changed TO B.set_fraction"};
    for (int operation = 0; operation < 400; ++operation) {
      std::vector<NodeId> groups = parents;
      for (const NodeId id : made)
        if (scene.node(id).type->find_event_in("addChildren") || scene.node(id).type->find_event_in("children"))
          groups.push_back(id);
      const NodeId group = groups[below(groups.size())];
      const NodeId some = made.empty() ? NodeId{} : made[below(made.size())];
      const auto tell = [&](std::string_view event, MFNode value) {
        const InterfaceDeclaration* event_in = scene.node(group).type->find_event_in(event);
        if (event_in) CHECK(execution.send(scene, group, *event_in, FieldValue(std::move(value))));
      };
      switch (below(10)) {
        case 0:
        case 1: {
          const std::uint64_t before = scene.nodes().revision();
          const std::size_t kind = below(std::size(kTexts));
          const MFNode roots = read(world, kTexts[kind]);
          CHECK(scene.nodes().revision() != before);
          for (const NodeId id : roots) made.push_back(id);
          if (kind == 5) routes.push_back(route_of(scene, roots[0], "value_changed", roots[1], "set_fraction"));
          // In half of the rounds, a caller holds the node for a while.
          if (below(2) == 0) {
            execution.lifetime().hold(scene, roots[0]);
            holds[roots[0].index].first = roots[0];
            ++holds[roots[0].index].second;
          }
          break;
        }
        case 2:
        case 3:
          if (some && some != group) tell("addChildren", only(some));
          break;
        case 4:
          if (some) tell("removeChildren", only(some));
          break;
        case 5:
          if (some && some != group) tell("set_children", below(3) == 0 ? MFNode() : only(some));
          break;
        case 6:
          if (const auto first = holds.begin(); first != holds.end() && first->second.second > 0) {
            execution.lifetime().release(scene, first->second.first);
            if (--first->second.second == 0) holds.erase(first);
          }
          break;
        case 7: {
          std::vector<NodeId> sources = {world.node("T")}, targets = {world.node("S")};
          for (const NodeId id : made) {
            if (scene.node(id).type->find_event_out("value_changed")) sources.push_back(id);
            if (scene.node(id).type->find_event_in("set_fraction") || scene.node(id).type->find("in"))
              targets.push_back(id);
          }
          const NodeId from = sources[below(sources.size())], to = targets[below(targets.size())];
          const Route route = route_of(scene, from, from == world.node("T") ? "fraction_changed" : "value_changed", to,
                                       scene.node(to).type->find("in") ? "in" : "set_fraction");
          if (execution.routes().add(scene, route)) routes.push_back(route);
          break;
        }
        case 8:
          if (!routes.empty()) {
            const std::size_t place = below(routes.size());
            CHECK(execution.routes().remove(scene, routes[place]));
            routes.erase(routes.begin() + static_cast<std::ptrdiff_t>(place));
          }
          break;
        default: {
          world.step(operation);
          (void)world.take();
          const std::set<std::uint32_t> held = held_nodes();
          (void)execution.lifetime().remove_unheld();
          for (std::uint32_t i = 1; i <= scene.nodes().count(); ++i)
            if (!scene.nodes().at(i).in_prototype_body && !held.contains(i)) FAIL("held without need: " << i);
          for (const std::uint32_t index : held) CHECK(scene.contains(scene.nodes().id_at(index)));
          alive(made);
          std::erase_if(routes, [&](const Route& one) { return !scene.contains(one.from) || !scene.contains(one.to); });
        }
      }
    }
    CHECK(of_file[0]);
    for (const auto& [index, hold] : holds)
      for (int i = 0; i < hold.second; ++i) execution.lifetime().release(scene, hold.first);
    world.step(1000);
    for (const char* parent : {"G0.set_children", "G1.set_children", "G2.set_children"}) world.send(parent, MFNode());
    for (const Route& route : routes) (void)execution.routes().remove(scene, route);
    (void)execution.lifetime().remove_unheld();
    CHECK(scene.texts().run_time_count() == 0);
  }
}

}  // namespace gs::vrml::traces
