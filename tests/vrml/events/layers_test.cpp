#include "tests/vrml/events/trace.h"

#include "vrml/scene/layers.h"

#include <string>
#include <vector>

// Tests of layers, and of the bindable nodes in them (X3D 35.2.2).
namespace gs::vrml::traces {
namespace {

constexpr const char* kTwoLayers =
    "DEF V Viewpoint { } DEF S LayerSet { activeLayer 1 order [ 0 2 1 2 7 -1 ] layers [ "
    "Layer { viewport Viewport { clipBoundary [ 0.5 1 0 0.25 ] } children [ "
    "DEF A Viewpoint { position 0 0 1 } DEF B Viewpoint { position 0 0 2 } ] } "
    "LayoutLayer { viewport Viewport { clipBoundary [ 1 0 0 2 ] } children [ "
    "Group { children DEF C Viewpoint { position 0 0 3 } } DEF F Fog { } ] } ] }";

}  // namespace

TEST_CASE("reads the layers of a world, their order and their clipBoundary (X3D 35.4)") {
  X3DWorld world(kTwoLayers);
  world.start();
  const std::optional<LayerSet> set = world.execution().stacks().layers();
  REQUIRE(set);
  CHECK(set->active == 1);
  CHECK(set->order == std::vector<int>{0, 2, 1});
  REQUIRE(set->layers.size() == 2);
  const SceneGraph& scene = world.execution().scenes().root();
  CHECK(clip_boundary_of(scene, set->layers[0]) == ClipBoundary{0.5, 1, 0, 0.25});
  CHECK(clip_boundary_of(scene, set->layers[1]) == ClipBoundary{0, 1, 0, 1});
  CHECK(clip_boundary_of(scene, NodeId{}) == ClipBoundary{0, 1, 0, 1});
}

TEST_CASE("has no layers in a world without a LayerSet, and one layer if activeLayer names none") {
  X3DWorld plain("Viewpoint { }");
  plain.start();
  CHECK_FALSE(plain.execution().stacks().layers());
  CHECK(plain.execution().stacks().active_layer() == 0);
  X3DWorld wrong("LayerSet { activeLayer 3 layers Layer { } }");
  wrong.start();
  CHECK(wrong.execution().stacks().active_layer() == 0);
}

TEST_CASE("binds the first node of each kind in each layer (X3D 35.2.2)") {
  X3DWorld world(kTwoLayers);
  world.start();
  CHECK(world.take("isBound") == Lines{"0 V.isBound TRUE", "0 A.isBound TRUE", "0 C.isBound TRUE", "0 F.isBound TRUE"});
  CHECK(world.execution().viewer().pose()[3].z == 1);
}

TEST_CASE("binds nodes only in the stack of their layer, and moves the viewer only in the active one") {
  X3DWorld world(kTwoLayers);
  world.start();
  (void)world.take();
  world.send_at(1, "B.set_bind", SFBool{true});
  CHECK(world.take("isBound") == Lines{"1 A.isBound FALSE", "1 B.isBound TRUE"});
  CHECK(world.execution().viewer().pose()[3].z == 2);
  world.send_at(2, "C.set_bind", SFBool{false});
  CHECK(world.take("isBound") == Lines{"2 C.isBound FALSE"});
  CHECK(world.execution().viewer().pose()[3].z == 2);
  world.send_at(3, "S.activeLayer", SFInt32{0});
  CHECK(world.execution().stacks().active_layer() == 0);
  CHECK(world.execution().viewer().pose()[3].z == 10);
}

TEST_CASE("gives equal traces for a layer whether or not nodes are bound in another one (X3D 35.2.2)") {
  const std::string first = "DEF A Viewpoint { position 0 0 1 } DEF B Viewpoint { position 0 0 2 } ",
                    second = "DEF C Viewpoint { position 0 0 3 } DEF D Viewpoint { position 0 0 4 } ";
  const auto trace = [&](bool other_acts) {
    X3DWorld world("LayerSet { activeLayer 1 order [ 1 2 ] layers [ Layer { children [ " + first +
                   "] } Layer { children [ " + second + "] } ] }");
    world.start();
    world.send_at(1, "B.set_bind", SFBool{true});
    if (other_acts) world.send_at(2, "D.set_bind", SFBool{true});
    if (other_acts) world.send_at(2, "C.set_bind", SFBool{false});
    world.send_at(3, "B.set_bind", SFBool{false});
    Lines lines;
    for (const std::string& line : world.take("isBound"))
      if (line.find(" A.") != std::string::npos || line.find(" B.") != std::string::npos) lines.push_back(line);
    CHECK(world.execution().viewer().pose()[3].z == 1);
    return lines;
  };
  const Lines alone = trace(false);
  CHECK(alone ==
        Lines{"0 A.isBound TRUE", "1 A.isBound FALSE", "1 B.isBound TRUE", "3 B.isBound FALSE", "3 A.isBound TRUE"});
  CHECK(trace(true) == alone);
}

TEST_CASE("binds a node that is in two layers on the stack of each (X3D 35.2.2)") {
  X3DWorld world(
      "LayerSet { activeLayer 2 order [ 1 2 ] layers [ Layer { children DEF A Viewpoint { position 0 0 1 } } "
      "Layer { children [ USE A DEF B Viewpoint { position 0 0 2 } ] } ] }");
  world.start();
  const auto top = [&](int layer) {
    return world.execution().stacks().bound(built_in_node_type(NodeKind::viewpoint), layer).node;
  };
  CHECK(world.take("isBound") == Lines{"0 A.isBound TRUE"});
  CHECK(top(1) == world.node("A"));
  CHECK(top(2) == world.node("A"));
  CHECK(world.execution().viewer().pose()[3].z == 1);
  world.send_at(1, "B.set_bind", SFBool{true});
  CHECK(world.take("isBound") == Lines{"1 B.isBound TRUE"});  // A stays bound in layer 1
  CHECK(top(1) == world.node("A"));
  CHECK(top(2) == world.node("B"));
  world.send_at(2, "A.set_bind", SFBool{true});
  CHECK(world.take("isBound") == Lines{"2 B.isBound FALSE"});
  world.send_at(3, "A.set_bind", SFBool{false});
  CHECK(world.take("isBound") == Lines{"3 A.isBound FALSE", "3 B.isBound TRUE"});
  CHECK_FALSE(top(1));
  CHECK(top(2) == world.node("B"));
}

TEST_CASE("unbinds a node in the layer that it leaves, and keeps it bound in the other one (X3D 35.2.2)") {
  X3DWorld world(
      "LayerSet { activeLayer 1 order [ 1 2 ] layers [ DEF L Layer { children [ DEF A Viewpoint { position 0 0 1 } "
      "DEF B Viewpoint { position 0 0 2 } ] } DEF M Layer { children [ USE A DEF C Fog { } ] } ] }");
  world.start();
  const auto top = [&](int layer) {
    return world.execution().stacks().bound(built_in_node_type(NodeKind::viewpoint), layer).node;
  };
  world.send_at(1, "B.set_bind", SFBool{true});
  world.send_at(2, "A.set_bind", SFBool{true});
  (void)world.take("isBound");
  world.send_at(3, "L.removeChildren", MFNode{world.node("A")});
  CHECK(world.take("isBound") == Lines{"3 B.isBound TRUE"});  // A stays bound in layer 2
  CHECK(top(1) == world.node("B"));
  CHECK(top(2) == world.node("A"));
  CHECK(world.execution().viewer().pose()[3].z == 2);
  world.send_at(4, "M.removeChildren", MFNode{world.node("A")});
  CHECK(world.take("isBound") == Lines{"4 A.isBound FALSE"});
  CHECK_FALSE(top(2));
}

TEST_CASE("unbinds a node that moves from its layer to another one") {
  X3DWorld world(
      "LayerSet { activeLayer 1 order [ 1 2 ] layers [ DEF L Layer { children DEF A Viewpoint { } } DEF M Layer { "
      "children Group { } } ] }");
  world.start();
  (void)world.take("isBound");
  world.send_at(1, "M.addChildren", MFNode{world.node("A")});
  world.send_at(2, "L.removeChildren", MFNode{world.node("A")});
  CHECK(world.take("isBound") == Lines{"2 A.isBound FALSE"});
}

TEST_CASE("binds new types in each layer, even if another layer has bound one") {
  X3DWorld world(
      "LayerSet { activeLayer 2 order [ 1 2 ] layers [ Layer { children Fog { } } "
      "Layer { children DEF P Group { } } ] }");
  world.start();
  SceneGraph& scene = world.scene();
  const NodeId fog = scene.create(*built_in_node_type("Fog"));
  scene.set<MFNode>(world.node("P"), "children", MFNode{fog});
  world.execution().stacks().bind_new_types();
  CHECK(world.execution().stacks().bound(built_in_node_type(NodeKind::fog), 2).node == fog);
}

}  // namespace gs::vrml::traces
