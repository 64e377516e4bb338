#include "app/viewer/saving/world_saver.h"

#include "tests/app/interface/driver.h"
#include "tests/app/scratch_folder.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <string>
#include <string_view>

namespace gs::app::world_saver_test {
namespace {

constexpr std::string_view kHeader = "#VRML V2.0 utf8\n";
constexpr const char* kRoom =
    "#VRML V2.0 utf8\n# my room\nViewpoint { position 0 0 9 }\nDEF Table Transform { translation 1 0 0 children Shape "
    "{ "
    "geometry Box { } } }\n";

/// User with an open file.
struct Desk {
  // `clocked` starts the world at the time of the user, not at the present time.
  explicit Desk(bool clocked = false) : path(folder.write("room.wrl", kRoom)) {
    if (clocked)
      user.show_world(std::string(kRoom).substr(kHeader.size()), path);
    else
      user.session().opening().open_files({path});
    REQUIRE(user.wait_for([&] { return user.session().view() != nullptr; }));
    user.press(letter_key('I'), true, true);
  }
  void edit(const std::string& value) {
    const vrml::SceneGraph& scene = *user.session().view()->document->world.scene;
    Inspection& inspection = user.controller().inspection();
    for (std::uint32_t i = 1; i <= scene.nodes().count(); ++i)
      if (scene.nodes().at(i).name == "Table") inspection.select({&scene, scene.nodes().id_at(i)}, false);
    REQUIRE(inspection.selected());
    user.settle();
    const auto& type = *scene.node(inspection.selected().id).type;
    CHECK(inspection.editor().send_text(*type.find("translation"), value).value_or("") == "");
    inspection.editor().end_gesture();
    user.settle();
  }
  [[nodiscard]] float place() {
    const vrml::SceneGraph& scene = *user.session().view()->document->world.scene;
    for (std::uint32_t i = 1; i <= scene.nodes().count(); ++i)
      if (scene.nodes().at(i).name == "Table") return scene.get<vrml::SFVec3f>(scene.nodes().id_at(i), "translation").x;
    return -1;
  }
  [[nodiscard]] bool edited() { return user.controller().title().find(", edited") != std::string::npos; }
  // Replaces the text of the dialog.
  void enter(const std::string& name) {
    user.press(letter_key('A'), true);
    user.type(folder.path(name));
    user.press(Key::enter);
    user.settle();
  }

  ScratchFolder folder;
  std::string path;
  driver::Driver user;
};

}  // namespace

TEST_CASE("undoes and redoes edits and movements in their order") {
  Desk desk(true);
  desk.edit("2 0 0");
  CHECK(desk.place() == 2);
  desk.user.wait(1);
  desk.user.press(letter_key('1'));  // Examine
  const glm::vec2 middle(400, 400);
  desk.user.drag(middle, middle + glm::vec2(80, 0));
  desk.user.wait(1);
  const glm::dvec3 moved = desk.user.session().view()->navigation.pose.position;
  CHECK(std::abs(moved.x) > 0.1);
  desk.edit("3 0 0");
  desk.user.press(letter_key('Z'), true);
  CHECK(desk.place() == 2);
  CHECK(desk.user.session().view()->navigation.pose.position == moved);
  desk.user.press(letter_key('Z'), true);
  desk.user.wait(2);
  CHECK(desk.place() == 2);
  CHECK(desk.user.session().view()->navigation.pose.position.x == Approx(0).margin(0.01));
  desk.user.press(letter_key('Z'), true);
  CHECK(desk.place() == 1);
  CHECK_FALSE(desk.edited());
  desk.user.press(letter_key('Y'), true);
  CHECK(desk.place() == 2);
  desk.user.press(letter_key('Z'), true, true);
  desk.user.wait(2);
  CHECK(desk.user.session().view()->navigation.pose.position.x == Approx(moved.x).margin(0.01));
  desk.user.press(letter_key('Z'), true, true);
  CHECK(desk.place() == 3);
}

TEST_CASE("saves an edited world, and asks before it replaces a file") {
  Desk desk;
  CHECK_FALSE(desk.edited());
  desk.edit("2 0 0");
  CHECK(desk.edited());
  desk.user.press(letter_key('S'), true);
  CHECK(desk.user.sees("Save as"));
  desk.enter("copy");
  const std::string changed = "DEF Table Transform { translation 2 0 0 children";
  CHECK(desk.folder.read("copy.wrl").find(changed) != std::string::npos);
  CHECK(desk.folder.read("copy.wrl").find("# my room") != std::string::npos);
  CHECK(desk.user.sees("Saved: "));
  CHECK_FALSE(desk.edited());
  desk.edit("3 0 0");
  desk.user.press(letter_key('S'), true);
  desk.enter("room.wrl");
  REQUIRE(desk.user.sees("The file already exists:"));
  CHECK(desk.folder.read("room.wrl") == kRoom);
  desk.user.click("Cancel");
  CHECK(desk.folder.read("room.wrl") == kRoom);
  CHECK(desk.edited());
  desk.user.press(letter_key('S'), true);
  desk.enter("room.wrl");
  desk.user.click("Replace");
  CHECK(desk.folder.read("room.wrl").find("translation 3 0 0") != std::string::npos);
  CHECK_FALSE(desk.edited());
  desk.edit("4 0 0");  // still relative to the text before the first edit
  desk.user.press(letter_key('S'), true);
  desk.enter("room.wrl");
  desk.user.click("Replace");
  CHECK(desk.folder.read("room.wrl").find("translation 4 0 0") != std::string::npos);
}

TEST_CASE("keeps the world edited if it cannot be saved") {
  Desk desk;
  desk.edit("2 0 0");
  desk.user.press(letter_key('S'), true);
  desk.enter("none/room.wrl");
  CHECK(desk.user.sees("Cannot save"));
  CHECK(desk.edited());
}

TEST_CASE("asks before the window closes with unsaved edits") {
  Desk desk;
  CHECK(desk.user.controller().may_close());
  desk.edit("2 0 0");
  desk.user.press(letter_key('Q'), true);
  CHECK_FALSE(desk.user.closed());
  REQUIRE(desk.user.sees("has changes that are not saved"));
  desk.user.press(Key::escape);
  CHECK_FALSE(desk.user.sees("has changes that are not saved"));
  CHECK_FALSE(desk.user.closed());
  desk.user.press(letter_key('Q'), true);
  desk.user.click("Save as");
  desk.enter("copy.wrl");
  CHECK(desk.user.closed());
  CHECK(desk.folder.read("copy.wrl").find("translation 2 0 0") != std::string::npos);
}

TEST_CASE("closes the window without saving if the user discards the edits") {
  Desk desk;
  desk.edit("2 0 0");
  desk.user.press(letter_key('Q'), true);
  desk.user.click("Discard changes");
  CHECK(desk.user.closed());
  CHECK(desk.user.controller().may_close());
  CHECK(desk.folder.read("room.wrl") == kRoom);
}

TEST_CASE("asks before a reload or the closing of a viewport loses edits") {
  Desk desk;
  desk.edit("2 0 0");
  desk.user.press(Key::f5);
  REQUIRE(desk.user.sees("has changes that are not saved"));
  desk.user.click("Cancel");
  CHECK(desk.place() == 2);
  desk.user.session().opening().open_files({desk.path});  // opening the file again keeps the edits
  desk.user.settle();
  CHECK(desk.place() == 2);
  desk.user.press(Key::right, true, true);  // both halves show the world
  desk.user.press(letter_key('W'), true);
  CHECK_FALSE(desk.user.sees("has changes that are not saved"));
  const std::string other = desk.folder.write("other.wrl", "#VRML V2.0 utf8\nGroup { }\n");
  desk.user.press(Key::right, true, true);
  desk.user.session().opening().open_files({other});
  REQUIRE(desk.user.wait_for([&] { return desk.user.session().view()->document->world.path == other; }));
  desk.user.press(letter_key('1'), true);
  desk.user.press(letter_key('W'), true);
  REQUIRE(desk.user.sees("has changes that are not saved"));
  desk.user.click("Discard changes");
  CHECK(desk.user.session().panes().visible().size() == 1);
  desk.user.press(Key::tab, true);
  REQUIRE(desk.user.wait_for([&] { return desk.user.session().view()->document->world.path == desk.path; }));
  CHECK(desk.user.wait_for([&] { return desk.place() == 1; }));  // read again
}

TEST_CASE("closes the message about a file that cannot be opened after Esc") {
  Desk desk;
  desk.user.session().opening().open_files({desk.folder.write("bad.wrl", "no world")});
  REQUIRE(desk.user.wait_for([&] { return desk.user.sees("cannot be opened"); }));
  for (int i = 0; i < 4; ++i) desk.user.press(Key::escape);
  CHECK_FALSE(desk.user.sees("cannot be opened"));
}

}  // namespace gs::app::world_saver_test
