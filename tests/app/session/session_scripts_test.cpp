#include "app/loading/world_loader.h"
#include "app/loading/world_loading.h"
#include "app/session/session.h"
#include "app/simulation/simulation.h"
#include "base/gzip.h"
#include "tests/app/late_worlds.h"
#include "tests/net/memory_network.h"

#include <catch2/catch.hpp>

#include <chrono>
#include <memory>
#include <span>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace gs::app::session_scripts_test {
namespace {

const std::string kHeader = "#VRML V2.0 utf8\n";

using late_worlds::put;

std::string packed(const std::string& text) {
  const std::vector<std::byte> bytes = gzip(std::as_bytes(std::span(text)));
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// Returns the lines that programs of memory://a/world.wrl print in simulated time.
std::vector<std::string> run(const LoadOptions& options, double seconds = 1) {
  WorldLoading loading("memory://a/world.wrl", options);
  LoadedWorld world = load_world(loading, "memory://a/world.wrl");
  for (const Diagnostic& one : world.diagnostics.entries()) UNSCOPED_INFO(one.text());
  REQUIRE(world.scene);
  Simulation simulation(std::move(world), {64, 64});
  simulation.fetch_with(loading);
  std::vector<std::string> printed;
  simulation.observe_scripts([&](const ScriptMessage& message) {
    printed.push_back(message.printed ? message.diagnostic.message : message.diagnostic.text());
  });
  simulation.run(seconds);
  return printed;
}

LoadOptions site() {
  LoadOptions options;
  options.memory = net::MakeMemoryTransport{};
  return options;
}

}  // namespace

TEST_CASE("loads a program's file, compressed or not, before the first event (4.12.1)") {
  LoadOptions options = site();
  put(options, "world.wrl",
      kHeader +
          "DEF C TimeSensor { loop TRUE cycleInterval 5 } DEF S Script { eventIn SFTime t url [ \"none.js\" \"a.js\" "
          "\"javascript: print('held');\" ] } ROUTE C.cycleTime TO S.t Inline { url \"part.wrl\" }");
  put(options, "a.js", packed("function initialize() { print('a'); } function t() { print('t'); }"));
  put(options, "part.wrl", kHeader + "Script { url \"b.js\" }");
  put(options, "b.js", "print('b');");
  CHECK(run(options) == std::vector<std::string>{"a", "b", "t"});
}

TEST_CASE("createVrmlFromURL reads a file on behalf of the Script's file, and runs its Scripts (4.12.10)") {
  LoadOptions options = site();
  put(options, "world.wrl",
      kHeader +
          "DEF G Group {} DEF S Script { directOutput TRUE field SFNode g USE G field SFNode me USE S eventIn MFNode "
          "loaded url \"javascript: function initialize() { Browser.createVrmlFromURL(new MFString('none.wrl', "
          "'sub/part.wrl'), me, 'loaded'); } function loaded(n) { print(n.length); g.children = n; }\" }");
  put(options, "sub/part.wrl", kHeader + "Shape {} Script { url \"javascript: print('inside');\" }");
  CHECK(run(options) == std::vector<std::string>{"2", "inside"});
}

TEST_CASE("fills the scene that createX3DFromURL returns without a node when the file is loaded (X3D 19777-1)") {
  LoadOptions options = site();
  put(options, "world.wrl",
      "#X3D V3.3 utf8\nPROFILE Immersive\nDEF C TimeSensor { loop TRUE cycleInterval 0.2 } DEF G Group { } "
      "DEF S Script { directOutput TRUE inputOnly SFTime t initializeOnly SFNode g USE G url \"ecmascript: var s, done; "
      "function initialize() { s = Browser.createX3DFromURL(new MFString('part.x3dv')); print(s.rootNodes.length); } "
      "function t() { if (done || s.rootNodes.length == 0) return; done = true; g.children = s.rootNodes; "
      "print(s.rootNodes[0].getNodeTypeName() + ' ' + g.children.length + ' ' + s.getNamedNode('B').radius); }\" } "
      "ROUTE C.cycleTime TO S.t");
  put(options, "part.x3dv",
      "#X3D V3.3 utf8\nPROFILE Immersive\nShape { geometry DEF B Sphere { radius 3 } } Script { url \"ecmascript: "
      "print('inside');\" }");
  CHECK(run(options, 2) == std::vector<std::string>{"0", "inside", "Shape 2 3"});
}

TEST_CASE("logs printed text of programs, shows descriptions, and opens no pages by itself") {
  LoadOptions options = site();
  put(options, "world.wrl",
      kHeader +
          "DEF V Viewpoint { description \"there\" position 0 0 3 } Shape { geometry Box {} } Script { url "
          "\"javascript: function initialize() { print('hello'); Browser.setDescription('text'); Browser.loadURL("
          "'http://127.0.0.1:9/page.html'); }\" }");
  SessionOptions session_options;
  session_options.files = {"memory://a/world.wrl"};
  Session session(session_options, options, [] {});
  SessionInput input;
  input.area = Viewport{0, 0, 64, 64};
  std::vector<std::string> told;
  bool has_printed = false, opened = false;
  for (int i = 0; i < 500 && told.size() < 2; ++i) {
    const Frame frame = session.step(1000 + i / 60.0, input);
    for (const Notice& notice : frame.notices) told.push_back(notice.text);
    opened = opened || !frame.web_pages.empty();
    if (const View* seen = session.view())
      for (const Diagnostic& one : seen->document->world.diagnostics.entries())
        has_printed = has_printed || (one.file == "print" && one.message == "hello");
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  CHECK(has_printed);
  CHECK_FALSE(opened);
  CHECK(told == std::vector<std::string>{"text", "http://127.0.0.1:9/page.html: not opened without a recent click"});
}

}  // namespace gs::app::session_scripts_test
