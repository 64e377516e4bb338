// Tests of the menus in a small window.
#include "app/view/actions.h"

#include "app/interface/panels/panels.h"
#include "tests/app/interface/driver.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <string>

namespace gs::app::menus_test {

using driver::Driver;

constexpr glm::ivec2 kSmall{640, 480};

// Returns the label of a row, truncated as in the menu of a small window.
std::string words_of(const ActionRow& row) {
  const auto panel = panel_of(row.action);
  return std::string(panel ? panel_rows()[*panel].title : row.help).substr(0, 28);
}

// Scrolls if necessary, and reports whether a whole line is visible.
bool can_be_seen(Driver& user, const std::string& words, const glm::vec2& menu) {
  for (const float direction : {-4.0f, 4.0f})
    for (int i = 0; i < 4; ++i) {
      if (const auto place = user.find(words)) {
        const auto letters = driver::seen_characters();
        bool whole = place->x > 0 && place->x < kSmall.x;
        for (const driver::SeenCharacter& one : letters)
          if (std::abs((one.top + one.bottom) / 2 - place->y) < 1)
            whole = whole && one.top >= 0 && one.bottom <= kSmall.y;
        if (whole && place->y > 20) return true;
      }
      user.turn_wheel(menu, direction);
    }
  return false;
}

TEST_CASE("reaches every entry of every menu in a window of 640 x 480") {
  Driver user({}, kSmall);
  user.show_world("Viewpoint {} Viewpoint {} Shape { geometry Box {} }");
  for (std::size_t i = 0; i < kMenus; ++i) {
    const auto menu = static_cast<Menu>(i);
    const std::string title(title_of(menu));
    INFO(title);
    const auto head = user.find(title);
    REQUIRE(head);
    user.click(*head);
    const glm::vec2 inside = *head + glm::vec2(20, 60);
    for (const ActionRow& row : actions()) {
      if (row.menu != menu) continue;
      INFO(row.help << " in " << user.screen());
      CHECK(can_be_seen(user, words_of(row), inside));
    }
    user.press(Key::escape);
    user.press(Key::escape);
  }
}

TEST_CASE("runs the action of a submenu entry") {
  Driver user({}, {1200, 600});
  user.click("View");
  const auto words = user.find("Text size");
  REQUIRE(words);
  CHECK_FALSE(user.sees("Larger text"));
  user.click(*words);
  // The submenu is beside the menu, not over the clicked entry.
  REQUIRE(user.find("Larger text"));
  CHECK(user.find("Larger text")->x > words->x + 100);
  CHECK_FALSE(user.actions().run);
  user.click("Larger text");
  REQUIRE(user.actions().run);
  CHECK(*user.actions().run == Action::larger_text);
}

TEST_CASE("lists Quit last in its menu") {
  Driver user({}, {1000, 500});
  user.click("File");
  const auto quit = user.find("Quit"), pictures = user.find("Pictures"), recent = user.find("Open recent");
  REQUIRE((quit && pictures && recent));
  CHECK(quit->y > pictures->y);
  CHECK(quit->y > recent->y);
}

TEST_CASE("hides the loading state while a series plays") {
  Driver user;
  user.show_world("Shape { geometry Box {} }");
  bool playing = false;
  user.set_model([&](UiModel& model) {
    REQUIRE_FALSE(model.viewports.empty());
    model.viewports[0].loading = "run.%04d.qnv";
    model.tools.playing = playing;
  });
  user.settle();
  CHECK(user.sees("Loading run"));
  playing = true;
  user.settle();
  CHECK_FALSE(user.sees("Loading run"));
}

}  // namespace gs::app::menus_test
