#include "app/view/actions.h"

#include <catch2/catch.hpp>

#include <set>
#include <string>

namespace gs::app::actions_test {
namespace {

WindowEvent pressed(Key key, bool control = false, bool shift = false, bool alt = false) {
  return {.kind = WindowEvent::Kind::key_down, .key = key, .shift = shift, .control = control, .alt = alt, .paths = {}};
}

}  // namespace

TEST_CASE("has one row per action, with its own keys and a description") {
  std::set<std::string> keys;
  std::set<Action> seen;
  for (const ActionRow& row : actions()) {
    INFO(keys_of(row));
    if (row.key != Key::unknown) CHECK(keys.insert(keys_of(row)).second);
    CHECK(seen.insert(row.action).second);
    CHECK_FALSE(row.help.empty());
    CHECK(&row_of(row.action) == &row);
    CHECK_FALSE(title_of(row.menu).empty());
    if (row.key == Key::unknown) continue;
    const ActionRow* found = action_of(pressed(row.key, row.control, row.shift, row.alt));
    REQUIRE(found);
    CHECK(found->action == row.action);
  }
  CHECK(seen.size() == static_cast<std::size_t>(Action::quit) + 1);
}

TEST_CASE("distinguishes actions by modifier keys") {
  CHECK(action_of(pressed(letter_key('1')))->action == Action::examine);
  CHECK(action_of(pressed(letter_key('1'), true))->action == Action::viewport_1);
  CHECK(action_of(pressed(Key::tab, true, true))->action == Action::previous_file);
  CHECK(action_of(pressed(Key::plus, false, true))->action == Action::faster);  // on keyboards with Shift and +
  CHECK_FALSE(action_of(pressed(Key::tab)));
  CHECK_FALSE(action_of(pressed(letter_key('W'))));
  CHECK_FALSE(action_of(pressed(letter_key('F'), false, false, true)));
  CHECK(keys_of(row_of(Action::previous_file)) == "Ctrl+Shift+Tab");
  CHECK(action_of(pressed(letter_key('C'), true))->action == Action::copy_picture);
  CHECK(action_of(pressed(letter_key('C'), true, true))->action == Action::copy_camera);
  CHECK(action_of(pressed(letter_key('Z'), true, true))->action == Action::redo);
  CHECK(action_of(pressed(letter_key('Y'), true))->action == Action::redo);  // a second shortcut
  CHECK_FALSE(action_of(pressed(letter_key('Y'))));
  CHECK(all_keys_of(row_of(Action::redo)) == "Ctrl+Shift+Z, Ctrl+Y");
  CHECK(all_keys_of(row_of(Action::undo)) == "Ctrl+Z");
  CHECK(tooltip_of(Action::reset) == "Return to the viewpoint (Home)");
}

}  // namespace gs::app::actions_test
