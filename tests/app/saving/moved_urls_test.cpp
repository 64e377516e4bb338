#include "app/saving/moved_urls.h"

#include "tests/app/scratch_folder.h"
#include "tests/app/worlds.h"

#include <catch2/catch.hpp>

#include <filesystem>
#include <string>

namespace gs::app::moved_urls_test {

TEST_CASE("adapts relative URLs of existing files to another folder") {
  const ScratchFolder folder;
  folder.write("a/wood grain.png", "x");
  const std::string world = folder.write("a/room.wrl", "#VRML V2.0 utf8\n"), target = folder.path("b/room.wrl");
  CHECK(moved_url("wood%20grain.png", world, target) == "../a/wood%20grain.png");
  CHECK(moved_url("wood grain.png#x", world, target) == "../a/wood%20grain.png#x");
  CHECK(moved_url("room.wrl#Door", world, folder.path("c.wrl")) == "a/room.wrl#Door");
  CHECK(moved_url("none.png", world, target) == "none.png");  // no such file
  CHECK(moved_url("#Door", world, target) == "#Door");
  CHECK(moved_url("https://a.example/b.png", world, target) == "https://a.example/b.png");
  CHECK(moved_url("javascript: function f() {}", world, target) == "javascript: function f() {}");
  CHECK(moved_url(folder.path("a/room.wrl"), world, target) == folder.path("a/room.wrl"));
}

TEST_CASE("makes relative URLs of a world from the network absolute") {
  CHECK(moved_url("b/c.png?x=1#y", "https://a.example/w/room.wrl", "room.wrl") == "https://a.example/w/b/c.png?x=1#y");
}

TEST_CASE("finds the URLs of nodes, of EXTERNPROTOs and of the defaults of PROTOs") {
  const ScratchFolder folder;
  for (const char* name : {"a.png", "b.wrl", "c.png", "d.wrl", "e.png"}) folder.write(std::string("a/") + name, "x");
  const std::string body =
      "PROTO P [ field MFString url \"c.png\" ] { Shape { appearance Appearance { texture ImageTexture { url IS url } "
      "} } "
      "}\nEXTERNPROTO Q [ ] \"d.wrl\"\nShape { appearance Appearance { texture ImageTexture { url \"a.png\" } } }\n"
      "Inline { url [ \"b.wrl\" \"none.wrl\" ] }\nP { } P { url \"e.png\" }\n";
  const LoadedWorld world = world_of(body);
  const std::string text = "#VRML V2.0 utf8\n" + body;
  const auto edits = moved_urls(*world.scene, folder.path("a/room.wrl"), folder.path("room.wrl"));
  const auto moved = vrml::edited_text(text, edits);
  REQUIRE(moved);
  for (const char* url : {"\"a/a.png\"", "\"a/b.wrl\", \"none.wrl\"", "\"a/c.png\"", "\"a/d.wrl\"", "\"a/e.png\""}) {
    INFO(url << " in " << *moved);
    CHECK(moved->find(url) != std::string::npos);
  }
  CHECK(moved_urls(*world.scene, folder.path("a/room.wrl"), folder.path("a/copy.wrl")).empty());
}

}  // namespace gs::app::moved_urls_test
