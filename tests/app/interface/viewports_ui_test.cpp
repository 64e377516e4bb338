#include "app/streams/load_ledger.h"
#include "tests/app/interface/driver.h"
#include "tests/app/late_worlds.h"
#include "tests/app/scratch_folder.h"

#include <catch2/catch.hpp>

#include <string>
#include <vector>

// Tests of viewports as a user operates them: split, drag, swap, maximise, close, drop.
namespace gs::app::viewports_ui_test {

using driver::Driver;

constexpr char kBox[] = "Shape { geometry Box { } }", kCone[] = "Shape { geometry Cone { } }";

std::string split(Driver& user) { return split_text(user.session().panes().split()); }
std::string shown(Driver& user, std::size_t pane) { return user.session().panes().at(pane).shown; }

Viewport place(Driver& user, std::size_t pane) {
  for (const Frame::Picture& picture : user.frame().pictures)
    if (picture.pane == pane) return picture.place;
  FAIL("viewport " << pane << " is out of sight");
  return {};
}

glm::vec2 middle(Driver& user, std::size_t pane) {
  const Viewport one = place(user, pane);
  return {one.left + one.width / 2, one.top + one.height / 2};
}

// Shows two files in two viewports, with the second one active.
void show_two(Driver& user) {
  user.show_world(kBox, "box.wrl");
  user.press(Key::right, true, true);
  user.show_world(kCone, "cone.wrl");
}

TEST_CASE("splits, switches, maximises, swaps and closes viewports by keys") {
  Driver user;
  user.show_world(kBox, "box.wrl");
  CHECK(split(user) == "1");
  user.press(Key::right, true, true);
  CHECK(split(user) == "1|2");
  CHECK(user.session().panes().active() == 1);
  // Without another file, the new viewport shows the same file from the same position. Its camera moves independently.
  CHECK(shown(user, 1) == "box.wrl");
  REQUIRE(user.session().view());
  user.session().view()->navigation.pose.position.x += 1;
  CHECK(user.session().panes().at(0).view()->navigation.pose.position !=
        user.session().panes().at(1).view()->navigation.pose.position);
  user.press(Key::down, true, true);
  CHECK(split(user) == "1|(2/3)");
  CHECK(place(user, 2).top == place(user, 1).top + place(user, 1).height);

  user.press(Key::f6, true);
  CHECK(user.session().panes().active() == 0);
  user.press(Key::f6, true, true);
  CHECK(user.session().panes().active() == 2);
  user.press(letter_key('2'), true);
  CHECK(user.session().panes().active() == 1);

  user.press(letter_key('M'), true);
  CHECK(split(user) == "1|(2/3)!2");
  CHECK(user.frame().pictures.size() == 1);
  CHECK(place(user, 1).width == user.picture().width);
  user.press(letter_key('3'), true);  // another viewport with the same size
  CHECK(split(user) == "1|(2/3)!3");
  user.press(letter_key('M'), true);
  CHECK(user.frame().pictures.size() == 3);

  user.press(letter_key('X'), true, true);
  CHECK(split(user) == "3|(2/1)");
  user.press(letter_key('W'), true);
  CHECK(split(user) == "2/1");
  CHECK(user.session().panes().active() == 0);
  CHECK(user.session().panes().at(2).wanted.empty());
  user.press(letter_key('W'), true);
  CHECK(split(user) == "2");
  CHECK(shown(user, 1) == "box.wrl");
  user.press(letter_key('W'), true);  // the last one stays, without a file
  CHECK(split(user) == "2");
  CHECK(shown(user, 1).empty());
  for (int i = 0; i < 20; ++i) user.press(Key::right, true, true);
  CHECK(panes_of(user.session().panes().split()).size() == kMaxViewports);
  CHECK(user.sees("The window can have at most 12 viewports"));
}

TEST_CASE("offers viewport actions in menus and the palette") {
  Driver user;
  user.show_world(kBox, "box.wrl");
  user.click("Window");
  user.click("Split right");
  CHECK(split(user) == "1|2");
  user.press(letter_key('P'), true, true);
  user.type("swap with next");
  user.press(Key::enter);
  CHECK(split(user) == "2|1");
  user.press(letter_key('P'), true, true);
  user.type("close viewport");
  user.press(Key::enter);
  CHECK(split(user) == "1");
  user.press(letter_key('P'), true, true);
  user.type("maximise viewport");
  CHECK(user.sees("No matches."));  // the only viewport
}

TEST_CASE("drags a divider with its cursor, within the minimum sizes of viewports") {
  Driver user;
  show_two(user);
  const Viewport left = place(user, 0);
  const auto edge = static_cast<float>(left.left + left.width), height = static_cast<float>(left.top + left.height / 2);
  user.point({edge, height});
  user.step();
  CHECK(ImGui::GetMouseCursor() == ImGuiMouseCursor_ResizeEW);
  user.drag({edge, height}, {edge - 120, height});
  CHECK(place(user, 0).width == Approx(left.width - 120).margin(1));
  CHECK(place(user, 1).left == place(user, 0).left + place(user, 0).width);
  // The drag did not turn the world.
  CHECK(at_home(*user.session().panes().at(0).view()));
  const float there = edge - 120;
  user.drag({there, height}, {2, height});
  CHECK(place(user, 0).width == Approx(96).margin(1));
  user.point(middle(user, 1));
  user.step();
  CHECK(ImGui::GetMouseCursor() != ImGuiMouseCursor_ResizeEW);
  user.press(letter_key('0'), true, true);
  CHECK(place(user, 0).width == left.width);
  // A divider between rows.
  user.press(Key::down, true, true);
  const Viewport above = place(user, 1);
  const glm::vec2 at(above.left + above.width / 2, above.top + above.height);
  user.point(at);
  user.step();
  CHECK(ImGui::GetMouseCursor() == ImGuiMouseCursor_ResizeNS);
  user.drag(at, at + glm::vec2(0, 60));
  CHECK(place(user, 1).height == Approx(above.height + 60).margin(1));
}

TEST_CASE("splits, maximises and closes a viewport by its bar, and swaps and weights it by its menu") {
  Driver user;
  show_two(user);
  CHECK(user.sees("1 box.wrl"));
  CHECK(user.sees("2 cone.wrl"));
  user.click("2 cone.wrl", MouseButton::right);
  CHECK(user.sees("Split below"));
  user.click("Split below");
  CHECK(split(user) == "1|(2/3)");
  user.click("1 box.wrl", MouseButton::right);
  user.click("Maximise");
  CHECK(split(user) == "1|(2/3)!1");
  user.click("1 box.wrl", MouseButton::right);
  user.click("Show all viewports");
  CHECK(split(user) == "1|(2/3)");
  user.click("1 box.wrl", MouseButton::right);
  user.point(*user.find("Swap with"));
  user.wait(0.5);
  user.click("3 cone.wrl");
  CHECK(split(user) == "3|(2/1)");
  user.click("2 cone.wrl", MouseButton::right);
  const auto slider = user.find("1.00 times");
  REQUIRE(slider);
  user.drag(*slider, *slider + glm::vec2(400, 0));
  CHECK(user.session().panes().at(1).weight == Pane::kMaxWeight);
  user.press(Key::escape);
  user.click("2 cone.wrl", MouseButton::right);
  CHECK(user.sees("4.00 times"));
  user.click("Close");
  CHECK(split(user) == "3|1");
}

TEST_CASE("applies the weight of a viewport to its share of vectors and bandwidth") {
  Driver user;
  show_two(user);
  user.measures().budget = 1'000'000;
  for (const std::size_t pane : {0u, 1u}) user.session().panes().at(pane).view()->document->has_surface_vectors = true;
  user.settle();
  CHECK(user.sees("50 %"));
  std::vector<std::size_t> budgets = budgets_of(user.frame(), user.session().panes(), 1'000'000);
  CHECK(budgets[0] == Approx(500'000).epsilon(0.01));
  user.session().input().serve(PaneRequest{PaneRequest::Kind::weigh, 1, 0, 3});
  user.settle();
  budgets = budgets_of(user.frame(), user.session().panes(), 1'000'000);
  CHECK(budgets[0] == Approx(250'000).epsilon(0.01));
  CHECK(budgets[1] == Approx(750'000).epsilon(0.01));
  CHECK(user.sees("25 %"));
  CHECK(user.sees("75 %"));
  user.session().input().serve(PaneRequest{PaneRequest::Kind::weigh, 1, 0, 1e9});
  CHECK(user.session().panes().at(1).weight == Pane::kMaxWeight);
}

TEST_CASE("shows the bandwidth limit of a viewport, and sets it in its menu and the streams panel") {
  late_worlds::Site site;
  site.never("a.wrl");
  site.never("b.wrl");
  site.options.rate = 200'000;
  Driver user({}, {1000, 700}, site.options);
  user.press(Key::right, true, true);
  user.session().opening().open_in(0, "memory://a/a.wrl");
  user.session().opening().open_in(1, "memory://a/b.wrl");
  user.settle();
  const auto rate = [&](const std::string& path) {
    for (const DocumentReaders::Loads& one : user.session().readers().loads())
      if (one.path == path) return one.ledger->rate();
    return std::optional<std::uint64_t>();
  };
  CHECK(rate("memory://a/a.wrl") == 200'000U);
  CHECK(rate("memory://a/b.wrl") == 200'000U);
  CHECK(user.sees("0 bit/s of 200 kbit/s"));
  // The limit is set in the menu of the second viewport, which is active.
  user.click("2 empty", MouseButton::right);
  CHECK(user.sees("Reading: 50 %, 0 bit/s"));
  CHECK(user.sees("Bandwidth limit"));
  const auto list = user.find("200 kbit/s");
  REQUIRE(list);
  user.click(*list);
  user.click("2.0 Mbit/s");
  CHECK(user.session().streams().rate_of(1) == 2'000'000);
  CHECK(user.session().streams().rate_of(0) == 200'000);
  CHECK(rate("memory://a/a.wrl") == 200'000U);
  CHECK(rate("memory://a/b.wrl") == 2'000'000U);
  user.press(Key::escape);
  CHECK(user.sees("0 bit/s of 2.0 Mbit/s"));
  // The panel sets the limit of the active viewport.
  user.press(letter_key('E'), true, true);
  CHECK(user.sees("Bandwidth limit of viewport"));
  user.session().input().serve(PaneRequest{PaneRequest::Kind::limit, 1, 0, 1, 0});
  user.settle();
  CHECK(user.sees("no limit"));
  CHECK(rate("memory://a/b.wrl") == 0U);
  // A file that both viewports show gets the higher of their limits.
  user.session().opening().open_in(1, "memory://a/a.wrl");
  user.settle();
  CHECK(rate("memory://a/a.wrl") == 0U);
}

TEST_CASE("opens a dropped file in the viewport under the pointer") {
  ScratchFolder scratch;
  scratch.write("sphere.wrl", "#VRML V2.0 utf8\nShape { geometry Sphere { } }\n");
  Driver user;
  show_two(user);
  REQUIRE(user.session().panes().active() == 1);
  user.drop(middle(user, 0), {scratch.path("sphere.wrl")});
  CHECK(user.session().panes().active() == 0);
  CHECK(user.wait_for([&] { return shown(user, 0) == scratch.path("sphere.wrl"); }));
  CHECK(shown(user, 1) == "cone.wrl");
}

TEST_CASE("reports the error of a failed viewport, and opens its file again") {
  ScratchFolder scratch;
  Driver user;
  user.show_world(kBox, "box.wrl");
  user.press(Key::right, true, true);
  user.session().opening().open_in(1, scratch.path("late.wrl"));
  REQUIRE(user.wait_for([&] { return user.session().panes().at(1).failure.has_value(); }));
  user.settle();
  INFO(user.screen());
  CHECK(user.sees("late.wrl cannot be opened"));
  CHECK_FALSE(user.session().panes().at(1).failure->error.empty());
  CHECK(user.sees("Retry"));
  // The viewport still shows its earlier file.
  CHECK(shown(user, 1) == "box.wrl");
  CHECK_FALSE(user.session().panes().at(0).failure);
  // Now the file exists.
  scratch.write("late.wrl", "#VRML V2.0 utf8\nShape { geometry Sphere { } }\n");
  user.click("Retry");
  REQUIRE(user.wait_for([&] { return shown(user, 1) == scratch.path("late.wrl"); }));
  user.settle();
  CHECK_FALSE(user.sees("cannot be opened"));

  user.session().opening().open_in(1, scratch.path("none.wrl"));
  REQUIRE(user.wait_for([&] { return user.session().panes().at(1).failure.has_value(); }));
  user.settle();
  CHECK_FALSE(user.sees("1 error"));
  user.click("Show log");
  CHECK(user.sees("1 error"));
  user.controller().ui().clear_notices();
  user.settle();
  user.click("Close");  // closes only the message, since a file is shown
  CHECK_FALSE(user.session().panes().at(1).failure);
  CHECK(split(user) == "1|2");
}

TEST_CASE("offers the memory setting for a file that exceeds it, and opens it afterwards") {
  ScratchFolder scratch;
  std::string points;
  for (int i = 0; i < 30'000; ++i) points += "0 0 " + std::to_string(i) + ", ";
  const std::string path = scratch.write(
      "large.wrl", "#VRML V2.0 utf8\nShape { geometry PointSet { coord Coordinate { point [ " + points + " ] } } }\n");
  LoadOptions load;
  load.limits.memory = 256 << 10;
  {
    Driver given({}, {1000, 700}, load);  // --memory overrides the setting
    given.session().opening().open_files({path});
    REQUIRE(given.wait_for([&] { return given.sees("Raise memory limit"); }));
    given.settle();
    given.click("Raise memory limit");
    CHECK(given.sees("Memory limit"));
  }
  Driver user;
  UserSettings settings;
  settings.memory = 0.0002;
  UiActions actions;
  actions.settings = settings;
  user.controller().apply(actions);
  user.session().opening().open_files({path});
  REQUIRE(user.wait_for([&] { return user.session().panes().at(0).failure.has_value(); }));
  settings.memory = 1;
  actions.settings = settings;
  user.controller().apply(actions);
  user.settle();
  user.click("Retry");
  CHECK(user.wait_for([&] {
    const Pane& pane = user.session().panes().at(0);
    return !pane.failure && pane.view() && !pane.view()->list->items.empty();
  }));
}

TEST_CASE("closes a viewport together with the message of its failed file") {
  Driver user;
  user.session().opening().open_in(0, "/nowhere/first.wrl");
  REQUIRE(user.wait_for([&] { return user.session().panes().at(0).failure.has_value(); }));
  user.press(Key::right, true, true);
  user.session().opening().open_in(1, "/nowhere/second.wrl");
  REQUIRE(user.wait_for([&] { return user.session().panes().at(1).failure.has_value(); }));
  user.controller().ui().clear_notices();
  user.settle();
  CHECK(user.sees("first.wrl cannot be opened"));
  CHECK(user.sees("second.wrl cannot be opened"));
  CHECK_FALSE(user.sees("Drop a file here"));
  user.click("Close");
  CHECK(panes_of(user.session().panes().split()).size() == 1);
}

TEST_CASE("closes the message of a failed file by one Esc while the address field has the focus") {
  Driver user;
  user.show_world("Shape { geometry Box { } }", "box.wrl");
  user.press(letter_key('L'), true);
  user.type("/nowhere/typed.wrl");
  user.press(Key::enter);
  REQUIRE(user.wait_for([&] { return user.sees("typed.wrl cannot be opened"); }));
  user.press(Key::escape);
  user.settle();
  CHECK_FALSE(user.sees("typed.wrl cannot be opened"));
}

TEST_CASE("shows recent files on the start page after the only viewport is closed") {
  ScratchFolder scratch;
  const std::string path = scratch.write("kept.wrl", "#VRML V2.0 utf8\nShape { geometry Box { } }\n");
  Driver user;
  user.session().opening().open_in(0, path);
  REQUIRE(user.wait_for([&] { return user.session().view() != nullptr; }));
  user.settle();
  CHECK_FALSE(user.sees("Drop a file here"));
  user.press(letter_key('W'), true);
  user.settle();
  CHECK(user.session().view() == nullptr);
  CHECK(user.sees("Drop a file here"));
  REQUIRE(user.sees("kept.wrl"));
  user.press(letter_key('W'), true);  // nothing is left to close
  user.settle();
  CHECK(user.sees("Drop a file here"));
  user.click("kept.wrl");
  REQUIRE(user.wait_for([&] { return user.session().view() != nullptr; }));
}

TEST_CASE("shows a three-line introduction without arguments until it is closed") {
  ScratchFolder scratch;
  scratch.write("demo.wrl", "#VRML V2.0 utf8\nShape { geometry Box { } }\n");
  ViewerControllerOptions options;
  options.not_kept = scratch.path("demo.wrl");
  options.folders.settings_file = scratch.path("settings.conf");
  Driver user(std::move(options), {1400, 900});
  CHECK_FALSE(user.sees("Page Down next viewpoint"));
  user.session().opening().open_in(0, scratch.path("demo.wrl"));
  REQUIRE(user.wait_for([&] { return user.sees("Page Down next viewpoint"); }));
  CHECK(user.sees("Drop a file or press Ctrl+O"));
  // The ruler's text covers the introduction.
  bool measuring = true;
  user.set_model([&](UiModel& model) { model.tools.measuring = measuring; });
  user.settle();
  CHECK_FALSE(user.sees("Page Down next viewpoint"));
  measuring = false;
  user.settle();
  CHECK(user.sees("Page Down next viewpoint"));
  user.click("Got it");
  CHECK_FALSE(user.sees("Page Down next viewpoint"));
  CHECK_FALSE(user.controller().kept().settings().first_steps);
}

TEST_CASE("restores the splits, files and weights of a window that ended unexpectedly") {
  ScratchFolder scratch;
  scratch.write("a.wrl", "#VRML V2.0 utf8\nShape { geometry Box { } }\n");
  scratch.write("b.wrl", "#VRML V2.0 utf8\nShape { geometry Cone { } }\n");
  scratch.write("state/session-999999999.json",
                "{\"files\": [\"" + scratch.path("a.wrl") + "\", \"" + scratch.path("b.wrl") +
                    "\"], \"split\": \"2:3|(1/4)\", \"viewports\": [{\"number\": 2, \"file\": \"" +
                    scratch.path("b.wrl") + "\", \"weight\": 2}, {\"number\": 1, \"file\": \"" + scratch.path("a.wrl") +
                    "\", \"weight\": 1}, {\"number\": 4, \"file\": \"" + scratch.path("b.wrl") + "\"}]}");
  ViewerControllerOptions options;
  options.folders = {scratch.path("settings.conf"), scratch.path("bookmarks.json"), scratch.path("state")};
  Driver user(options);
  CHECK(user.sees("Open the 2 files that it showed?"));
  user.click("Open");
  CHECK(user.wait_for([&] {
    return shown(user, 0) == scratch.path("a.wrl") && shown(user, 1) == scratch.path("b.wrl") &&
           shown(user, 3) == scratch.path("b.wrl");
  }));
  CHECK(panes_of(user.session().panes().split()) == std::vector<std::size_t>{1, 0, 3});
  CHECK(place(user, 1).width == Approx(place(user, 0).width * 3).margin(3));
  CHECK(user.session().panes().at(1).weight == 2);
}

}  // namespace gs::app::viewports_ui_test
