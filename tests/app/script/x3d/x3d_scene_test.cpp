#include "tests/app/script/scripts.h"

// Tests of the Browser object, the scene and the nodes of ISO/IEC 19777-1.
namespace gs::app::x3d_scene_test {

using scripts::Lines;
using scripts::run_x3d;
using scripts::x3d_value;
using scripts::X3DWorld;

TEST_CASE("sends inputOutput fields, and accepts their names x and x_changed") {
  X3DWorld world(
      "DEF S Script { inputOnly SFFloat go inputOutput SFFloat size 1 outputOnly SFFloat out url \"ecmascript:"
      "function go(value, time) { print(value + ' ' + time); size_changed = value; out = 2 * size; }"
      "function set_size(value, time) { print('size ' + value + ' ' + size + ' ' + time); }\" }");
  world.start();
  world.send_at(1, "S.go", 4.0f);
  CHECK(world.printed() == Lines{"4 1001"});
  CHECK(world.take() == Lines{"1 S.size 4", "1 S.out 8"});
  world.send_at(2, "S.set_size", 5.0f);
  CHECK(world.printed() == Lines{"size 5 5 1002"});
}

TEST_CASE("calls prepareEvents() once in each step before all events, and shutdown() at the end") {
  X3DWorld world(
      "DEF T TimeSensor { loop TRUE } DEF S Script { inputOnly SFTime tick outputOnly SFInt32 n url \"ecmascript:"
      "var count = 0; function prepareEvents() { print('prepare'); n = ++count; }"
      "function tick() { print('tick'); } function eventsProcessed() { print('processed'); }"
      "function shutdown() { print('end'); }\" } ROUTE T.time TO S.tick");
  world.start();
  (void)world.printed();
  (void)world.take();
  world.step(1);
  CHECK(world.printed() == Lines{"prepare", "tick", "processed"});
  CHECK(world.take("S.n") == Lines{"1 S.n 1"});
  CHECK(world.execution().next_time() == world.execution().now());
  world.end();
  CHECK(world.printed() == Lines{"end"});
}

TEST_CASE("imports X3D documents from text, and objects with the text of an element") {
  const std::string document = "`<X3D version='3.3' profile='Core'><Scene><Group DEF='G'/></Scene></X3D>`";
  CHECK(x3d_value("Browser.importDocument(" + document + ").rootNodes[0].getNodeTypeName()") == "Group");
  CHECK(x3d_value("Browser.importDocument({documentElement: {outerHTML: " + document + "}}).rootNodes.length") == "1");
  CHECK(x3d_value("(function () { try { Browser.importDocument(null); } catch (e) { return e.message; } })()") ==
        "importDocument expects a document, or the text of one");
}

TEST_CASE("provides the properties of the Browser object") {
  CHECK(x3d_value("Browser.name") == "GhostSpace");
  CHECK(x3d_value("typeof Browser.version + typeof Browser.currentSpeed + typeof Browser.currentFrameRate") ==
        "stringnumbernumber");
  CHECK(x3d_value("Browser.supportedComponents.length > 20 && Browser.supportedComponents[0].level >= 1") == "true");
  CHECK(x3d_value("Browser.supportedProfiles.map(p => p.name).indexOf('Immersive') >= 0") == "true");
  CHECK(x3d_value("Browser.getComponent('Core').name + ' ' + Browser.getProfile('Interchange').name") ==
        "Core Interchange");
  CHECK(x3d_value("Browser.getRenderingProperty('ColorDepth')") == "24");
  CHECK(x3d_value("typeof Browser.addBrowserListener + typeof Browser.importDocument + typeof Browser.loadURL") ==
        "functionfunctionfunction");
  X3DWorld world("Script { url \"ecmascript: function initialize() { Browser.description = 'title'; }\" }");
  world.start();
  const auto requests = world.runner().take_requests();
  REQUIRE(requests.size() == 1);
  CHECK(requests[0].text == "title");
}

TEST_CASE("describes the scene of a Script: profile, components, encoding, root nodes, ROUTEs and PROTOs") {
  const std::string others =
      "PROFILE Interchange COMPONENT Scripting:1 META \"title\" \"a world\" "
      "PROTO Ball [ inputOutput SFFloat radius 1 ] { Group { } } "
      "DEF T Transform { } DEF C TimeSensor { } DEF P PositionInterpolator { } "
      "ROUTE C.fraction_changed TO P.set_fraction ROUTE P.value_changed TO T.set_translation ";
  const auto print = [&](const std::string& expression) {
    const Lines lines = run_x3d("var s = Browser.currentScene; print(" + expression + ");", {}, others);
    return lines.empty() ? std::string() : lines.front();
  };
  CHECK(print("s.specificationVersion + ' ' + s.encoding") == "3.3 VRML");
  CHECK(print("s.profile.name + ' ' + s.components[0].name + ' ' + s.components[0].level") ==
        "Interchange Scripting 1");
  CHECK(print("s.getMetaData('title')") == "a world");
  CHECK(print("s.rootNodes.length + ' ' + s.rootNodes[0].getNodeTypeName()") == "4 Transform");
  CHECK(print("s.routes.length + ' ' + s.routes[1].sourceField + ' ' + s.routes[1].destinationNode.getNodeName()") ==
        "2 value_changed T");
  CHECK(print("s.protos[0].name + ' ' + s.protos[0].fields[0].name + ' ' + s.protos[0].isExternProto") ==
        "Ball radius false");
  CHECK(print("s.getNamedNode('C').getNodeTypeName()") == "TimeSensor");
  CHECK(print("(function () { try { s.getNamedNode('X'); } catch (e) { return e.message; } })()") ==
        "no node is called 'X'");
  CHECK(print("(s.updateNamedNode('Z', s.getNamedNode('T')), s.getNamedNode('Z') === s.getNamedNode('T'))") == "true");
  CHECK(print("s.createProto('Ball').radius + ' ' + s.protos[0].newInstance().radius") == "1 1");
  CHECK(print("s.createNode('Box').getNodeTypeName() + ' ' + (s instanceof X3DScene)") == "Box true");
}

TEST_CASE("adds and removes ROUTEs and root nodes") {
  X3DWorld world(
      "DEF A Transform { } DEF B Transform { } DEF S Script { directOutput TRUE inputOnly SFBool go inputOnly SFBool "
      "stop url \"ecmascript: var r; function go() { var s = Browser.currentScene;"
      "r = s.addRoute(s.getNamedNode('A'), 'translation_changed', s.getNamedNode('B'), 'set_translation');"
      "s.addRootNode(s.createNode('Group')); print(s.rootNodes.length + ' ' + s.routes.length); }"
      "function stop() { var s = Browser.currentScene; s.deleteRoute(r); s.removeRootNode(s.rootNodes[3]);"
      "print(s.rootNodes.length + ' ' + s.routes.length); }\" }");
  world.start();
  world.send_at(1, "S.go", true);
  CHECK(world.printed() == Lines{"4 1"});
  CHECK(world.scene().roots().size() == 4);
  world.send_at(2, "A.translation", vrml::SFVec3f(1, 2, 3));
  CHECK(world.take("B.") == Lines{"2 B.translation 1 2 3"});
  world.send_at(3, "S.stop", true);
  CHECK(world.printed() == Lines{"3 0"});
  CHECK(world.problems() == Lines{});
}

TEST_CASE("creates scenes from text, and replaces the world by a scene") {
  CHECK(x3d_value("s.rootNodes.length + ' ' + s.getNamedNode('B').getNodeTypeName() + ' ' + (s instanceof X3DScene)",
                  "var s = Browser.createX3DFromString('Group { } DEF B Box { }');") == "2 Box true");
  X3DWorld world(
      "DEF S Script { inputOnly SFBool go url \"ecmascript: function go() {"
      "Browser.replaceWorld(Browser.createX3DFromString('DEF N Group { }')); }\" }");
  world.start();
  world.send_at(1, "S.go", true);
  world.step(2);
  REQUIRE(world.scene().roots().size() == 1);
  CHECK(world.scene().node(world.scene().roots()[0]).name == "N");
}

TEST_CASE("describes nodes: types, fields and text") {
  const std::string node = "var n = new SFNode('Transform { translation 1 2 3 }');";
  CHECK(x3d_value("n.getNodeTypeName() + ' ' + (n.getNodeType().indexOf(X3DConstants.X3DGroupingNode) >= 0)", node) ==
        "Transform true");
  CHECK(x3d_value(
            "[f.name, f.accessType == X3DConstants.inputOutput, f.dataType == X3DConstants.SFVec3f, f.value].join()",
            node + "var f = n.getFieldDefinitions().filter(f => f.name == 'translation')[0];") ==
        "translation,true,true,1 2 3");
  CHECK(x3d_value("n.getFieldValue('translation')", node) == "1 2 3");
  CHECK(x3d_value("n.toVRMLString().indexOf('translation 1 2 3') > 0", node) == "true");
  CHECK(x3d_value("new SFNode('Group { children Transform { scale 1 2 3 } }').toXMLString().indexOf("
                  "'<Transform ') > 0") == "true");
  CHECK(x3d_value("new SFNode(`<Transform scale='1 2 3'/>`).scale.y") == "2");
  CHECK(x3d_value("n.translation.equals(new SFVec3f(1, 2, 3)) + ' ' + n.translation.getTypeName()", node) ==
        "true SFVec3f");
  CHECK(x3d_value("X3DConstants.inputOnly + ' ' + X3DConstants.COMPLETE_STATE + ' ' + typeof X3DConstants.MFVec4d") ==
        "2 2 number");
}

TEST_CASE("gives a Script inside a PROTO an execution context with the nodes of its instance") {
  X3DWorld world(
      "DEF T Group { } PROTO P [ ] { DEF T Transform { } DEF S Script { url \"ecmascript: function initialize() {"
      "var c = Browser.currentScene; print(c.getNamedNode('T').getNodeTypeName() + ' ' + (c instanceof X3DScene)); }\" "
      "} "
      "} P { }");
  world.start();
  CHECK(world.printed() == Lines{"Transform false"});
  CHECK(world.problems() == Lines{});
}

}  // namespace gs::app::x3d_scene_test
