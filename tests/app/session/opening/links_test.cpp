#include "app/session/opening/links.h"

#include "tests/app/worlds.h"

#include <catch2/catch.hpp>

#include <memory>
#include <string>

namespace gs::app::links_test {
namespace {

Link link(const std::string& file, const std::string& fields) {
  vrml::SceneGraph scene(file);
  Diagnostics diagnostics;
  (void)vrml::parse("#VRML V2.0 utf8\nAnchor { " + fields + " }", scene, diagnostics);
  REQUIRE(diagnostics.errors() == 0);
  return link_of(scene, scene.roots()[0]);
}

}  // namespace

TEST_CASE("follows an Anchor to a file beside the world, or to a Viewpoint of its world (VRML97 6.2)") {
  const Link one = link("/worlds/a/town.wrl", "url [ \"../b/house.wrl#Door\" \"#Gate\" \"town.wrl#Gate\" ]");
  REQUIRE(one.places.size() == 3);
  CHECK(one.places[0].target == "/worlds/b/house.wrl");
  CHECK(one.places[0].viewpoint == "Door");
  CHECK(one.places[0].problem.empty());
  CHECK(one.places[1].target.empty());
  CHECK(one.places[1].viewpoint == "Gate");
  CHECK(one.places[2].target.empty());
  CHECK_FALSE(one.other_window);
  CHECK(link("/worlds/a/town.wrl", "url \"\"").places.empty());
}

TEST_CASE("restricts an Anchor from the network to the network") {
  const Link one = link("http://host/a/town.wrl", "url [ \"house.wrl\" \"file:///etc/passwd\" \"#Gate\" ]");
  REQUIRE(one.places.size() == 3);
  CHECK(one.places[0].target == "http://host/a/house.wrl");
  CHECK(one.places[0].problem.empty());
  CHECK(one.places[1].problem.find("Not opened") != std::string::npos);
  CHECK(one.places[2].target.empty());
}

TEST_CASE("opens ssh: links only within the folder of a world of that account") {
  const std::string urls = "url [ \"ssh://host/run/b.wrl\" \"ssh://host/other/b.wrl\" \"ssh://else/run/b.wrl\" ]";
  for (const char* from : {"http://host/run/a.wrl", "/run/a.wrl", "ssh://third/run/a.wrl"})
    for (const Link::Place& place : link(from, urls).places)
      CHECK(place.problem.find("Not opened: ssh://") != std::string::npos);
  const Link own = link("ssh://host/run/a.wrl", urls);
  REQUIRE(own.places.size() == 3);
  CHECK(own.places[0].problem.empty());
  CHECK(own.places[1].problem.find("outside of the world's folder") != std::string::npos);
  CHECK_FALSE(own.places[2].problem.empty());
  const Link relative = link("ssh://ann@host/run/a.wrl", "url \"sub/b.wrl#Gate\"");
  REQUIRE(relative.places.size() == 1);
  CHECK(relative.places[0].target == "ssh://ann@host/run/sub/b.wrl");
  CHECK(relative.places[0].problem.empty());
}

TEST_CASE("passes pages to the web browser, and reports unknown types") {
  const Link one = link("/a/town.wrl",
                        "url [ \"http://host/page.html\" \"https://host/\" \"http://host/world.wrl.gz\" "
                        "\"http://host/scan.QNV\" \"mailto:a@host\" \"javascript:alert(1)\" ]");
  REQUIRE(one.places.size() == 6);
  CHECK(one.places[0].for_browser);
  CHECK(one.places[1].for_browser);
  CHECK_FALSE(one.places[2].for_browser);
  CHECK_FALSE(one.places[3].for_browser);
  CHECK(one.places[4].for_browser);
  CHECK(one.places[5].problem.find("javascript:") != std::string::npos);
  CHECK_FALSE(open_in_browser("javascript:alert(1)"));
  CHECK_FALSE(open_in_browser("--help"));
}

TEST_CASE("opens a link with a target in another window") {
  CHECK(link("/a.wrl", "url \"b.wrl\" parameter [ \"target=_blank\" ]").other_window);
  CHECK(link("/a.wrl", "url \"b.wrl\" parameter [ \"x\" \"target=right\" ]").other_window);
  CHECK_FALSE(link("/a.wrl", "url \"b.wrl\" parameter [ \"target=_self\" ]").other_window);
}

}  // namespace gs::app::links_test
