#include "app/session/viewports/pane_loading.h"

#include "tests/app/worlds.h"

#include <catch2/catch.hpp>

#include <glm/geometric.hpp>

namespace {

using namespace gs;
using namespace gs::app;

constexpr glm::vec2 kSize(800, 600);
const Viewport kArea{0, 0, 800, 600};

std::shared_ptr<Document> document(std::initializer_list<const char*> types = {"Group"}) {
  return make_document(world_with(types));
}

/// Returns a document with a box of this position and size, for views.
std::shared_ptr<Document> document_of(const glm::vec3& lower, const glm::vec3& upper) {
  auto result = document();
  render::RenderList list = *result->list;
  list.bounds.add(lower);
  list.bounds.add(upper);
  result->runtime.reset();
  result->first_scene.reset();
  result->list = std::make_shared<const render::RenderList>(std::move(list));
  return result;
}

std::vector<PaneLoading::Change> settle(Panes& panes) {
  return PaneLoading(panes).settle(arrange(panes.split(), kArea), {});
}

/// Reads all pending files.
void load_all(Panes& panes) {
  while (const auto reading = PaneLoading(panes).begin())
    PaneLoading(panes).deliver(reading->number, document(), kSize);
  settle(panes);
}

}  // namespace

TEST_CASE("opens each file of the command line in its own viewport, up to the maximum") {
  const std::vector<std::string> all{"a", "b", "c", "d", "e"};
  for (std::size_t count = 0; count <= all.size(); ++count) {
    Panes panes;
    PaneLoading loading(panes);
    panes.start(std::span(all).first(count));
    CHECK(layout_of(panes.split()) == layout_for(count));
    CHECK(panes.active() == 0);
    for (std::size_t i = 0; i < kMaxViewportsAtStart; ++i) CHECK(panes.at(i).wanted == (i < count ? all[i] : ""));
    CHECK(panes.documents().entries().size() == count);
    std::size_t readings = 0;
    while (const auto reading = loading.begin()) {
      CHECK(reading->path == all[readings]);  // the active viewport first
      ++readings;
    }
    CHECK(readings == std::min(count, kMaxViewportsAtStart));  // hidden files are not read
  }
}

TEST_CASE("shows one file in several viewports, and reads it once") {
  Panes panes;
  PaneLoading loading(panes);
  const std::string twice[] = {"a", "a"};
  panes.start(twice);
  CHECK(layout_of(panes.split()) == ViewportLayout::two);
  const auto reading = loading.begin();
  REQUIRE(reading);
  CHECK_FALSE(loading.begin());
  CHECK(panes.loading(0));
  CHECK(panes.loading(1));
  loading.deliver(reading->number, document(), kSize);
  CHECK_FALSE(panes.loading(0));
  const auto changes = settle(panes);
  REQUIRE(changes.size() == 2);
  CHECK(changes[0].first);
  CHECK(changes[1].pane == 1);
  CHECK(settle(panes).empty());
  REQUIRE(panes.at(0).view());
  REQUIRE(panes.at(1).view());
  CHECK(panes.at(0).view()->document == panes.at(1).view()->document);
  // The viewports get different cameras and styles.
  panes.at(0).view()->navigation.pose.position.x += 5;
  panes.at(1).view()->look.opacity = 7;
  panes.at(1).view()->headlight = false;
  CHECK(panes.at(1).view()->navigation.pose.position != panes.at(0).view()->navigation.pose.position);
  CHECK(panes.at(0).view()->look.opacity == 2);
  CHECK(panes.at(0).view()->headlight);
}

TEST_CASE("opens a file in the active viewport, and more files in free visible ones") {
  Panes panes;
  const std::string start[] = {"a", "b", "c"};
  panes.start(start);
  load_all(panes);
  CHECK(panes.at(3).view() == nullptr);
  panes.activate(1);
  const std::string dropped[] = {"", "x", "y", "z"};
  panes.open(dropped);
  CHECK(panes.at(1).wanted == "x");
  CHECK(panes.at(1).shown == "b");  // until the file is read
  CHECK(panes.at(3).wanted == "y");
  CHECK(panes.documents().entries().size() == 6);
  CHECK(panes.selected() == 3u);
  load_all(panes);
  CHECK(panes.at(1).shown == "x");
  CHECK(panes.at(3).shown == "y");
  panes.select(99);
  CHECK(panes.at(1).wanted == "x");
}

TEST_CASE("restores the earlier view of a file") {
  Panes panes;
  const std::string start[] = {"a"}, other[] = {"b"};
  panes.start(start);
  load_all(panes);
  panes.at(0).view()->navigation.pose.position = {1, 2, 3};
  panes.open(other);
  load_all(panes);
  CHECK(panes.at(0).view()->navigation.pose.position != glm::dvec3(1, 2, 3));
  panes.select(0);
  const auto changes = settle(panes);
  REQUIRE(changes.size() == 1);
  CHECK_FALSE(changes[0].first);
  CHECK(panes.at(0).view()->navigation.pose.position == glm::dvec3(1, 2, 3));
}

TEST_CASE("keeps the view of a file that is read again, and drops the old world") {
  Panes panes;
  const std::string twice[] = {"a", "a"};
  panes.start(twice);
  load_all(panes);
  const std::weak_ptr<Document> before = panes.at(0).view()->document;
  panes.at(0).view()->navigation.pose.position = {1, 2, 3};
  panes.at(1).view()->look.opacity = 5;
  panes.reload();
  CHECK(panes.loading(1));
  CHECK_FALSE(before.expired());
  load_all(panes);
  CHECK(before.expired());
  CHECK(panes.at(0).view()->document == panes.at(1).view()->document);
  CHECK(panes.at(0).view()->navigation.pose.position == glm::dvec3(1, 2, 3));
  CHECK(panes.at(1).view()->look.opacity == 5);
}

TEST_CASE("fills a larger layout with listed files, then with open ones, in view") {
  Panes panes;
  const std::string start[] = {"a"};
  panes.start(start);
  load_all(panes);
  const std::string more[] = {"b"};
  panes.open(more);
  load_all(panes);
  panes.at(0).view()->navigation.pose.position = {1, 2, 3};
  panes.set_split(split_of(ViewportLayout::four, panes.active()));
  CHECK(panes.at(1).wanted == "a");  // listed, but never shown
  CHECK(panes.at(2).wanted == "b");
  CHECK(panes.at(2).shown == "b");
  REQUIRE(panes.at(2).view());
  CHECK(panes.at(2).view()->navigation.pose.position == glm::dvec3(1, 2, 3));
  CHECK(panes.at(2).view()->document == panes.at(0).view()->document);
  load_all(panes);
  CHECK(panes.at(1).shown == "a");
  // One viewport is active; the others stay.
  panes.activate(2);
  panes.set_split(split_of(ViewportLayout::one, panes.active()));
  CHECK(panes.visible() == std::vector<std::size_t>{2});
  panes.activate(1);
  CHECK(panes.visible() == std::vector<std::size_t>{1});
}

TEST_CASE("never activates a hidden viewport without a file") {
  Panes panes;
  const std::string start[] = {"a"};
  panes.start(start);
  panes.activate(1);
  CHECK(panes.active() == 0);
  panes.activate(99);
  CHECK(panes.active() == 0);
  panes.set_split(split_of(ViewportLayout::two, panes.active()));
  panes.activate(1);
  CHECK(panes.active() == 1);
}

TEST_CASE("releases held keys when another viewport becomes active") {
  Panes panes;
  const std::string twice[] = {"a", "a"};
  panes.start(twice);
  load_all(panes);
  WindowEvent key;
  key.kind = WindowEvent::Kind::key_down;
  key.key = letter_key('W');
  panes.at(0).input.take(key, NavigationMode::fly);
  CHECK(panes.at(0).input.holding());
  panes.activate(1);
  CHECK_FALSE(panes.at(0).input.holding());
}

TEST_CASE("cancels loading") {
  Panes panes;
  PaneLoading loading(panes);
  const std::string start[] = {"a"};
  panes.start(start);
  load_all(panes);
  const std::string other[] = {"big"};
  SECTION("by the user") {
    panes.open(other);
    const auto reading = loading.begin();
    REQUIRE(reading);
    CHECK_FALSE(*reading->cancelled);
    CHECK(loading.cancel(0));
    CHECK(*reading->cancelled);
    CHECK_FALSE(loading.cancel(0));
    CHECK(panes.at(0).wanted == "a");
    CHECK(panes.documents().entries().size() == 1);
    loading.deliver(reading->number, document(), kSize);  // delivered nevertheless
    CHECK(settle(panes).empty());
    CHECK(panes.documents().entries().size() == 1);
    CHECK(loading.fail(reading->number).empty());
  }
  SECTION("because another file is wanted") {
    panes.open(other);
    const auto reading = loading.begin();
    panes.select(0);
    CHECK(*reading->cancelled);
    CHECK(panes.documents().entries().size() == 2);
    panes.select(1);
    const auto again = loading.begin();
    REQUIRE(again);
    CHECK_FALSE(*again->cancelled);
    loading.deliver(reading->number, document(), kSize);
    CHECK(settle(panes).empty());
    loading.deliver(again->number, document(), kSize);
    CHECK(settle(panes).size() == 1);
  }
  SECTION("but not while another viewport waits for it") {
    panes.set_split(split_of(ViewportLayout::two, panes.active()));
    panes.open(other);
    panes.activate(1);
    panes.open(other);
    const auto reading = loading.begin();
    panes.select(0);
    CHECK_FALSE(*reading->cancelled);
    loading.deliver(reading->number, document(), kSize);
    settle(panes);
    CHECK(panes.at(0).shown == "big");
    CHECK(panes.at(1).shown == "a");
  }
  SECTION("of a file that is there already") {
    panes.reload();
    const auto reading = loading.begin();
    REQUIRE(reading);
    CHECK(loading.cancel(0));
    CHECK(*reading->cancelled);
    CHECK(panes.at(0).view());
    CHECK_FALSE(panes.loading(0));
    CHECK_FALSE(loading.begin());
  }
  SECTION("at the end") {
    panes.open(other);
    const auto reading = loading.begin();
    loading.cancel_all();
    CHECK(*reading->cancelled);
  }
}

TEST_CASE("replaces a file that cannot be opened by the next one") {
  Panes panes;
  PaneLoading loading(panes);
  const std::string start[] = {"bad", "b", "c", "d", "e"};
  panes.start(start);
  const auto bad = loading.begin();
  REQUIRE(bad);
  CHECK(loading.fail(bad->number) == std::vector<std::size_t>{0});
  CHECK(panes.at(0).wanted == "e");
  CHECK(panes.documents().entries().size() == 4);
  load_all(panes);
  CHECK(panes.at(0).shown == "e");
  const std::string worse[] = {"worse"};
  panes.open(worse);
  const auto reading = loading.begin();
  CHECK(loading.fail(reading->number) == std::vector<std::size_t>{0});
  CHECK(panes.at(0).wanted == "e");
  CHECK(panes.at(0).view());
}

TEST_CASE("keeps documents while they are shown or listed") {
  std::weak_ptr<Document> kept;
  {
    View view;
    {
      Panes panes;
      const std::string start[] = {"a"};
      panes.start(start);
      load_all(panes);
      kept = panes.at(0).view()->document;
      view = *panes.at(0).view();
    }
    CHECK_FALSE(kept.expired());
    CHECK(view.list == view.document->list);
  }
  CHECK(kept.expired());
}

TEST_CASE("chooses levels of detail for each viewer") {
  const auto shared =
      make_document(world_of("LOD { range 15 level [ Shape { geometry Box { } } Shape { geometry Cone { } } ] }"));
  CHECK(shared->viewer_dependent);
  View one = view_of(shared, kSize, {}), two = view_of(shared, kSize, {});
  CHECK(one.list != two.list);
  CHECK_FALSE(follow_world(one));
  one.navigation.pose.position = {0, 0, 20};
  CHECK(follow_world(one));
  CHECK(one.list->items.at(0).mesh != two.list->items.at(0).mesh);
  const auto fixed = document({"Group"});
  View third = view_of(fixed, kSize, {}), fourth = view_of(fixed, kSize, {});
  CHECK(third.list == fourth.list);
  third.navigation.pose.position.x += 1;
  CHECK_FALSE(follow_world(third));
}

TEST_CASE("adapts the first view to the shape of the viewport until the user moves") {
  const glm::vec2 wide(800, 400), narrow(400, 800);
  View view = view_of(document_of({-10, -1, -1}, {10, 1, 1}), wide, {});
  const Pose at_first = view.navigation.pose;
  CHECK(at_first.position == first_pose(view.list->bounds, wide).position);
  fit_home(view, wide);
  CHECK(view.navigation.pose.position == at_first.position);
  fit_home(view, narrow);
  CHECK(view.navigation.pose.position == first_pose(view.list->bounds, narrow).position);
  CHECK(view.navigation.pose.position.z > at_first.position.z);  // the width must fit
  view.navigation.pose.position.x += 1;
  const glm::dvec3 moved = view.navigation.pose.position;
  fit_home(view, wide);
  CHECK(view.navigation.pose.position == moved);
  CHECK(view.home.position == at_first.position);

  View bound = view_of(document({"Viewpoint"}), wide, {});
  fit_home(bound, narrow);
  CHECK(bound.navigation.pose.position == glm::dvec3(0, 0, 10));
}

TEST_CASE("keeps a linked pose relative to its scene as the leader's") {
  Box small, large;
  small.add({-1, -1, -1});
  small.add({1, 1, 1});
  large.add({90, -10, -10});
  large.add({110, 10, 10});
  Pose pose;
  pose.position = {0, 0, 5};
  pose.field_of_view = 0.5f;
  CHECK(linked_pose(pose, small, small).position == glm::dvec3(0, 0, 5));
  const Pose there = linked_pose(pose, small, large);
  CHECK(glm::distance(there.position, glm::dvec3(100, 0, 50)) < 1e-4f);
  CHECK(there.orientation == pose.orientation);
  CHECK(there.field_of_view == 0.5f);
  CHECK(glm::distance(linked_pose(there, large, small).position, pose.position) < 1e-4f);
  CHECK(linked_pose(pose, Box{}, large).position == pose.position);
  CHECK(linked_pose(pose, small, Box{}).position == pose.position);
  Box endless;
  endless.add(glm::vec3(-std::numeric_limits<float>::max()));
  endless.add(glm::vec3(std::numeric_limits<float>::max()));
  CHECK(linked_pose(pose, small, endless).position == pose.position);
  CHECK(linked_pose(pose, endless, small).position == pose.position);
}

TEST_CASE("moves linked viewports, except in worlds without movement") {
  Panes panes;
  PaneLoading loading(panes);
  const std::string start[] = {"small", "large", "still"};
  panes.start(start);
  auto reading = loading.begin();
  loading.deliver(reading->number, document_of({-1, -1, -1}, {1, 1, 1}), kSize);
  reading = loading.begin();
  loading.deliver(reading->number, document_of({90, -10, -10}, {110, 10, 10}), kSize);
  reading = loading.begin();
  loading.deliver(reading->number, document(), kSize);
  settle(panes);
  Navigation& leader = panes.at(0).view()->navigation;
  leader.pose.position = {0, 3, 5};
  leader.center = {0, 1, 0};
  Navigation& other = panes.at(1).view()->navigation;
  other = travel_to(other, Pose{});
  panes.at(2).view()->navigation.mode = NavigationMode::none;
  const glm::dvec3 before = panes.at(2).view()->navigation.pose.position;
  panes.link(0);
  CHECK(glm::distance(other.pose.position, glm::dvec3(100, 30, 50)) < 1e-3f);
  CHECK(glm::distance(other.center, glm::dvec3(100, 10, 0)) < 1e-3f);
  CHECK_FALSE(other.moving());
  CHECK(panes.at(2).view()->navigation.pose.position == before);
  CHECK(leader.pose.position == glm::dvec3(0, 3, 5));
  panes.link(3);  // an empty viewport
}

TEST_CASE("shows the loaded part of a file, and frames it for an unmoved viewer") {
  const auto preview = [](const glm::vec3& upper) {
    auto result = document_of({0, 0, 0}, upper);
    result->is_preview = true;
    return result;
  };
  Panes panes;
  PaneLoading loading(panes);
  panes.start(std::vector<std::string>{"a"});
  const auto reading = loading.begin();
  REQUIRE(reading);
  loading.preview(reading->number, preview({1, 1, 1}));
  settle(panes);
  REQUIRE(panes.at(0).view());
  CHECK(panes.loading(0));
  const glm::dvec3 first = panes.at(0).view()->navigation.pose.position;
  loading.preview(reading->number, preview({9, 9, 9}));
  settle(panes);
  const glm::dvec3 second = panes.at(0).view()->navigation.pose.position;
  CHECK(glm::length(second) > 2 * glm::length(first));
  CHECK(panes.at(0).view()->list->bounds.upper == glm::dvec3(9));
  // A moved viewer stays.
  panes.at(0).view()->navigation.pose.position = {5, 6, 7};
  panes.at(0).view()->look.opacity = 3;
  loading.preview(reading->number, preview({20, 20, 20}));
  CHECK(panes.at(0).view()->navigation.pose.position == glm::dvec3(5, 6, 7));
  const auto whole = document_of({0, 0, 0}, {30, 30, 30});
  loading.deliver(reading->number, whole, kSize);
  settle(panes);
  CHECK_FALSE(panes.loading(0));
  CHECK(panes.at(0).view()->document == whole);
  CHECK(panes.at(0).view()->navigation.pose.position == glm::dvec3(5, 6, 7));
  CHECK(panes.at(0).view()->look.opacity == 3);
}

TEST_CASE("shows the old state of a file that is read again until the new one is complete") {
  Panes panes;
  PaneLoading loading(panes);
  panes.start(std::vector<std::string>{"a"});
  load_all(panes);
  const auto before = panes.at(0).view()->document;
  panes.reload();
  const auto reading = loading.begin();
  REQUIRE(reading);
  auto part = document();
  part->is_preview = true;
  loading.preview(reading->number, part);
  settle(panes);
  CHECK(panes.at(0).view()->document == before);
  // A load that fails after its first part keeps the former world.
  (void)loading.fail(reading->number);
  settle(panes);
  CHECK(panes.at(0).view()->document == before);
}
