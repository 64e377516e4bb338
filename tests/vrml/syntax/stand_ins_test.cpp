#include "vrml/syntax/stand_ins.h"

#include "tests/vrml/events/trace.h"

#include <glm/gtc/matrix_transform.hpp>

#include <string>

namespace gs::vrml::traces {

TEST_CASE("returns a stand-in PROTO of the requested name") {
  for (const std::string name : {"BlaxxunZone",
                                 "BspGroup",
                                 "DeviceSensor",
                                 "HUD",
                                 "Layer2D",
                                 "Layer3D",
                                 "Occlusion",
                                 "Particles",
                                 "SharedEvent",
                                 "SharedObject",
                                 "CullGroup",
                                 "InlineLoadControl",
                                 "KambiNavigationInfo",
                                 "MenuSensor",
                                 "MouseSensor",
                                 "SpaceSensor",
                                 "Selection",
                                 "SimpleBackground",
                                 "KambiInline",
                                 "Logger",
                                 "ColorSetInterpolator"}) {
    INFO(name);
    SceneGraph scene("text.wrl");
    const NodeType* type = stand_in(scene, name);
    REQUIRE(type);
    CHECK(type->name == name);
    CHECK(type->stands_in);
    CHECK(type->kind == NodeType::Kind::prototype);
    CHECK(has(type->role, Role::child));
    CHECK(built_in_node_type(name) == nullptr);
  }
  SceneGraph scene("text.wrl");
  REQUIRE(stand_in(scene, "RefractiveMaterial"));
  CHECK(has(stand_in(scene, "RefractiveMaterial")->role, Role::material));
  for (const std::string name : {"Polygon", "TrimmedSurface", "IndexedPolygons", "Teapot"}) {
    INFO(name);
    REQUIRE(stand_in(scene, name));
    CHECK(has(stand_in(scene, name)->role, Role::geometry));
  }
  CHECK(stand_in(scene, "MetadataBool"));
  CHECK(stand_in(scene, "Nobody") == nullptr);
  CHECK(stand_in(scene, "Rectangle2D") == nullptr);  // a node of X3D
  CHECK(stand_in(scene, "") == nullptr);
}

TEST_CASE("reports an unknown node type once") {
  SceneGraph scene("text.wrl");
  Diagnostics diagnostics;
  (void)parse(
      "#VRML V2.0 utf8\nShape { geometry Polygon { size 2 2 } }\nShape { geometry Polygon { } } Gyro { a 1 } "
      "Gyro { } DEF G Gyro { } Other { }",
      scene, diagnostics);
  Lines said;
  for (const Diagnostic& one : diagnostics.entries()) said.push_back(one.text());
  CHECK(said == Lines{"text.wrl:2:18: warning: 'Polygon' is not a VRML97 node, but an extension of other browsers; "
                      "a stand-in replaces it",
                      "text.wrl:3:32: error: unknown node type 'Gyro'; the node is skipped",
                      "text.wrl:3:69: error: unknown node type 'Other'; the node is skipped"});
}

TEST_CASE("chooses a stand-in for an EXTERNPROTO by its name or its children") {
  SceneGraph scene("text.wrl");
  NodeType external;
  external.name = "Region";
  external.kind = NodeType::Kind::external_prototype;
  CHECK(stand_in_for(scene, external) == nullptr);
  external.declare({AccessType::field, FieldType::SFNode, "children", SFNode{}, {}});
  CHECK(stand_in_for(scene, external) == nullptr);  // `children` is not a list
  external.name = "HUD";
  REQUIRE(stand_in_for(scene, external));
  CHECK(stand_in_for(scene, external)->name == "HUD");
  NodeType group;
  group.name = "Region";
  group.kind = NodeType::Kind::external_prototype;
  group.declare({AccessType::exposedField, FieldType::MFNode, "children", MFNode{}, {}});
  REQUIRE(stand_in_for(scene, group));
  CHECK(stand_in_for(scene, group)->find_event_in("addChildren"));
}

TEST_CASE("moves a HUD with the viewer, wherever it is in the scene") {
  World world("Transform { translation 5 1 2 scale 2 2 2 children DEF Overlay HUD { children DEF Sign Group { } } }");
  world.start();
  SceneGraph& scene = world.scene();
  const NodeId group = scene.resolve_as(world.node("Overlay"), NodeKind::group);
  REQUIRE(group);
  const MFNode inside = scene.get<MFNode>(group, "children");
  REQUIRE(inside.size() == 2);
  const NodeId frame = inside[1];
  CHECK(scene.get<MFNode>(frame, "children")[0] == world.node("Sign"));
  CHECK(scene.get<SFVec3f>(frame, "translation") == SFVec3f(-2.5f, -0.5f, 4));  // the viewer is at 0 0 10
  world.execution().viewer().set(glm::translate(glm::dmat4(1), {9, 1, 2}));
  world.step(1);
  CHECK(scene.get<SFVec3f>(frame, "translation") == SFVec3f(2, 0, 0));
  world.send("Overlay.removeChildren", MFNode{world.node("Sign")});
  CHECK(scene.get<MFNode>(frame, "children").empty());
}

TEST_CASE("fixes only the HUD stand-in to the viewer") {
  SceneGraph scene("main.wrl");
  REQUIRE(stand_in(scene, "HUD"));
  CHECK(is_overlay(*stand_in(scene, "HUD")));
  CHECK_FALSE(is_overlay(*stand_in(scene, "Layer3D")));
  NodeType own;  // a type of the world with the same name
  own.name = "HUD";
  CHECK_FALSE(is_overlay(own));
}

TEST_CASE("ignores fields and ROUTEs that a stand-in does not have") {
  World world(
      "DEF Clock TimeSensor { } DEF Wave SharedEvent { name \"wave\" url [ \"a\" \"b\" ] node Group { } } "
      "ROUTE Clock.isActive TO Wave.set_bool ROUTE Wave.bool_changed TO Clock.set_enabled "
      "PROTO Own [ field MFNode inside [ ] field SFBool on TRUE ] { Occlusion { children IS inside enabled IS on } } "
      "DEF O Own { inside DEF Inner Group { } }");
  CHECK(world.scene().routes().empty());
  const NodeId group = world.scene().resolve_as(world.node("O"), NodeKind::group);
  REQUIRE(group);
  CHECK(world.scene().get<MFNode>(group, "children")[0] == world.node("Inner"));
}

}  // namespace gs::vrml::traces
