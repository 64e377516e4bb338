#include "app/session/live/live_control.h"

#include "net/control/control_token.h"
#include "net/serve/http_server.h"
#include "tests/app/interface/driver.h"
#include "tests/app/scratch_folder.h"

#include <catch2/catch.hpp>

#include <atomic>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace gs::app::live_control_test {
namespace {

using driver::Driver;

constexpr const char* kLiveJson =
    R"({"version":1,"title":"run","field":"vapour","fields":["vapour","heat"],"parameters":[)"
    R"({"name":"feed","label":"Feed rate","unit":"1/s","minimum":0,"maximum":0.1,"value":0.03,"integer":false}]})";

/// Server of a simulation without a simulation.
struct FakeSimulation {
  FakeSimulation() {
    net::HttpServerOptions options;
    options.folder = folder.path("");
    options.list = [this](const net::FolderListing&, const net::FolderRequest&) {
      return net::FolderPage{"model/vrml",
                             "#VRML V2.0 utf8\nWorldInfo { title \"run, step " + std::to_string(step) +
                                 "\" info [ \"live data: insitu.json\" ] }\nShape { geometry Box { } }\n"};
    };
    options.missing = [](const std::string& name, const net::FolderRequest&) -> std::optional<net::FolderPage> {
      if (name != "insitu.json") return std::nullopt;
      return net::FolderPage{"application/json", kLiveJson};
    };
    options.post = [this](const net::PostRequest& request) {
      const std::lock_guard lock(mutex);
      posts.push_back(request.path + "?" + request.query + " " + request.authorization);
      return net::PostAnswer{200, "ok"};
    };
    auto started = net::HttpServer::start(std::move(options));
    REQUIRE(std::holds_alternative<std::unique_ptr<net::HttpServer>>(started));
    server = std::move(std::get<std::unique_ptr<net::HttpServer>>(started));
  }
  [[nodiscard]] std::string url() const { return "http://127.0.0.1:" + std::to_string(server->port()) + "/"; }
  [[nodiscard]] std::vector<std::string> received() {
    const std::lock_guard lock(mutex);
    return posts;
  }

  ScratchFolder folder;
  std::atomic<int> step{0};
  std::mutex mutex;
  std::vector<std::string> posts;
  std::unique_ptr<net::HttpServer> server;
};

/// Sets XDG_RUNTIME_DIR while it exists.
struct LiveEnvironment {
  explicit LiveEnvironment(const std::string& folder) {
    if (const char* value = std::getenv(kName)) before = value;
    (void)::setenv(kName, folder.c_str(), 1);
  }
  ~LiveEnvironment() { (void)(before ? ::setenv(kName, before->c_str(), 1) : ::unsetenv(kName)); }

  static constexpr const char* kName = "XDG_RUNTIME_DIR";
  std::optional<std::string> before;
};

}  // namespace

TEST_CASE("live data: the JSON of a simulation is read, and wrong entries are left out") {
  const auto state = read_live_state(kLiveJson);
  REQUIRE(state);
  CHECK(state->fields == std::vector<std::string>{"vapour", "heat"});
  REQUIRE(state->parameters.size() == 1);
  CHECK(state->parameters[0].label == "Feed rate");
  CHECK(state->parameters[0].maximum == 0.1);
  for (const char* text : {"", "[]", "{", "{\"a\":1}", "3", "\"version\""}) CHECK_FALSE(read_live_state(text));
  const auto odd = read_live_state(
      R"({"version":1,"fields":[1,null],"field":7,"parameters":[1,{"name":"a"},{"name":"b","minimum":2,"maximum":1,)"
      R"("value":1},{"name":"c","minimum":0,"maximum":"x","value":1},{"name":"d","minimum":0,"maximum":1,"value":1}]})");
  REQUIRE(odd);
  CHECK(odd->fields.empty());
  REQUIRE(odd->parameters.size() == 1);
  CHECK(odd->parameters[0].label == "d");
  std::string many = R"({"version":1,"parameters":[)";
  for (int i = 0; i < 1000; ++i)
    many +=
        std::string(i ? "," : "") + R"({"name":")" + std::string(500, 'a') + R"(","minimum":0,"maximum":1,"value":0})";
  const auto bounded = read_live_state(many + "]}");
  REQUIRE(bounded);
  CHECK(bounded->parameters.size() == 64);
  CHECK(bounded->parameters[0].name.size() == 100);
}

TEST_CASE("live data: simulations understand the values that are sent") {
  CHECK(parameter_query("feed", 0.05) == "feed=0.05");
  CHECK(parameter_query("steps", 100'000) == "steps=1e%2B05");
  CHECK(parameter_query("a b", -2) == "a%20b=-2");
}

TEST_CASE("live data: the token comes from the user's file for the port, for this machine only") {
  const ScratchFolder folder;
  const LiveEnvironment environment(folder.path(""));
  const std::string token(32, 'a');
  (void)folder.write("ghostspace/insitu-8123.token", token + "\n");
  (void)folder.write("ghostspace/insitu-8124.token", "root:x:0:0:root:/root:/bin/bash:x\n");
  CHECK(token_of_simulation("http://127.0.0.1:8123/insitu.json") == token);
  CHECK(token_of_simulation("http://localhost:8123/") == token);
  CHECK(token_of_simulation("http://example.org:8123/").empty());
  CHECK(token_of_simulation("http://127.0.0.1.example.org:8123/").empty());
  CHECK(token_of_simulation("http://127.0.0.1:8124/").empty());
  CHECK(token_of_simulation("http://127.0.0.1:8125/").empty());
}

TEST_CASE("live data: a world of a simulation is followed, and the Data panel changes its parameters") {
  FakeSimulation simulation;
  const ScratchFolder folder;
  const LiveEnvironment environment(folder.path(""));
  const std::string token(32, 'b');
  (void)folder.write("ghostspace/insitu-" + std::to_string(simulation.server->port()) + ".token", token + "\n");
  Driver user({}, {1100, 760});
  Session& session = user.session();
  session.opening().open_files({simulation.url()});
  REQUIRE(user.wait_for([&] { return session.view() && session.view()->document->world.title == "run, step 0"; }));
  CHECK(session.view()->document->world.live == "insitu.json");
  REQUIRE(user.wait_for([&] { return session.live().state() != nullptr; }));
  CHECK(session.live().state()->url == simulation.url() + "insitu.json");
  user.press(letter_key('D'), true, true);
  user.settle();
  INFO(user.screen());
  CHECK(user.sees("Simulation"));
  CHECK(user.sees("Feed rate"));
  user.click("vapour");
  user.settle();
  user.click("heat");
  REQUIRE(user.wait_for([&] { return !simulation.received().empty(); }));
  CHECK(simulation.received().front() == "/parameters?field=heat Bearer " + token);
  session.live().change("feed=0.05", "other");
  REQUIRE(user.wait_for([&] { return simulation.received().size() == 2; }));
  CHECK(simulation.received().back() == "/parameters?feed=0.05 Bearer other");
  simulation.step = 1;
  REQUIRE(user.wait_for([&] { return session.view()->document->world.title == "run, step 1"; }));
}

}  // namespace gs::app::live_control_test
