#include "app/interface/panels/panels.h"

#include "tests/app/interface/driver.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <set>
#include <string_view>
#include <vector>

namespace gs::app::panels_test {

using driver::Driver;

TEST_CASE("has one row per panel, with a setting, a title and an action") {
  std::set<std::string_view> ids, titles;
  std::set<Action> toggles;
  for (std::size_t i = 0; i < panel_rows().size(); ++i) {
    const PanelRow& row = panel_rows()[i];
    INFO(row.id);
    CHECK(ids.insert(row.id).second);
    CHECK(titles.insert(row.title).second);
    CHECK(toggles.insert(row.toggle).second);
    // Used as a name in settings.
    CHECK(row.id.find_first_not_of("abcdefghijklmnopqrstuvwxyz-") == std::string_view::npos);
    CHECK(panel_of(row.toggle) == i);
    CHECK(find_panel(row.id) == i);
    CHECK(row.make() != nullptr);
  }
  CHECK_FALSE(panel_of(Action::quit));
  CHECK_FALSE(find_panel("nothing"));
}

TEST_CASE("shows the progress of saving pictures beside its bar, not over it") {
  Driver user;
  user.show_world("Shape { geometry Box {} }");
  user.click("File");
  user.click("Pictures");
  std::vector<glm::vec2> places;
  for (const float done : {0.05f, 0.95f}) {
    user.set_model([done](UiModel& model) { model.tools.exporting = done; });
    user.settle();
    const auto place = user.find(done < 0.5f ? "5 %" : "95 %"), cancel = user.find("Cancel");
    REQUIRE((place && cancel));
    CHECK(place->x < cancel->x);
    CHECK(cancel->x - place->x < 70);
    places.push_back(*place);
  }
  CHECK(std::abs(places[0].x - places[1].x) < 20);
}

TEST_CASE("shows an empty panel's notice within its width") {
  Driver user({}, {700, 500});
  user.show_world("Shape { geometry Box {} }");
  user.press(Key::f4);
  user.settle();
  INFO(user.screen());
  const auto first = user.find("This world"), last = user.find("opacity.");
  REQUIRE((first && last));
  CHECK(last->y > first->y);  // on separate lines
  CHECK(last->x < 700);
}

}  // namespace gs::app::panels_test
