#include "app/control/services.h"
#include "controlled.h"

#include <fstream>
#include <iterator>
#include <string>
#include <vector>

// Tests of wrong calls, and of slow and endless clients.
namespace gs::app::control_hostile_test {
namespace {

using controlled::Json;
using controlled::World;

const std::string kBox = "DEF Box Transform { children Shape { geometry Box {} } } ";

/// Returns the only answer to a message.
Json only(World& world, const std::string& message) {
  world.say(message);
  const std::vector<Json> sent = world.take();
  INFO(message);
  REQUIRE(sent.size() == 1);
  return sent[0];
}

int code_of(World& world, const std::string& message) { return only(world, message)["error"]["code"]; }

}  // namespace

TEST_CASE("answers invalid calls with the errors of JSON-RPC 2.0") {
  World world(kBox);
  CHECK(code_of(world, "hello") == -32700);
  CHECK(only(world, "{\"id\":1,")["error"]["message"] == "not JSON: expected the name of a member (byte 9)");
  CHECK(only(world, "hello")["id"].is_null());
  CHECK(code_of(world, std::string(100'000, '[')) == -32700);
  CHECK(code_of(world, "7") == -32600);
  CHECK(code_of(world, "[]") == -32600);
  CHECK(code_of(world, "{}") == -32600);
  CHECK(code_of(world, R"({"id":1,"method":7})") == -32600);
  CHECK(code_of(world, R"({"id":1,"method":"getName","params":7})") == -32600);
  CHECK(code_of(world, R"({"id":1,"method":"getName","jsonrpc":"1.0"})") == -32600);
  CHECK(code_of(world, R"({"id":{},"method":"getName"})") == -32600);
  CHECK(only(world, R"({"id":")" + std::string(300, 'a') + R"(","method":"getName"})")["id"].is_null());
  const Json unknown = only(world, R"({"id":"a","method":"noSuch"})");
  CHECK(unknown["id"] == "a");
  CHECK(unknown["error"] == Json{{"code", -32601}, {"message", "unknown service 'noSuch'; see getServices"}});
}

TEST_CASE("names missing, unknown and surplus parameters") {
  World world(kBox);
  CHECK(world.problem("getNode") == "expected parameter 'node': DEF name, or `Type#number` as in `trace`");
  CHECK(world.problem("getNode", {{"nod", "Box"}}) == "unknown parameter 'nod'");
  CHECK(world.problem("getNode", Json::array({"Box", 1})) == "expected at most 1 parameters");
  CHECK(world.problem("getName", {{"x", 1}}) == "unknown parameter 'x'");
  CHECK(world.problem("setDescription", {{"text", 1}}) == "parameter 'text': expected a string");
  CHECK(world.problem("loadURL", {{"url", Json::array({1})}}) == "parameter 'url': expected strings");
  CHECK(world.problem("replaceWorld", {{"nodes", "Box"}}) == "parameter 'nodes': expected a list of nodes");
  CHECK(world.problem("createVrmlFromURL", {{"url", "a.wrl"}, {"node", "Box"}, {"event", "translation"}}) ==
        "parameter 'event': the node has no eventIn of type MFNode with this name");
  CHECK(world.problem("unadvise", {{"watch", -1}}) ==
        "parameter 'watch': expected a whole number from 1 to 2147483647");
}

TEST_CASE("rejects parameters of every wrong type in every service, without a crash") {
  World world(kBox);
  const Json kinds[] = {nullptr,       true, -1, 1e300, "", "Box", Json::array(), Json::array({1, "x", nullptr}),
                        Json::object()};
  for (const ServiceRow* const row : all_services()) {
    if (row->name == "quit") continue;
    for (const Json& one : kinds) {
      Json parameters = Json::object();
      for (std::size_t i = 0; i < parameter_count(*row); ++i) parameters[std::string(row->parameters[i].name)] = one;
      const Json got = world.answer(std::string(row->name), parameters);
      INFO(row->name << ' ' << parameters.dump());
      REQUIRE(got.contains("result") != got.contains("error"));
      if (got.contains("error")) CHECK_FALSE(got["error"]["message"].get<std::string>().empty());
    }
  }
  CHECK_FALSE(world.control.wants_to_end());
}

TEST_CASE("answers a list of calls by a list, and notifications only if they fail") {
  World world(kBox);
  const Json answers = only(world, R"([{"id":1,"method":"getName"},{"method":"getName"},7,{"id":2,"method":"none"}])");
  REQUIRE(answers.size() == 3);
  CHECK(answers[0]["result"] == "GhostSpace");
  CHECK(answers[1]["error"]["code"] == -32600);
  CHECK(answers[2]["id"] == 2);
  world.say(R"([{"method":"getName"}])");
  CHECK(world.take().empty());
  const Json problem = only(world, R"({"method":"getNode","params":["None"]})");
  CHECK(problem["method"] == "problem");
  CHECK(problem["params"]["method"] == "getNode");
  world.channel.behind.insert(1);
  world.say(R"({"method":"getNode","params":["None"]})");
  CHECK(world.take().empty());
}

TEST_CASE("sends a slow client the last value of each eventOut, and the number that it missed") {
  World world(kBox + "DEF A Transform {}");
  world.call("advise", {{"node", "Box"}, {"event", "translation"}});
  world.call("advise", {{"node", "A"}, {"event", "translation"}});
  world.call("advise", {{"node", "Box"}, {"event", "translation"}}, 2);
  world.channel.behind.insert(1);
  for (int i = 1; i <= 100; ++i)
    world.call("setValue", {{"node", "Box"}, {"event", "translation"}, {"value", {i, 0, 0}}}, 2);
  CHECK(world.told("event", 1).empty());
  CHECK(world.told("event", 2).size() == 100);
  world.channel.behind.clear();
  world.step(0);
  const std::vector<Json> told = world.told("event", 1);
  REQUIRE(told.size() == 1);
  CHECK(told[0]["value"] == Json{100, 0, 0});
  CHECK(told[0]["missed"] == 99);
  world.call("setValue", {{"node", "Box"}, {"event", "translation"}, {"value", {0, 0, 1}}}, 2);
  CHECK_FALSE(world.told("event", 1).at(0).contains("missed"));
}

TEST_CASE("sends the last value of each eventOut if a step has too many events to queue") {
  // Forty clients watch a thousand eventOuts.
  std::string body = "DEF T TimeSensor { startTime 1000 cycleInterval 10 } ";
  for (int i = 0; i < 1000; ++i) {
    const std::string n = std::to_string(i);
    body += "DEF I" + n + " ScalarInterpolator { key [ 0 1 ] keyValue [ 0 1 ] } ROUTE T.fraction_changed TO I" + n +
            ".set_fraction ";
  }
  World world(body);
  Json calls = Json::array();
  for (int i = 0; i < 1000; ++i)
    calls.push_back({{"method", "advise"}, {"params", {"I" + std::to_string(i), "value_changed"}}});
  for (std::uint64_t client = 1; client <= 40; ++client) world.say(calls.dump(), client);
  world.step(1);
  std::size_t told = 0;
  for (std::uint64_t client = 1; client <= 40; ++client) told += world.told("event", client).size();
  CHECK(told == 40'000);
}

TEST_CASE("postpones messages of a client that never stops to the next step") {
  World world(kBox, std::chrono::seconds(0));
  for (int i = 0; i < 20; ++i)
    world.channel.news.push_back(
        {1, false, Json{{"method", "setValue"}, {"params", {"Box", "translation", {i, 0, 0}}}}.dump()});
  for (std::size_t left = 20; left > 0; --left) {
    CHECK(world.channel.news.size() == left);
    world.step(0);
    CHECK(world.wakes == static_cast<int>(21 - left));
  }
  world.step(0);
  CHECK(world.wakes == 20);
  CHECK(world.call("getValue", {{"node", "Box"}, {"event", "translation"}}) == Json{19, 0, 0});
}

TEST_CASE("refuses an endless update before it fills memory") {
  World world("DEF I CoordinateInterpolator {}");
  world.call("beginUpdate");
  std::string message = R"({"id":1,"method":"setValue","params":["I","keyValue",[0)";
  for (int i = 1; i < 900'000; ++i) message += ",0";
  message += "]]}";
  bool refused = false;
  for (int i = 0; i < 100 && !refused; ++i) refused = only(world, message).contains("error");
  CHECK(refused);
}

TEST_CASE("cleans up after a client that disconnects at any time") {
  World world("DEF T TimeSensor { loop TRUE }" + kBox);
  world.call("advise", {{"node", "T"}, {"event", "time"}});
  world.call("beginUpdate");
  world.call("setValue", {{"node", "Box"}, {"event", "translation"}, {"value", {1, 0, 0}}});
  world.step(0.1);
  world.leave();
  world.take();
  world.step(0.1);
  CHECK(world.take().empty());
  CHECK(world.call("getValue", {{"node", "Box"}, {"event", "translation"}}, 2) == Json{0, 0, 0});
  world.leave(77);  // an unknown client
}

TEST_CASE("lists in docs/control.md the services of the program") {
  std::ifstream file(GHOSTSPACE_TESTS "/../docs/control.md");
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  INFO(services_as_markdown());
  CHECK(text.find(services_as_markdown()) != std::string::npos);
  World world;
  const Json services = world.call("getServices");
  CHECK(services.size() == all_services().size());
  CHECK(services[0]["name"] == "getBrowser");
}

}  // namespace gs::app::control_hostile_test
