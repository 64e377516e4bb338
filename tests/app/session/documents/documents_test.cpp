#include "app/session/documents/documents.h"

#include "app/session/viewports/view.h"
#include "vrml/scene/node_type.h"
#include "vrml/scene/scene_graph.h"

#include "tests/app/worlds.h"

#include <catch2/catch.hpp>

namespace {

using namespace gs;
using namespace gs::app;

std::shared_ptr<Document> empty_document(const std::string& path) {
  auto document = std::make_shared<Document>();
  document->world.path = path;
  return document;
}

/// Returns a world of one QNV node with this geometry.
LoadedWorld world_of(qnv::Geometry geometry) {
  LoadedWorld world = world_with({});
  const auto make = [&](const char* type) { return world.scene->create(*vrml::built_in_node_type(type)); };
  const vrml::NodeId shape = make("Shape"), qnv = make("QNV");
  world.scene->set<vrml::SFNode>(shape, "geometry", qnv);
  world.scene->add_root(shape);
  world.geometries[&world.scene->node(qnv)] = std::make_shared<const qnv::Geometry>(std::move(geometry));
  return world;
}

}  // namespace

TEST_CASE("reads a file once, and again on request") {
  DocumentList list;
  CHECK_FALSE(list.begin("a.wrl"));
  list.add("");
  CHECK(list.entries().empty());
  list.add("a.wrl");
  CHECK(list.awaited("a.wrl"));
  CHECK_FALSE(list.awaited("b.wrl"));
  const auto reading = list.begin("a.wrl");
  REQUIRE(reading);
  CHECK(reading->path == "a.wrl");
  CHECK_FALSE(list.begin("a.wrl"));
  CHECK(list.awaited("a.wrl"));
  CHECK(list.deliver(reading->number, empty_document("a.wrl")) == "a.wrl");
  CHECK_FALSE(list.awaited("a.wrl"));
  CHECK_FALSE(list.begin("a.wrl"));
  CHECK_FALSE(list.deliver(reading->number, empty_document("a.wrl")));
  const auto before = list.document("a.wrl");
  REQUIRE(before);

  list.add("a.wrl");
  CHECK(list.entries().size() == 1);
  const auto again = list.begin("a.wrl");
  REQUIRE(again);
  CHECK(list.document("a.wrl") == before);  // until the file is read
  list.reload("a.wrl");                     // again during reading
  CHECK_FALSE(list.begin("a.wrl"));
  list.deliver(again->number, empty_document("a.wrl"));
  CHECK(list.document("a.wrl") != before);
  CHECK(list.begin("a.wrl"));
}

TEST_CASE("reads several files at once, which may end in any order") {
  DocumentList list;
  list.add("a");
  list.add("b");
  const auto a = list.begin("a"), b = list.begin("b");
  REQUIRE((a && b));
  CHECK(list.deliver(b->number, empty_document("b")) == "b");
  CHECK(list.document("a") == nullptr);
  CHECK(list.deliver(a->number, empty_document("a")) == "a");
  CHECK(list.document("a")->world.path == "a");
}

TEST_CASE("removes a file that cannot be opened from the list, unless it was open") {
  DocumentList list;
  list.add("bad");
  list.add("good");
  auto reading = list.begin("bad");
  CHECK(list.fail(reading->number) == "bad");
  CHECK(list.entries().size() == 1);
  CHECK_FALSE(list.fail(reading->number));
  reading = list.begin("good");
  list.deliver(reading->number, empty_document("good"));
  list.reload("good");
  reading = list.begin("good");
  CHECK(list.fail(reading->number) == "good");
  CHECK(list.document("good"));
  CHECK_FALSE(list.awaited("good"));
}

TEST_CASE("drops the result of a cancelled load") {
  DocumentList list;
  list.add("a");
  list.cancel("a");  // no reading has started
  const auto reading = list.begin("a");
  list.cancel("a");
  CHECK(*reading->cancelled);
  CHECK(list.awaited("a"));  // from the start of reading
  CHECK_FALSE(list.deliver(reading->number, empty_document("a")));
  CHECK_FALSE(list.document("a"));
  const auto again = list.begin("a");
  REQUIRE(again);
  CHECK(again->number != reading->number);
  CHECK_FALSE(list.fail(reading->number));
  list.give_up(list.entries()[0].path);
  CHECK(*again->cancelled);
  CHECK(list.entries().empty());
}

TEST_CASE("chooses navigation and Viewpoint at the entry of a world") {
  const auto entered = [](std::initializer_list<const char*> types, const char* viewpoint, bool& found) {
    return view_of(make_document(world_with(types)), {800, 600}, viewpoint, &found);
  };
  bool found = false;
  SECTION("nothing in it says anything") {
    const View view = entered({"Group"}, "", found);
    CHECK(found);
    CHECK(view.navigation.mode == NavigationMode::examine);
    CHECK_FALSE(view.viewpoint);
    CHECK(view.headlight);
    (void)entered({"Group"}, "Front", found);
    CHECK_FALSE(found);
  }
  SECTION("a Viewpoint and a NavigationInfo") {
    const View view = entered({"Viewpoint", "NavigationInfo"}, "", found);
    CHECK(view.document->has_navigation_info);
    CHECK(found);
    CHECK(view.viewpoint == 0u);
    CHECK(view.navigation.mode == NavigationMode::walk);
    CHECK(view.navigation.pose.position == glm::dvec3(0, 0, 10));  // the default of 6.53
    CHECK(view.navigation.speed == 1);
  }
  SECTION("nothing at all") {
    const auto document = make_document(LoadedWorld());
    REQUIRE(document->list);
    CHECK(document->list->items.empty());
    View view = view_of(std::shared_ptr<Document>(make_document(LoadedWorld())), {800, 600}, "");
    CHECK_FALSE(follow_world(view));
  }
}

TEST_CASE("reports the geometries of a document") {
  qnv::Splats geometry;
  geometry.positions = {{0, 0, 0}, {1, 1, 1}};
  geometry.normals = {{0, 0, 1}, {0, 1, 0}};
  geometry.weights = {3, 8};
  geometry.description.box.add({0, 0, 0});
  geometry.description.box.add({1, 1, 1});
  SECTION("a surface") {
    const auto document = make_document(world_of(geometry));
    CHECK(document->has_surface_vectors);
    CHECK_FALSE(document->has_volumes);
    CHECK(document->has_vectors());
  }
  SECTION("a volume") {
    qnv::Volume volume;
    static_cast<qnv::VectorArrays&>(volume) = geometry;
    volume.description.value_range = {-1000, 3000};
    volume.description.metadata = {{"title", "head"}};
    volume.classes = {1, 2};
    const auto document = make_document(world_of(volume));
    CHECK_FALSE(document->has_surface_vectors);
    CHECK(document->has_volumes);
  }
  CHECK_FALSE(make_document(world_with({"Group"}))->has_vectors());
}

TEST_CASE("labels a file with the last part of its path") {
  const std::pair<const char*, const char*> labels[] = {
      {"/home/somebody/world.wrl", "world.wrl"},
      {"world.wrl", "world.wrl"},
      {"http://example.org/a/b.wrz", "b.wrz"},
      {"folder/", "folder"},
      {"/", "/"},
      {"", ""},
  };
  for (const auto& [path, label] : labels) CHECK(file_label(path) == label);
}
