// Files that clients name: read in the name of the world's own, by the loader's rules.
#include "controlled.h"

#include "net/load/transport_memory.h"
#include "tests/app/late_worlds.h"

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

/// A session in real time that reads memory://a/world.wrl, and a client.
struct Site {
  Site() : control(channel, [] {}) { load.memory = std::make_shared<net::MemoryNetwork>(); }
  void open() {
    SessionOptions options;
    options.files = {"memory://a/world.wrl"};
    session = std::make_unique<Session>(options, load, [] {});
    session->add_guest(control);
  }
  ~Site() {
    if (session) session->remove_guest(control);
  }
  void say(const Json& call) { channel.news.push_back({1, false, call.dump()}); }
  /// Steps until the client is sent something of which `wanted` is true; null: that never came.
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

TEST_CASE("loadURL goes to another world, whose coming is told, and opens no page (14772-2)") {
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

}  // namespace gs::app::control_files_test
