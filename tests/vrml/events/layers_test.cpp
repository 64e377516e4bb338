#include "tests/vrml/events/trace.h"

#include "vrml/scene/layers.h"

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

}  // namespace gs::vrml::traces
