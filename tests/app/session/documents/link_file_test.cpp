#include "app/session/documents/link_file.h"

#include "app/session/opening/links.h"
#include "app/session/session.h"
#include "tests/app/scratch_folder.h"

#include <catch2/catch.hpp>

#include <map>

namespace gs::app::link_file_test {

SceneLink good(const std::string& text) {
  auto read = read_link_file(text);
  INFO(text);
  REQUIRE(std::holds_alternative<SceneLink>(read));
  return std::get<SceneLink>(read);
}

// Returns the URL of a link with its Viewpoint as fragment.
std::string place_of(const SceneLink& link) {
  return link.viewpoint.empty() ? link.url : link.url + "#" + link.viewpoint;
}

TEST_CASE("names a scene, a Viewpoint and a budget in a link file, and reads it back") {
  const SceneLink link = good(
      "[GhostSpace link]\r\n# of the archive\nurl = https://example.org/a%20b.qnv \nViewpoint=The gate\n"
      "Budget=400000\nFuture=1\nnonsense\n");
  CHECK(link.url == "https://example.org/a%20b.qnv");
  CHECK(link.viewpoint == "The gate");
  CHECK(link.budget == 400'000);
  const SceneLink again = good(link_file_text(link));
  CHECK(again.url == link.url);
  CHECK(again.viewpoint == link.viewpoint);
  CHECK(again.budget == link.budget);
  CHECK(place_of(link) == "https://example.org/a%20b.qnv#The gate");
  CHECK(good("\xef\xbb\xbf[GhostSpace link]\nURL=cells://10.0.0.1:9/a.qnv").budget == 0);
}

TEST_CASE("restricts a link to the network, and reports its errors") {
  for (const char* bad :
       {"", "#VRML V2.0 utf8", "[GhostSpace link]\n", "[GhostSpace link]\nURL=\n",
        "[GhostSpace link]\nURL=/etc/passwd\n", "[GhostSpace link]\nURL=file:///etc/passwd\n",
        "[GhostSpace link]\nURL=FILE:///etc/passwd\n", "[GhostSpace link]\nURL=data:model/vrml,x\n",
        "[GhostSpace link]\nURL=memory://a/b\n", "[GhostSpace link]\nURL=http:/a/b\n",
        "[GhostSpace link]\nURL=--control\n", "[GhostSpace link]\nURL=javascript:alert(1)\n",
        "[GhostSpace link]\nURL=http://a/\x01\n", "[GhostSpace link]\nURL=http://a/b\nBudget=-1\n",
        "[GhostSpace link]\nURL=http://a/b\nBudget=1e5\n", "[GhostSpace link]\nURL=http://a/b\nViewpoint=\x1b[2J\n"}) {
    INFO(bad);
    CHECK(std::holds_alternative<std::string>(read_link_file(bad)));
  }
  CHECK(std::holds_alternative<std::string>(
      read_link_file("[GhostSpace link]\nURL=http://a/" + std::string(70'000, 'x'))));
}

TEST_CASE("opens the address after the scheme ghostspace") {
  const auto place = [](const std::string& url) {
    const auto link = read_link_url(url);
    if (!link) return std::string("none");
    return std::holds_alternative<SceneLink>(*link) ? place_of(std::get<SceneLink>(*link)) : std::string("refused");
  };
  CHECK(place("ghostspace:http://example.org/a.wrl#Gate") == "http://example.org/a.wrl#Gate");
  CHECK(place("GhostSpace:https://example.org/a.qnv") == "https://example.org/a.qnv");
  CHECK(place("ghostspace://example.org/a.wrl") == "http://example.org/a.wrl");
  CHECK(place("ghostspace:cells://host:1/a.qnv") == "cells://host:1/a.qnv");
  for (const char* bad : {"ghostspace:", "ghostspace:a.wrl", "ghostspace:/etc/passwd", "ghostspace:file:///etc/passwd",
                          "ghostspace:--snapshot", "ghostspace:ghostspace:http://a/b", "ghostspace:http:"})
    CHECK(place(bad) == "refused");
  CHECK(place("http://example.org/") == "none");
  CHECK(place("ghostspace") == "none");
  CHECK(place("GhostSpace:HTTP://example.org/a.wrl") == "HTTP://example.org/a.wrl");
  for (const char* bad : {"ghostspace:http:///user:pw@host/a", "ghostspace:http://:80/a", "ghostspace:http://a:99999/"})
    CHECK(place(bad) == "refused");
}

TEST_CASE("detects a link by its name in user input") {
  const ScratchFolder folder;
  const std::string link =
      folder.write("A.GSLINK", "[GhostSpace link]\nURL=http://example.org/a.wrl\nViewpoint=Gate\nBudget=7\n");
  const GivenPlace given = given_place(link);
  CHECK(given.problem.empty());
  CHECK(given.target == "http://example.org/a.wrl");
  CHECK(given.viewpoint == "Gate");
  CHECK(given.budget == 7);
  CHECK(given_place("ghostspace:http://example.org/a.wrl#B").viewpoint == "B");
  CHECK_FALSE(given_place(folder.write("bad.gslink", "nothing")).problem.empty());
  CHECK_FALSE(given_place(folder.path("missing.gslink")).problem.empty());
  CHECK(given_place(folder.write("a.wrl", "")).problem.empty());
  CHECK_FALSE(scene_link_of("http://example.org/a.gslink"));
}

TEST_CASE("reports a bad link, and opens nothing") {
  const ScratchFolder folder;
  Session session({}, {}, {});
  const std::string link = folder.write("bad.gslink", "[GhostSpace link]\nURL=file:///etc/passwd\n");
  session.opening().open_files({link});
  SessionInput input;
  input.area = Viewport{0, 0, 200, 100};
  const Frame frame = session.step(0, input);
  REQUIRE(frame.failed.size() == 1);
  CHECK(frame.failed[0].path == link);
  CHECK(frame.notices.size() == 1);
  CHECK(session.log().errors() == 1);
  CHECK(session.panes().documents().entries().empty());
}

}  // namespace gs::app::link_file_test
