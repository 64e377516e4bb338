#include "controlled.h"

#include <string>
#include <vector>

namespace gs::app::control_test {
namespace {

using controlled::Json;
using controlled::World;

const std::string kBox = "DEF Box Transform { children Shape { geometry Box {} } } ";

}  // namespace

TEST_CASE("finds a node by its DEF name, with number, type and interface (14772-2 getNode)") {
  World world(kBox + "DEF T TimeSensor {}");
  const Json box = world.call("getNode", {{"node", "Box"}});
  CHECK(box["type"] == "Transform");
  CHECK(box["name"] == "Box");
  CHECK(world.call("getNode", {{"node", "Box"}})["node"] == box["node"]);
  CHECK(world.call("getNode", Json::array({"T"}))["node"] != box["node"]);
  CHECK(world.call("getNode", {{"node", "Shape#1"}})["type"] == "Shape");
  CHECK(world.call("getType", {{"node", box["node"]}}) == "Transform");
  bool has_translation = false;
  for (const Json& one : world.call("getInterface", {{"node", "Box"}}))
    has_translation =
        has_translation || one == Json{{"name", "translation"}, {"access", "exposedField"}, {"type", "SFVec3f"}};
  CHECK(has_translation);
  CHECK(world.problem("getNode", {{"node", "None"}}) ==
        "parameter 'node': unknown node 'None'; expected a DEF name or Type#number");
  CHECK(world.problem("getNode", {{"node", 17}}) ==
        "parameter 'node': unknown node number; expected a number from getNode");
  CHECK(world.problem("getNode", {{"node", true}}) == "parameter 'node': expected a node: its number, or its DEF name");
}

TEST_CASE("sends an eventIn, reads an exposedField, and follows ROUTEs (14772-2 setValue, getValue)") {
  World world(kBox + "DEF Other Transform {} ROUTE Box.translation TO Other.set_translation");
  const Json box = world.call("getNode", {{"node", "Box"}})["node"];
  world.call("setValue", {{"node", box}, {"event", "set_translation"}, {"value", {1, 2, 3}}});
  CHECK(world.call("getValue", {{"node", "Box"}, {"event", "translation"}}) == Json{1, 2, 3});
  CHECK(world.call("getValue", {{"node", "Other"}, {"event", "translation_changed"}}) == Json{1, 2, 3});
  world.call("setValue", Json::array({"Box", "translation", {4, 5, 6}}));
  CHECK(world.call("getValue", Json::array({"Other", "translation"})) == Json{4, 5, 6});
  CHECK(world.problem("setValue", {{"node", box}, {"event", "set_translation"}, {"value", {1, 2}}}) ==
        "Transform.translation is of SFVec3f: expected a list of 3 numbers");
  CHECK(world.problem("setValue", {{"node", box}, {"event", "none"}, {"value", 1}}) ==
        "Transform has no eventIn 'none'");
  CHECK(world.problem("getValue", {{"node", box}, {"event", "addChildren"}}) ==
        "parameter 'event': Transform has no eventOut 'addChildren'");
  CHECK(world.problem("getValue", {{"node", box}, {"event", "bboxSize"}}) ==
        "parameter 'event': Transform has no eventOut 'bboxSize'");
}

TEST_CASE("starts a TimeSensor that a client creates in a resting world in its own step") {
  World world(kBox);
  CHECK_FALSE(world.step(1).next_life);
  const Frame frame = world.say(
      R"({"jsonrpc":"2.0","id":1,"method":"createVrmlFromString","params":{"text":"DEF T TimeSensor { loop TRUE }"}})");
  CHECK(frame.next_life);
  world.call("advise", {{"node", "T"}, {"event", "fraction_changed"}});
  CHECK(world.step(0.1).next_life);
  CHECK_FALSE(world.told("event").empty());
}

TEST_CASE("reads the last value of an eventOut, and nodes as their numbers (14772-2 getValue)") {
  World world("DEF I ScalarInterpolator { key [ 0 1 ] keyValue [ 0 10 ] } DEF G Group { children " + kBox + "}");
  CHECK(world.call("getValue", {{"node", "I"}, {"event", "value_changed"}}) == 0);
  world.call("setValue", {{"node", "I"}, {"event", "set_fraction"}, {"value", 0.5}});
  CHECK(world.call("getValue", {{"node", "I"}, {"event", "value_changed"}}) == 5);
  const Json children = world.call("getValue", {{"node", "G"}, {"event", "children"}});
  REQUIRE(children.size() == 1);
  CHECK(world.call("getNode", {{"node", "Box"}})["node"] == children[0]);
}

TEST_CASE("sends time and value of a watched eventOut until the watch ends (14772-2 advise)") {
  World world("DEF T TimeSensor { cycleInterval 10 startTime 1000 }" + kBox);
  const Json watch = world.call("advise", {{"node", "T"}, {"event", "fraction_changed"}})["watch"];
  const Json other = world.call("advise", {{"node", "Box"}, {"event", "translation"}})["watch"];
  CHECK(watch != other);
  CHECK(world.told("event").empty());
  world.step(1);
  std::vector<Json> told = world.told("event");
  REQUIRE(told.size() == 1);
  CHECK(told[0] == Json{{"watch", watch}, {"time", 1001.0}, {"value", Json::parse("0.1")}});
  world.call("setValue", {{"node", "Box"}, {"event", "translation"}, {"value", {1, 0, 0}}});
  told = world.told("event");
  REQUIRE(told.size() == 1);
  CHECK(told[0]["watch"] == other);
  CHECK(told[0]["value"] == Json{1, 0, 0});
  CHECK(told[0]["time"].get<double>() == Approx(1001));
  world.call("unadvise", {{"watch", watch}});
  (void)world.told("event");  // drops earlier events
  world.step(1);
  CHECK(world.told("event").empty());
  CHECK(world.problem("unadvise", {{"watch", watch}}) == "unknown watch number");
}

TEST_CASE("sends the events that follow from a call before its answer") {
  World world(kBox);
  world.call("advise", {{"node", "Box"}, {"event", "translation"}});
  world.say(R"({"jsonrpc":"2.0","id":"x","method":"setValue","params":["Box","translation",[1,2,3]]})");
  const std::vector<Json> sent = world.take();
  REQUIRE(sent.size() == 2);
  CHECK(sent[0]["method"] == "event");
  CHECK(sent[1]["id"] == "x");
}

TEST_CASE("gives the events of a list one timestamp, and sends none if one is wrong (14772-2 beginUpdate)") {
  World world(kBox + "DEF A Transform {} DEF B Transform {}");
  for (const char* name : {"A", "B", "Box"}) world.call("advise", {{"node", name}, {"event", "translation"}});
  world.call("setValues", {{"events", {{"A", "translation", {1, 0, 0}}, {"B", "set_translation", {2, 0, 0}}}}});
  std::vector<Json> told = world.told("event");
  REQUIRE(told.size() == 2);
  CHECK(told[0]["time"] == told[1]["time"]);
  CHECK(told[0]["value"] == Json{1, 0, 0});
  CHECK(told[1]["value"] == Json{2, 0, 0});
  CHECK(world.problem("setValues", {{"events", {{"A", "translation", {9, 0, 0}}, {"B", "translation", {1, 2}}}}}) ==
        "parameter 'events': event 2: Transform.translation is of SFVec3f: expected a list of 3 numbers; no event was "
        "sent");
  CHECK(world.told("event").empty());
  CHECK(world.call("getValue", {{"node", "A"}, {"event", "translation"}}) == Json{1, 0, 0});
  for (const char* wrong : {"[1]", "[[]]", "[[\"A\"]]", "[[\"A\",\"translation\"]]",
                            "[[\"A\",\"translation\",[1,2,3],4]]", "[[\"A\",1,[1,2,3]]]"})
    CHECK(world.problem("setValues", {{"events", Json::parse(wrong)}}) ==
          "parameter 'events': event 1: expected [node, eventIn, value]; no event was sent");
}

TEST_CASE("holds events between beginUpdate and endUpdate, and gives them one timestamp (14772-2)") {
  World world(kBox + "DEF A Transform {} DEF B Transform {}");
  for (const char* name : {"A", "B"}) world.call("advise", {{"node", name}, {"event", "translation"}});
  world.call("beginUpdate");
  world.call("setValue", {{"node", "A"}, {"event", "translation"}, {"value", {1, 0, 0}}});
  world.call("setValues", Json::parse(R"({"events":[["B","translation",[2,0,0]]]})"));
  world.step(1);
  CHECK(world.told("event").empty());
  CHECK(world.call("getValue", {{"node", "A"}, {"event", "translation"}}) == Json{0, 0, 0});
  world.call("setValue", {{"node", "Box"}, {"event", "translation"}, {"value", {3, 0, 0}}}, 2);
  CHECK(world.call("getValue", {{"node", "Box"}, {"event", "translation"}}, 2) == Json{3, 0, 0});
  world.call("endUpdate");
  const std::vector<Json> told = world.told("event");
  REQUIRE(told.size() == 2);
  CHECK(told[0]["time"] == told[1]["time"]);
  world.call("setValue", {{"node", "A"}, {"event", "translation"}, {"value", {5, 0, 0}}});
  CHECK(world.told("event").size() == 1);
}

TEST_CASE("gives each update its own timestamp, so that eventOuts send each time (VRML97 4.10.4)") {
  World world(kBox + "DEF Other Transform {} ROUTE Box.translation TO Other.set_translation");
  world.call("advise", {{"node", "Other"}, {"event", "translation"}});
  std::string message;
  for (int i = 1; i <= 3; ++i)
    world.channel.news.push_back(
        {1, false, Json{{"method", "setValue"}, {"params", {"Box", "translation", {i, 0, 0}}}}.dump()});
  world.step(0);
  const std::vector<Json> told = world.told("event");
  REQUIRE(told.size() == 3);
  CHECK(told[0]["time"] < told[1]["time"]);
  CHECK(told[1]["time"] < told[2]["time"]);
  CHECK(told[2]["value"] == Json{3, 0, 0});
  // The world's clock continues from there.
  world.step(1);
  CHECK(world.call("getBrowser")["time"] == 1001.0);
}

TEST_CASE("creates nodes of a string, adds them to the world and removes them (14772-2 createVrmlFromString)") {
  World world("DEF G Group {}");
  const Json made = world.call("createVrmlFromString",
                               {{"text", "DEF New Transform { translation 1 2 3 } Shape { geometry Box {} }"}});
  REQUIRE(made["nodes"].size() == 2);
  CHECK(made["messages"].empty());
  world.call("setValue", {{"node", "G"}, {"event", "addChildren"}, {"value", made["nodes"]}});
  CHECK(world.call("getValue", {{"node", "G"}, {"event", "children"}}) == made["nodes"]);
  CHECK(world.call("getNode", {{"node", "New"}})["node"] == made["nodes"][0]);
  world.call("setValue", {{"node", "G"}, {"event", "removeChildren"}, {"value", Json::array({made["nodes"][0]})}});
  CHECK(world.call("getValue", {{"node", "G"}, {"event", "children"}}).size() == 1);
  const Json wrong = world.call("createVrmlFromString", {{"text", "Transform { translation oops } Group {}"}});
  REQUIRE_FALSE(wrong["messages"].empty());
  CHECK(wrong["messages"][0].get<std::string>().starts_with("control:1:25: error: "));
  CHECK(wrong["nodes"].size() == 2);
  const Json none = world.call("createVrmlFromString", {{"text", "VRML 1.0 is no more"}});
  CHECK(none["nodes"].empty());
  CHECK(none["messages"][0] == "control:1:1: error: expected a node, found 'VRML'");
}

TEST_CASE("runs a Script that a client creates (14772-2 createVrmlFromString, VRML97 4.12)") {
  World world("DEF G Group {} DEF Box Transform {}");
  const Json made = world.call(
      "createVrmlFromString",
      {{"text",
        "DEF S Script { eventIn SFFloat in_ eventOut SFVec3f out url \"javascript: function in_(v) { out = new "
        "SFVec3f(v, 2 * v, 0); }\" }"}});
  world.call("setValue", {{"node", "G"}, {"event", "children"}, {"value", made["nodes"]}});
  CHECK(world.call("addRoute",
                   {{"from", "S"}, {"eventOut", "out"}, {"to", "Box"}, {"eventIn", "set_translation"}})["changed"] ==
        true);
  world.call("setValue", {{"node", "S"}, {"event", "in_"}, {"value", 3}});
  CHECK(world.call("getValue", {{"node", "Box"}, {"event", "translation"}}) == Json{3, 6, 0});
}

TEST_CASE("adds and deletes ROUTEs (14772-2 addRoute, deleteRoute)") {
  World world(kBox + "DEF Other Transform {}");
  const Json route = {{"from", "Box"}, {"eventOut", "translation"}, {"to", "Other"}, {"eventIn", "translation"}};
  CHECK(world.call("addRoute", route)["changed"] == true);
  CHECK(world.call("addRoute", route)["changed"] == false);
  world.call("setValue", {{"node", "Box"}, {"event", "translation"}, {"value", {1, 0, 0}}});
  CHECK(world.call("getValue", {{"node", "Other"}, {"event", "translation"}}) == Json{1, 0, 0});
  CHECK(world.call("deleteRoute", route)["changed"] == true);
  CHECK(world.call("deleteRoute", route)["changed"] == false);
  world.call("setValue", {{"node", "Box"}, {"event", "translation"}, {"value", {2, 0, 0}}});
  CHECK(world.call("getValue", {{"node", "Other"}, {"event", "translation"}}) == Json{1, 0, 0});
  Json wrong = route;
  wrong["eventIn"] = "rotation";
  CHECK(world.problem("addRoute", wrong) == "'translation' and 'rotation' have different types");
  wrong["eventIn"] = "none";
  CHECK(world.problem("addRoute", wrong) == "no eventIn 'none'");
}

TEST_CASE("replaces a world, and keeps old nodes that a client holds (14772-2 replaceWorld)") {
  World world(kBox + "DEF Gone Transform {}");
  const Json box = world.call("getNode", {{"node", "Box"}})["node"];
  const Json made = world.call("createVrmlFromString", {{"text", "DEF New Group {}"}});
  world.call("replaceWorld", {{"nodes", made["nodes"]}});
  REQUIRE(world.scene().roots().size() == 1);
  CHECK(world.call("getNode", {{"node", "New"}})["type"] == "Group");
  CHECK_FALSE(world.problem("getNode", {{"node", "Gone"}}).empty());
  CHECK(world.call("getType", {{"node", box}}) == "Transform");
  world.call("setValue", {{"node", "New"}, {"event", "children"}, {"value", Json::array({box})}});
  CHECK(world.call("getValue", {{"node", "New"}, {"event", "children"}}) == Json::array({box}));
}

TEST_CASE("keeps nodes that only a client holds until it disposes of them or disconnects (14772-2)") {
  World world("DEF G Group {}");
  vrml::Execution& execution = world.document->runtime->execution();
  const Json made =
      world.call("createVrmlFromString", {{"text", "DEF One Transform {} DEF Two Transform {}"}})["nodes"];
  CHECK(execution.lifetime().remove_unheld() == 0);
  world.call("dispose", {{"node", made[0]}});
  CHECK(execution.lifetime().remove_unheld() == 1);
  CHECK(world.problem("getType", {{"node", made[0]}}) ==
        "parameter 'node': unknown node number; expected a number from getNode");
  CHECK(world.call("getType", {{"node", made[1]}}) == "Transform");
  world.leave();
  CHECK(execution.lifetime().remove_unheld() == 1);
}

TEST_CASE("ends the watch of a removed node, and rejects the number of a removed node") {
  World world("DEF G Group { children DEF Box Transform {} }");
  const Json made = world.call("createVrmlFromString", {{"text", "Transform {}"}})["nodes"][0];
  world.call("advise", {{"node", made}, {"event", "translation"}});
  world.call("dispose", {{"node", made}});
  CHECK(world.document->runtime->execution().lifetime().remove_unheld() == 1);
  world.call("createVrmlFromString", {{"text", "DEF Again Transform {}"}});
  world.call("setValue", {{"node", "Again"}, {"event", "translation"}, {"value", {1, 2, 3}}});
  CHECK(world.told("event").empty());
}

TEST_CASE("reports name, version, time, world and description of the browser (14772-2 getBrowser)") {
  World world("WorldInfo { title \"A title\" }");
  const Json browser = world.call("getBrowser");
  CHECK(browser["name"] == "GhostSpace");
  CHECK(browser["version"].get<std::string>().find('.') != std::string::npos);
  CHECK(browser["time"] == 1000.0);
  CHECK(world.call("getName") == "GhostSpace");
  CHECK(world.call("getVersion") == browser["version"]);
  CHECK(world.call("getWorldURL") == browser["url"]);
  CHECK(world.call("getCurrentSpeed") == 0);
  world.step(0.5);
  world.step(0.5);
  CHECK(world.call("getCurrentFrameRate") == 2);
  const Frame frame = world.say(R"({"method":"setDescription","params":["hello"]})");
  REQUIRE(frame.notices.size() == 1);
  CHECK(frame.notices[0].text == "hello");
}

TEST_CASE("lists and binds Viewpoints, and moves the viewer to any position") {
  World world(
      "DEF A Viewpoint { position 0 0 5 description \"First\" } DEF B Viewpoint { position 3 0 0 "
      "orientation 0 1 0 1.5707964 description \"Second\" }");
  Json viewpoints = world.call("getViewpoints");
  REQUIRE(viewpoints.size() == 2);
  CHECK(viewpoints[0] == Json{{"viewpoint", 1}, {"description", "First"}, {"name", "A"}, {"bound", true}});
  world.call("setViewpoint", {{"viewpoint", "Second"}});
  world.step(0.1);
  CHECK(world.call("getViewpoints")[1]["bound"] == true);
  const Json viewer = world.call("getViewer");
  CHECK(viewer["position"] == Json{3.0, 0.0, 0.0});
  CHECK(viewer["orientation"][3].get<double>() == Approx(1.5707964).margin(1e-6));
  world.call("setViewpoint", {{"viewpoint", 1}});
  CHECK(world.call("getViewer")["position"] == Json{0.0, 0.0, 5.0});
  world.call("setViewer", {{"position", {1, 2, 3}}, {"orientation", {0, 2, 0, 0.5}}});
  const Json placed = world.call("getViewer");
  CHECK(placed["position"] == Json{1.0, 2.0, 3.0});
  CHECK(placed["orientation"][1].get<double>() == Approx(1));
  CHECK(placed["orientation"][3].get<double>() == Approx(0.5).margin(1e-6));
  CHECK(world.problem("setViewpoint", {{"viewpoint", "None"}}).find("unknown Viewpoint 'None'") != std::string::npos);
  CHECK(world.problem("setViewpoint", {{"viewpoint", 3}}) ==
        "parameter 'viewpoint': expected a whole number from 1 to 2");
  CHECK(world.problem("setViewer", {{"orientation", {0, 0, 0, 1}}}) ==
        "parameter 'orientation': expected an axis and an angle in radians");
  CHECK(world.problem("setViewer", {{"position", {0, 0}}}) == "parameter 'position': expected a list of 3 numbers");
}

TEST_CASE("draws a picture from the viewer's position, after all earlier events") {
  World world(kBox);
  CHECK(world.problem("snapshot") == "this program cannot draw pictures");
  int painted = 0;
  world.control.set_painter(
      [&](const View& view, int width, int height) -> std::variant<std::vector<std::byte>, std::string> {
        ++painted;
        if (width > 100) return "no";
        CHECK(height == 20);
        REQUIRE(view.list->items.size() == 1);
        CHECK(view.list->bounds.center().x == 7);
        return std::vector<std::byte>{std::byte{'f'}, std::byte{'o'}, std::byte{'o'}};
      });
  world.call("setValue", {{"node", "Box"}, {"event", "translation"}, {"value", {7, 0, 0}}});
  CHECK(world.call("snapshot", {{"width", 10}, {"height", 20}}) ==
        Json{{"width", 10}, {"height", 20}, {"png", "Zm9v"}});
  CHECK(world.problem("snapshot") == "no");
  CHECK(world.problem("snapshot", {{"width", 4097}}) == "parameter 'width': expected a whole number from 1 to 4096");
  CHECK(painted == 2);
}

TEST_CASE("shows changes of a client in the same step, and lets time pass for their consequences") {
  World world(kBox);
  CHECK_FALSE(world.step(0.1).changed);
  CHECK(world.say(R"({"method":"setValue","params":["Box","translation",[1,0,0]]})").changed);
  CHECK(world.session.view()->list->bounds.center().x == 1);
  CHECK_FALSE(world.say(R"({"method":"getBrowser","id":1})").changed);
}

TEST_CASE("controls a session in each viewport, and drops the nodes of a closed world") {
  World world;
  world.say(R"({"jsonrpc":"2.0","id":5,"method":"awaitWorld"})");
  CHECK(world.take().empty());
  CHECK(world.problem("getNode", {{"node", "Box"}}) == "no world is open yet; awaitWorld answers when one is");
  CHECK(world.call("adviseBrowser")["initialized"] == false);
  world.open(kBox);
  world.step(0);
  std::vector<Json> sent = world.take();
  REQUIRE(sent.size() == 2);
  CHECK(sent[0]["method"] == "browser");
  CHECK(sent[0]["params"]["event"] == "initialized");
  CHECK(sent[1] == Json{{"jsonrpc", "2.0"}, {"id", 5}, {"result", Json::object()}});
  CHECK(world.call("awaitWorld") == Json::object());
  const Json box = world.call("getNode", {{"node", "Box"}})["node"];
  world.call("advise", {{"node", "Box"}, {"event", "translation"}});
  world.open("DEF Other Transform {}");  // the file has another world
  world.step(0);
  std::vector<std::string> events;
  for (const Json& one : world.told("browser")) events.push_back(one["event"]);
  CHECK(events == std::vector<std::string>{"shutdown", "initialized"});
  CHECK_FALSE(world.problem("getType", {{"node", box}}).empty());
  CHECK(world.call("getType", {{"node", "Other"}}) == "Transform");
  const Json viewports = world.call("getViewports");
  REQUIRE(viewports.size() == 1);
  CHECK(viewports[0]["active"] == true);
  CHECK(viewports[0]["used"] == true);
  CHECK(world.problem("useViewport", {{"viewport", 2}}) == "parameter 'viewport': expected a whole number from 1 to 1");
  CHECK_FALSE(world.control.wants_to_end());
  world.call("quit");
  CHECK(world.control.wants_to_end());
}

}  // namespace gs::app::control_test
