#include "app/interface/panels/panels.h"

#include <catch2/catch.hpp>

#include <set>
#include <string_view>

namespace gs::app::panels_test {

TEST_CASE("each panel has a row with a name in settings, a title and an action of its own") {
  std::set<std::string_view> ids, titles;
  std::set<Action> toggles;
  for (std::size_t i = 0; i < panel_rows().size(); ++i) {
    const PanelRow& row = panel_rows()[i];
    INFO(row.id);
    CHECK(ids.insert(row.id).second);
    CHECK(titles.insert(row.title).second);
    CHECK(toggles.insert(row.toggle).second);
    // It stands in settings as it is.
    CHECK(row.id.find_first_not_of("abcdefghijklmnopqrstuvwxyz-") == std::string_view::npos);
    CHECK(panel_of(row.toggle) == i);
    CHECK(find_panel(row.id) == i);
    CHECK(row.make() != nullptr);
  }
  CHECK_FALSE(panel_of(Action::quit));
  CHECK_FALSE(find_panel("nothing"));
}

}  // namespace gs::app::panels_test
