// Tests of text fields of panels with right-to-left text.
#include "app/inspect/inspection.h"
#include "tests/app/interface/driver.h"
#include "vrml/scene/scene_graph.h"

#include <catch2/catch.hpp>

#include <string>

namespace gs::app::panel_fields_test {

using driver::Driver;

constexpr char32_t kAlef = 0x05D0, kBet = 0x05D1, kGimel = 0x05D2;

// Reports whether alef is right of bet and bet right of gimel. Returns nullopt if no font has these letters.
std::optional<bool> seen_from_right(const Driver& user) {
  const auto alef = user.place_of(kAlef), bet = user.place_of(kBet), gimel = user.place_of(kGimel);
  if (!alef || !bet || !gimel) return std::nullopt;
  return *gimel < *bet && *bet < *alef;
}

TEST_CASE("shows right-to-left text in the script console in visual order, runs it, and recalls it") {
  Driver user;
  user.show_world("DEF S Script { url \"javascript: ;\" }");
  user.press(letter_key('J'), true, true);
  user.click("Browser.getName()");
  user.type("'");
  user.type_letters(U"\u05d0\u05d1\u05d2");
  user.type("'");
  const auto typed = seen_from_right(user);
  if (!typed) return;  // no font of the system has these letters
  CHECK(*typed);
  user.press(Key::enter);
  const auto& lines = user.controller().inspection().console().lines();
  REQUIRE_FALSE(lines.empty());
  CHECK(lines.front().text == "'\u05d0\u05d1\u05d2'");
  user.controller().inspection().console().clear();
  user.settle();
  CHECK_FALSE(user.place_of(kAlef));
  user.press(Key::up);
  CHECK(seen_from_right(user) == true);
  user.press(Key::down);
  CHECK_FALSE(user.place_of(kAlef));
}

TEST_CASE("shows right-to-left text in the inspector in visual order, and sends it unchanged") {
  Driver user;
  user.show_world("Anchor { description \"\u05d0\u05d1\u05d2\" }");
  user.press(letter_key('I'), true, true);
  Inspection& inspection = user.controller().inspection();
  const vrml::SceneGraph& scene = *user.session().view()->document->world.scene;
  const vrml::NodeId node = scene.roots()[0];
  inspection.select({&scene, node}, false);
  user.settle();
  const auto alef = user.place_of(kAlef);
  if (!alef) return;
  CHECK(seen_from_right(user) == true);
  float line = 0;
  for (const driver::SeenCharacter& one : driver::seen_characters())
    if (one.character == kAlef) line = (one.top + one.bottom) / 2;
  // The text reads right to left, so the caret to the right of alef is before alef. Typed text stays during later
  // frames.
  user.click(glm::vec2(*alef + 20, line));
  // After the last letter, before the quotation mark.
  user.press(Key::end);
  user.press(Key::left);
  user.type("z");
  CHECK(seen_from_right(user) == true);
  CHECK(*user.place_of('z') > 0);
  user.press(Key::enter);
  user.settle();
  CHECK(std::string(scene.get<vrml::SFString>(node, "description").view()) == "\u05d0\u05d1\u05d2z");
}

}  // namespace gs::app::panel_fields_test
