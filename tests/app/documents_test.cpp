#include "app/documents.h"

#include "vrml/node_type.h"
#include "vrml/scene_graph.h"

#include <catch2/catch.hpp>

namespace {

using namespace gs;
using namespace gs::app;

std::unique_ptr<Document> empty_document(const std::string& path) {
  auto document = std::make_unique<Document>();
  document->world.path = path;
  return document;
}

OpenedWorld world_with(std::initializer_list<const char*> types) {
  OpenedWorld world;
  world.scene = std::make_unique<vrml::SceneGraph>("test.wrl");
  for (const char* type : types) {
    REQUIRE(vrml::built_in_node_type(type));
    world.scene->add_root(world.scene->create(*vrml::built_in_node_type(type)));
  }
  return world;
}

}  // namespace

TEST_CASE("Dropped files join the list, the first of them is shown") {
  DocumentList list;
  CHECK_FALSE(list.begin_loading());
  CHECK(list.shown() == nullptr);
  const std::string start[] = {"a.wrl"};
  list.open(start);
  CHECK(list.begin_loading() == "a.wrl");
  CHECK_FALSE(list.begin_loading());  // one at a time
  list.deliver(empty_document("a.wrl"));
  REQUIRE(list.shown());
  CHECK(list.shown()->world.path == "a.wrl");

  const std::string dropped[] = {"", "b.wrl", "c.wrl"};
  list.open(dropped);
  CHECK(list.entries().size() == 3);
  CHECK(list.selected() == 1);
  CHECK(list.shown()->world.path == "a.wrl");  // until b is read
  CHECK(list.begin_loading() == "b.wrl");
  CHECK(list.loading() == "b.wrl");
  list.deliver(empty_document("b.wrl"));
  CHECK(list.shown()->world.path == "b.wrl");
  CHECK_FALSE(list.begin_loading());  // c is read when it is chosen
  list.select(2);
  CHECK(list.begin_loading() == "c.wrl");
  list.select(0);
  CHECK(list.shown()->world.path == "a.wrl");
  list.deliver(empty_document("c.wrl"));
  CHECK(list.shown()->world.path == "a.wrl");  // the user has gone on
  list.select(99);
  CHECK(list.selected() == 0);
}

TEST_CASE("A path that is opened again is read again") {
  DocumentList list;
  const std::string paths[] = {"a.wrl", "b.wrl", "a.wrl"};
  list.open(paths);
  CHECK(list.entries().size() == 2);
  CHECK(list.begin_loading() == "a.wrl");
  list.deliver(empty_document("a.wrl"));
  const Document* before = list.shown();
  list.open(std::span(paths, 1));
  CHECK(list.begin_loading() == "a.wrl");
  list.deliver(empty_document("a.wrl"));
  CHECK(list.shown() != before);
  list.reload();
  CHECK(list.begin_loading() == "a.wrl");
  list.fail();
  CHECK(list.entries().size() == 2);  // what was there stays
  CHECK(list.shown());
}

TEST_CASE("A file that cannot be opened leaves the list") {
  DocumentList list;
  const std::string paths[] = {"bad1", "bad2", "good"};
  list.open(paths);
  CHECK(list.begin_loading() == "bad1");
  list.fail();
  CHECK(list.begin_loading() == "bad2");
  list.fail();
  CHECK(list.begin_loading() == "good");
  list.deliver(empty_document("good"));
  CHECK(list.shown()->world.path == "good");
  const std::string later[] = {"bad3"};
  list.open(later);
  CHECK(list.begin_loading() == "bad3");
  list.fail();
  CHECK(list.entries().size() == 1);
  CHECK(list.selected() == 0);
  CHECK(list.shown()->world.path == "good");
  CHECK_FALSE(list.begin_loading());
  list.fail();  // nothing is being read
  CHECK(list.entries().size() == 1);
}

TEST_CASE("Where a world is entered") {
  SECTION("nothing in it says anything") {
    const auto document = make_document(world_with({"Group"}));
    CHECK(enter(*document, {800, 600}, ""));
    CHECK(document->navigation.mode == NavigationMode::examine);
    CHECK_FALSE(document->viewpoint);
    CHECK(document->headlight);
    CHECK_FALSE(enter(*document, {800, 600}, "Front"));
  }
  SECTION("a Viewpoint and a NavigationInfo") {
    const auto document = make_document(world_with({"Viewpoint", "NavigationInfo"}));
    CHECK(document->has_navigation_info);
    CHECK(enter(*document, {800, 600}, ""));
    CHECK(document->viewpoint == 0u);
    CHECK(document->navigation.mode == NavigationMode::walk);
    CHECK(document->navigation.pose.position == glm::vec3(0, 0, 10));  // the default of 6.53
    CHECK(document->navigation.speed == 1);
  }
  SECTION("levels of detail follow the viewer") {
    const auto document = make_document(world_with({"LOD"}));
    CHECK(document->viewer_dependent);
    enter(*document, {800, 600}, "");
    follow_viewer(*document);
    CHECK_FALSE(follow_viewer(*document));
    document->navigation.pose.position.x += 1;
    CHECK(follow_viewer(*document));
  }
  SECTION("nothing at all") {
    const auto document = make_document(OpenedWorld());
    CHECK(document->list.items.empty());
    CHECK_FALSE(follow_viewer(*document));
  }
}

TEST_CASE("The label of a file is the last part of its path") {
  CHECK(file_label("/home/somebody/world.wrl") == "world.wrl");
  CHECK(file_label("world.wrl") == "world.wrl");
  CHECK(file_label("http://example.org/a/b.wrz") == "b.wrz");
  CHECK(file_label("folder/") == "folder");
  CHECK(file_label("/") == "/");
  CHECK(file_label("").empty());
}
