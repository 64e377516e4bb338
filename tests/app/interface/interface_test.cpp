#include "app/interface/panels/panels.h"
#include "app/desktop/hand_over.h"
#include "tests/app/interface/driver.h"
#include "tests/app/late_worlds.h"
#include "tests/app/scratch_folder.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <string>
#include <thread>

// Tests of the interface as a user operates it: clicks, text, drags, and their effects.
namespace gs::app::interface_test {

using driver::Driver;

constexpr char kTwoViewpoints[] =
    "NavigationInfo { type [ \"FLY\" \"ANY\" ] } DEF A Viewpoint { description \"Entrance\" } DEF B Viewpoint { "
    "description \"Roof\" position 0 20 10 } "
    "Shape { geometry Box { } }";

TEST_CASE("lists every action in a menu with its key, and runs it from there") {
  Driver user;
  user.show_world(kTwoViewpoints);
  for (std::size_t i = 0; i < kMenus; ++i) {
    const auto menu = static_cast<Menu>(i);
    user.click(title_of(menu));
    for (const ActionRow& row : actions()) {
      if (row.menu != menu) continue;
      const auto panel = panel_of(row.action);
      INFO(row.help << " in " << user.screen());
      if (!row.group.empty() && !user.sees(row.help)) user.click(row.group);  // a submenu
      CHECK(user.sees(panel ? panel_rows()[*panel].title : row.help));
      if (row.key != Key::unknown) CHECK(user.sees(keys_of(row)));
    }
    user.press(Key::escape);
  }
  user.click("Navigate");
  user.click("Next viewpoint");
  CHECK(user.session().view()->viewpoint == 1);
  user.click("Window");
  user.click("Full screen");
  CHECK(user.full_screens() == 1);
  user.click("File");
  user.click("Quit");
  CHECK(user.closed());
}

TEST_CASE("finds actions, Viewpoints and panels in the palette by a part of their names") {
  Driver user;
  user.show_world(kTwoViewpoints);
  user.press(letter_key('P'), true, true);
  user.type("roof");
  CHECK(user.sees("Viewpoint: Roof"));
  CHECK_FALSE(user.sees("Full screen"));
  user.press(Key::enter);
  CHECK(user.session().view()->viewpoint == 1);
  CHECK_FALSE(user.sees("Viewpoint: Roof"));
  // If nothing matches, further typing still goes to the palette.
  user.press(letter_key('P'), true, true);
  user.type("qqzz");
  user.press(Key::enter);
  CHECK(user.sees("No matches."));
  user.type("r");
  CHECK(user.sees("qqzzr"));
  CHECK_FALSE(user.sees("Click the first point"));
  user.press(Key::escape);
  // Arrow keys move through the matches, and do not reach the world.
  const glm::dvec3 before = user.session().view()->navigation.pose.position;
  user.press(letter_key('P'), true, true);
  user.type("viewpoint:");
  user.press(Key::down);
  user.press(Key::up);
  user.press(Key::enter);
  user.wait(1);
  CHECK(user.session().view()->viewpoint == 0);
  CHECK(user.session().view()->navigation.pose.position != before);
  user.press(letter_key('P'), true, true);
  user.type("panel log");
  user.press(Key::enter);
  CHECK(user.sees("0 errors"));
  user.press(letter_key('P'), true, true);
  user.type("nothing is called so");
  CHECK(user.sees("No matches."));
  user.press(Key::escape);
  CHECK_FALSE(user.sees("No matches."));
}

TEST_CASE("takes the space of a panel from the picture, and returns it") {
  Driver user;
  user.show_world(kTwoViewpoints);
  const Viewport whole = user.picture();
  user.press(Key::f3);
  CHECK(user.sees("0 errors"));
  const Viewport beside = user.picture();
  CHECK(beside.height < whole.height);
  CHECK(beside.top == whole.top);
  // The session draws in the area that the panels leave.
  CHECK(user.frame().pictures.front().place.height == beside.height);
  // Dragging the divider of the panel resizes the picture.
  const auto edge = static_cast<float>(beside.top + beside.height) + 2;
  user.drag({500, edge}, {500, edge - 100});
  CHECK(user.picture().height == Approx(beside.height - 100).margin(2));
  user.press(Key::f4);
  CHECK(user.sees("Transfer function"));
  CHECK(user.picture().width < whole.width);
  user.press(Key::f3);
  user.press(Key::f4);
  CHECK(user.picture().height == whole.height);
  CHECK(user.picture().width == whole.width);
}

TEST_CASE("enlarges text and buttons on Ctrl+plus, and changes colours, at once and permanently") {
  ScratchFolder scratch;
  ViewerControllerOptions options;
  options.folders = {scratch.path("settings.conf"), scratch.path("bookmarks.json"), scratch.path("state")};
  const auto bar = [](Driver& user) { return user.picture().top; };
  int larger = 0;
  {
    Driver user(options);
    const int before = bar(user);
    user.press(Key::plus, true);
    user.press(Key::plus, true);
    larger = bar(user);
    CHECK(larger > before);
    user.press(letter_key('P'), true, true);
    user.type("light theme");
    user.press(Key::enter);
    CHECK(user.controller().kept().settings().theme == Theme::light);
  }
  {
    Driver user(options);
    CHECK(bar(user) == larger);
    CHECK(user.controller().kept().settings().theme == Theme::light);
    user.press(letter_key('0'), true);
    CHECK(bar(user) < larger);
  }
}

TEST_CASE("shows names of any script by system fonts") {
  Driver user;
  user.show_world(
      "Viewpoint { description \"\xE4\xBD\xA0\xE5\xA5\xBD \xCE\x91\xCE\xB8\xCE\xAE\xCE\xBD\xCE\xB1\" } Shape { }");
  user.step();
  const ImFont& font = *ImGui::GetFont();
  CHECK(font.FindGlyphNoFallback(0x0391));  // the first font has Greek
  // If the system has a Chinese font, its glyphs are made on demand.
  const bool has_chinese = font.FindGlyphNoFallback(0x4F60) != nullptr;
  if (has_chinese) CHECK(font.FindGlyphNoFallback(0x597D));
  CHECK_FALSE(font.FindGlyphNoFallback(0x4F61));  // not requested yet
}

TEST_CASE("goes back and forward through visited worlds and viewer positions") {
  Driver user;
  user.show_world(kTwoViewpoints, "first.wrl");
  user.session().camera().bind_viewpoint(1);
  user.wait(1);
  const glm::dvec3 roof = user.session().view()->navigation.pose.position;
  user.show_world("Shape { geometry Sphere { } }", "second.wrl");
  CHECK(user.session().panes().at(0).shown == "second.wrl");
  user.press(Key::left, false, false, true);
  CHECK(user.session().panes().at(0).shown == "first.wrl");
  CHECK(user.session().view()->navigation.pose.position == roof);
  CHECK_FALSE(user.session().travel().can_go(-1));
  user.press(Key::right, false, false, true);
  CHECK(user.session().panes().at(0).shown == "second.wrl");
  CHECK_FALSE(user.session().travel().can_go(1));
  user.press(Key::left, false, false, true);
  user.show_world("Shape { geometry Cone { } }", "third.wrl");
  CHECK_FALSE(user.session().travel().can_go(1));  // a new destination drops the forward history
}

TEST_CASE("goes back after an Anchor to the earlier position") {
  Driver user;
  user.show_world(
      "NavigationInfo { type [ \"FLY\" \"ANY\" ] } Viewpoint { } DEF B Viewpoint { position 0 0 30 } "
      "Anchor { url \"#B\" children Shape { geometry Box { size 4 4 4 } } }");
  const auto depth = [&] { return user.session().view()->navigation.pose.position.z; };
  CHECK(depth() == 10);  // VRML97 6.53: the default position
  const Viewport picture = user.picture();
  user.click(glm::vec2(picture.left + picture.width / 2, picture.top + picture.height / 2));
  user.wait(1);
  CHECK(depth() == Approx(30));
  user.press(Key::left, false, false, true);
  user.wait(1);
  CHECK(depth() == Approx(10));
  user.press(Key::right, false, false, true);
  user.wait(1);
  CHECK(depth() == Approx(30));
}

TEST_CASE("stores file and position in a bookmark, and returns there") {
  ScratchFolder scratch;
  ViewerControllerOptions options;
  options.folders = {scratch.path("settings.conf"), scratch.path("bookmarks.json"), scratch.path("state")};
  Driver user(options);
  user.show_world(kTwoViewpoints);
  user.session().view()->navigation.pose.position = {1, 2, 3};
  user.press(letter_key('D'), true);
  REQUIRE(user.controller().kept().bookmarks().size() == 1);
  CHECK(user.controller().kept().bookmarks()[0].place == absolute_place("test.wrl"));
  CHECK(user.controller().kept().bookmarks()[0].viewpoint == "Entrance");
  user.session().view()->navigation.pose.position = {9, 9, 9};
  user.step();
  user.click("Bookmarks");
  user.click("test.wrl: Entrance");
  user.wait(0.2);
  CHECK(user.session().view()->navigation.pose.position == glm::dvec3(1, 2, 3));
  user.press(letter_key('D'), true);  // removes the bookmark of this view
  CHECK(user.controller().kept().bookmarks().empty());
  const auto kept = read_bookmarks(scratch.read("bookmarks.json"));
  REQUIRE(kept);
  CHECK(kept->empty());
}

TEST_CASE("stores the projection in a bookmark") {
  ScratchFolder scratch;
  ViewerControllerOptions options;
  options.folders = {scratch.path("settings.conf"), scratch.path("bookmarks.json"), scratch.path("state")};
  Driver user(options);
  user.show_world(kTwoViewpoints);
  user.press(letter_key('O'));
  REQUIRE(user.session().view()->style.parallel);
  user.session().view()->navigation.pose.position = {1, 2, 3};
  user.session().view()->navigation.pose.height = 7;
  user.press(letter_key('D'), true);
  const auto kept = read_bookmarks(scratch.read("bookmarks.json"));
  REQUIRE(kept);
  REQUIRE(kept->size() == 1);
  CHECK(kept->front().camera.size() == Bookmark::kParallelNumbers);
  user.press(letter_key('O'));
  REQUIRE_FALSE(user.session().view()->style.parallel);
  user.click("Bookmarks");
  user.click("test.wrl: Entrance");
  user.wait(0.2);
  CHECK(user.session().view()->style.parallel);
  CHECK(user.session().view()->navigation.pose.height == Approx(7));
  CHECK(glm::distance(user.session().view()->navigation.pose.position, glm::dvec3(1, 2, 3)) < 1e-9);
}

TEST_CASE("completes text in the address bar, and opens it") {
  ScratchFolder scratch;
  scratch.write("worlds/castle.wrl", "#VRML V2.0 utf8\nShape { geometry Box { } }\n");
  scratch.write("worlds/notes.txt", "nothing to be opened");
  Driver user;
  user.press(letter_key('L'), true);
  user.type(scratch.path("wor"));
  CHECK(user.sees("worlds/"));
  user.press(Key::tab);
  user.type("ca");
  CHECK(user.sees("castle.wrl"));
  CHECK_FALSE(user.sees("notes.txt"));
  user.press(Key::down);
  user.press(Key::enter);
  REQUIRE(user.actions().open);
  CHECK(*user.actions().open == scratch.path("worlds/castle.wrl"));
}

TEST_CASE("filters the Open dialog during typing") {
  ScratchFolder scratch;
  scratch.write("castle.wrl", "#VRML V2.0 utf8\nShape { geometry Box { } }\n");
  scratch.write("tower.wrl", "#VRML V2.0 utf8\nShape { geometry Box { } }\n");
  Driver user;
  user.press(letter_key('O'), true);
  user.type(scratch.path(""));
  CHECK(user.sees("castle.wrl"));
  CHECK(user.sees("tower.wrl"));
  user.type("ower");
  CHECK(user.sees("tower.wrl"));
  CHECK_FALSE(user.sees("castle.wrl"));
  user.press(Key::enter);  // found by a part of its name
  REQUIRE(user.actions().open);
  CHECK(*user.actions().open == scratch.path("tower.wrl"));
}

TEST_CASE("keeps the Open dialog after a failure, and accepts another name") {
  Driver user;
  user.press(letter_key('O'), true);
  user.type("/nowhere/at/all.wrl");
  user.press(Key::enter);
  bool failed = false;
  for (int i = 0; i < 5000 && !failed; ++i) {
    user.step();
    failed = user.sees("cannot open /nowhere/at/all.wrl");  // a later step may no longer show it
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  REQUIRE(failed);
  user.settle();
  CHECK(user.sees("All files"));
  user.type("x");
  CHECK(user.sees("/nowhere/at/all.wrlx"));
  user.press(Key::escape);
  CHECK_FALSE(user.sees("All files"));
}

TEST_CASE("continues typing in the address bar after an address failed to open") {
  Driver user;
  user.show_world(kTwoViewpoints);
  const NavigationMode mode = user.session().view()->navigation.mode;
  user.press(letter_key('L'), true);
  user.type("/nowhere/at/all.wrl");
  user.press(Key::enter);
  REQUIRE(user.wait_for([&] { return user.sees("cannot be opened"); }));
  user.settle();
  user.type("13");
  INFO(user.screen());
  CHECK(user.sees("/nowhere/at/all.wrl13"));
  CHECK(user.session().view()->navigation.mode == mode);
  user.press(Key::escape);
  CHECK_FALSE(user.sees("/nowhere/at/all.wrl13"));
  CHECK(user.sees("test.wrl"));
}

TEST_CASE("shows right-to-left input in visual order, with the pointer at the visual position") {
  Driver user;
  user.press(letter_key('L'), true);
  user.type("a");
  user.type_letters(U"\u05d0\u05d1\u05d2");  // Alef, Bet, Gimel
  user.type("z");
  user.settle();
  const auto a = user.place_of('a'), alef = user.place_of(0x05D0), bet = user.place_of(0x05D1),
             gimel = user.place_of(0x05D2);
  if (!alef || !bet || !gimel) return;  // no font of the system has these letters
  REQUIRE(a);
  CHECK(*a < *gimel);
  CHECK(*gimel < *bet);
  CHECK(*bet < *alef);
  // The text reads right to left. So a click between the two rightmost letters puts the caret between the first two.
  const float line = user.find("z")->y;
  user.click(glm::vec2(*alef - 1, line));
  user.type("1");
  CHECK(user.controller().ui().clipboard().empty());
  user.press(letter_key('A'), true);
  user.press(letter_key('C'), true);
  CHECK(user.controller().ui().clipboard() ==
        "a\u05d0"
        "1\u05d1\u05d2z");
}

TEST_CASE("shows one speed when the speed is raised repeatedly") {
  Driver user;
  user.show_world(kTwoViewpoints);
  for (int i = 0; i < 4; ++i) user.press(Key::plus);
  const std::string screen = user.screen();
  INFO(screen);
  const std::size_t first = screen.find("m/s");
  REQUIRE(first != std::string::npos);
  CHECK(screen.find("m/s", first + 1) == std::string::npos);
}

TEST_CASE("cancels loading on Esc before it closes panels") {
  late_worlds::Site site;
  site.never("late.wrl");
  Driver user({}, {1000, 700}, site.options);
  user.press(Key::f3);
  user.session().opening().open_files({"memory://a/late.wrl"});
  user.step();
  user.controller().ui().show_notice("to be read", false);
  REQUIRE(user.session().panes().loading(0));
  user.press(Key::escape);
  CHECK_FALSE(user.session().panes().loading(0));
  CHECK(user.sees("to be read"));
  CHECK(user.sees("0 errors"));
}

TEST_CASE("lists the errors of the newest file first in the log") {
  Driver user;
  SessionLog log;
  const auto note = [&](const std::string& path, int errors) {
    Diagnostics diagnostics;
    for (int i = 1; i <= errors; ++i)
      diagnostics.add({Severity::error, path, {static_cast<std::uint32_t>(i), 1}, "wrong"});
    log.note(path, diagnostics);
  };
  note("first.wrl", 60);
  user.set_model([&](UiModel& model) { model.log = &log; });
  user.press(Key::f3);
  CHECK(user.sees("60 errors"));
  CHECK(user.sees("first.wrl:1:1"));
  note("second.wrl", 1);
  user.settle();
  CHECK(user.sees("second.wrl:1:1"));
  CHECK(user.sees("first.wrl:60:1"));
  CHECK_FALSE(user.sees("first.wrl:1:1"));
}

TEST_CASE("shows notices without an open file in the picture, not over the log") {
  Driver user({}, {1000, 320});
  CHECK(user.sees("Drop a file here"));
  user.press(Key::f3);
  const auto place = user.find("Drop a file here");
  CHECK((!place || place->y < static_cast<float>(user.picture().top + user.picture().height)));
  CHECK(user.sees("No file is loaded."));
}

TEST_CASE("offers once to restore a window that ended unexpectedly, in one line") {
  Driver user;
  std::vector<std::string> files{"/scans/head.nrrd"};
  user.set_model([&](UiModel& model) { model.to_restore = files; });
  user.settle();
  CHECK(user.sees("Open /scans/head.nrrd again?"));
  files.push_back("/scans/hand.nrrd");
  user.settle();
  const int top = user.picture().top;
  CHECK(user.sees("Open the 2 files that it showed?"));
  files.clear();
  user.settle();
  CHECK(user.picture().top < top);  // the picture has its space again
}

TEST_CASE("lists the settings of the table in Preferences") {
  Driver user;
  user.press(letter_key(','), true);
  for (const SettingRow& row : setting_rows()) {
    INFO(row.label << " in " << user.screen());
    CHECK(user.sees(row.label));
  }
  const auto choices = user.find("dark light");
  REQUIRE(choices);
  user.click(*choices + glm::vec2(25, 0));
  CHECK(user.controller().kept().settings().theme == Theme::light);
  user.click("Restore defaults");
  CHECK(user.controller().kept().settings() == UserSettings{});
  user.press(Key::escape);
  CHECK_FALSE(user.sees("Restore defaults"));
}

}  // namespace gs::app::interface_test
