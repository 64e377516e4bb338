// Tests of files that clients name, read on behalf of the world's file by the loader's rules.
#include "controlled.h"

#include "tests/app/late_worlds.h"
#include "tests/app/scratch_folder.h"
#include "tests/net/memory_network.h"

#include <chrono>
#include <span>
#include <string>
#include <thread>

namespace gs::app::control_files_test {
namespace {

using controlled::Channel;
using controlled::Json;

const std::string kHeader = "#VRML V2.0 utf8\n";

using late_worlds::put;

/// Session in real time that reads memory://a/world.wrl, with a client.
struct Site {
  Site() : control(channel, [] {}) { load.memory = net::MakeMemoryTransport{}; }
  void open(const std::string& file = "memory://a/world.wrl") {
    SessionOptions options;
    options.files = {file};
    session = std::make_unique<Session>(options, load, [] {});
    session->add_extension(control);
  }
  ~Site() {
    if (session) session->remove_extension(control);
  }
  void say(const Json& call) { channel.news.push_back({1, false, call.dump()}); }
  /// Advances the session until the client receives a message that satisfies `wanted`. Returns null if there is none.
  template <class Wanted>
  Json until(const Wanted& wanted) {
    SessionInput input;
    input.area = Viewport{0, 0, 64, 64};
    for (int i = 0; i < 5000; ++i) {
      now += 1.0 / 60;
      const Frame frame = session->step(now, input);
      web_pages += frame.web_pages.size();
      for (Json& one : std::exchange(channel.sent[1], {}))
        if (wanted(one)) return one;
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    return nullptr;
  }

  LoadOptions load;
  Channel channel;
  Control control;
  std::unique_ptr<Session> session;
  double now = 1000;
  std::size_t web_pages = 0;
};

}  // namespace

TEST_CASE("createVrmlFromURL sends the nodes of a file to an eventIn, in a world without Scripts (14772-2)") {
  Site site;
  put(site.load, "world.wrl", kHeader + "DEF G Group {}");
  put(site.load, "sub/part.wrl", kHeader + "DEF P Transform {} Shape {}");
  site.open();
  site.say({{"id", 1}, {"method", "awaitWorld"}});
  REQUIRE(site.until([](const Json& one) { return one.value("id", 0) == 1; }).contains("result"));
  site.say({{"id", 2}, {"method", "advise"}, {"params", {"G", "children"}}});
  site.say({{"method", "createVrmlFromURL"},
            {"params", Json::array({Json::array({"none.wrl", "sub/part.wrl"}), "G", "set_children"})}});
  const Json event = site.until([](const Json& one) { return one.value("method", "") == "event"; });
  REQUIRE(event.is_object());
  CHECK(event["params"]["value"].size() == 2);
  site.say({{"id", 3}, {"method", "getNode"}, {"params", Json::array({"P"})}});
  CHECK(site.until([](const Json& one) { return one.value("id", 0) == 3; })["result"]["type"] == "Transform");
}

TEST_CASE("loadURL changes the world and reports its arrival, and opens no page (14772-2)") {
  Site site;
  put(site.load, "world.wrl", kHeader + "DEF Old Group {}");
  put(site.load, "next.wrl", kHeader + "DEF New Transform {}");
  site.open();
  site.say({{"id", 1}, {"method", "awaitWorld"}});
  site.say({{"method", "adviseBrowser"}});
  REQUIRE(site.until([](const Json& one) { return one.value("id", 0) == 1; }).contains("result"));
  site.say({{"method", "loadURL"}, {"params", Json::array({"http://127.0.0.1:9/page.html"})}});
  site.say({{"method", "loadURL"}, {"params", Json::array({"next.wrl"})}});
  const Json came = site.until([](const Json& one) {
    return one.value("method", "") == "browser" && one["params"]["event"] == "initialized" &&
           one["params"]["url"].get<std::string>().ends_with("next.wrl");
  });
  REQUIRE(came.is_object());
  CHECK(site.web_pages == 0);
  site.say({{"id", 2}, {"method", "getNode"}, {"params", Json::array({"New"})}});
  CHECK(site.until([](const Json& one) { return one.value("id", 0) == 2; })["result"]["type"] == "Transform");
}

TEST_CASE("loadURL of a client opens no file outside the world's folder without --allow") {
  const ScratchFolder folder;
  folder.write("world/world.wrl", kHeader + "DEF Old Group {}");
  folder.write("world/sub/next.wrl", kHeader + "DEF New Transform {}");
  folder.write("secret.wrl", kHeader + "DEF Secret Switch {}");
  const std::string secret = folder.path("secret.wrl");
  const auto ended = [](int id) { return [id](const Json& one) { return one.value("id", 0) == id; }; };
  // A client may also use its own Script.
  const std::string script =
      "Script { url \"javascript: function initialize() { Browser.loadURL(new MFString('" + secret + "')); }\" }";
  const auto add_script = [&](Site& site) {
    site.say({{"id", 3}, {"method", "createVrmlFromString"}, {"params", Json::array({script})}});
    const Json made = site.until(ended(3));
    REQUIRE(made.contains("result"));
    site.say(
        {{"id", 4}, {"method", "setValue"}, {"params", Json::array({"Old", "children", made["result"]["nodes"]})}});
    REQUIRE(site.until(ended(4)).contains("result"));
  };
  for (const bool allowed : {false, true}) {
    Site site;
    if (allowed) site.load.allowed.push_back(folder.path(""));
    site.open(folder.path("world/world.wrl"));
    site.say({{"id", 1}, {"method", "awaitWorld"}});
    site.say({{"method", "adviseBrowser"}});
    REQUIRE(site.until(ended(1)).contains("result"));
    const auto came = [](const std::string& name) {
      return [name](const Json& one) {
        return one.value("method", "") == "browser" && one["params"]["event"] == "initialized" &&
               one["params"]["url"].get<std::string>().ends_with(name);
      };
    };
    if (allowed) {
      add_script(site);
      REQUIRE(site.until(came("secret.wrl")).is_object());
      site.say({{"id", 2}, {"method", "loadURL"}, {"params", Json::array({"world/world.wrl"})}});
      REQUIRE(site.until(came("world.wrl")).is_object());
      continue;
    }
    for (const std::string& url : {std::string("../secret.wrl"), "file://" + secret, "file:" + secret, secret,
                                   std::string("sub/../../secret.wrl#V"), "file:file://" + secret,
                                   "file://" + secret + "%23", "FILE://" + secret, std::string("file:///etc/passwd")}) {
      INFO(url);
      site.say({{"id", 2}, {"method", "loadURL"}, {"params", Json::array({url})}});
      const Json answer = site.until(ended(2));
      REQUIRE(answer.contains("error"));
      const std::string why = answer["error"]["message"];
      CHECK((why.find("it lies outside of the world's folder; --allow ") != std::string::npos ||
             why.find("no such file") != std::string::npos));
    }
    add_script(site);
    // The session opens the first permitted URL.
    site.say({{"method", "loadURL"}, {"params", Json::array({Json::array({"../secret.wrl", "sub/next.wrl"})})}});
    const Json next = site.until([](const Json& one) {
      return one.value("method", "") == "browser" && one["params"]["event"] == "initialized";
    });
    REQUIRE(next.is_object());
    CHECK(next["params"]["url"].get<std::string>().ends_with("sub/next.wrl"));
  }
}

}  // namespace gs::app::control_files_test
