#include "app/serve/folder_world.h"

#include "tests/app/worlds.h"

#include <catch2/catch.hpp>

#include <string>

namespace gs::app::folder_world_test {
namespace {

std::size_t anchors(const vrml::SceneGraph& scene) {
  std::size_t count = 0;
  for (const auto root : scene.roots())
    if (scene.node(root).type->name == "Transform")
      for (const auto child : scene.get<vrml::MFNode>(root, "children"))
        count += scene.node(child).type->name == "Anchor";
  return count;
}

}  // namespace

TEST_CASE("shows a folder as a world with pictures that open its files") {
  net::FolderListing listing;
  listing.path = "/data/\"x\\/";
  listing.entries = {{"run 7", true, 0, 0},
                     {"head.nrrd", false, 100, 0},
                     {"town.wrl", false, 5, 0},
                     {"notes.txt", false, 5, 0},
                     {"\xff\"\\\n.stl", false, 5, 0}};
  const net::FolderPage page = folder_world(listing, true);
  CHECK(page.mime == "model/vrml");
  vrml::SceneGraph scene("folder.wrl");
  Diagnostics diagnostics;
  (void)vrml::parse(page.body, scene, diagnostics);
  CHECK(diagnostics.errors() == 0);
  CHECK(anchors(scene) == 4);
  CHECK(page.body.find("url \"./run%207/\"") != std::string::npos);
  CHECK(page.body.find("url \"./head.nrrd.qnv\"") != std::string::npos);
  CHECK(page.body.find("url \"./head.nrrd?thumbnail\"") != std::string::npos);
  CHECK(page.body.find("url \"./town.wrl\"") != std::string::npos);
  CHECK(page.body.find("url \"./notes.txt\"") == std::string::npos);
  CHECK(folder_world(listing, false).body.find("thumbnail") == std::string::npos);
  CHECK(folder_world(listing, false).body.find("head.nrrd.qnv") == std::string::npos);
}

TEST_CASE("the world of a long folder is bounded and says so") {
  net::FolderListing listing;
  listing.path = "/";
  for (int i = 0; i < 5000; ++i) listing.entries.push_back({std::to_string(i) + ".stl", false, 1, 0});
  const std::string body = folder_world(listing, true).body;
  CHECK(body.find("/ (120 of 5000 entries)") != std::string::npos);
  CHECK(body.size() < 200'000);
  CHECK(folder_world({}, true).body.starts_with("#VRML V2.0 utf8\n"));
}

}  // namespace gs::app::folder_world_test
