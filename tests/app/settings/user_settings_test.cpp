#include "app/settings/user_settings.h"

#include <catch2/catch.hpp>

#include <set>
#include <string>
#include <string_view>

namespace gs::app::user_settings_test {

TEST_CASE("has one row per setting, with name, label, help and a valid default") {
  std::set<std::string_view> names, labels;
  for (const SettingRow& row : setting_rows()) {
    INFO(row.name);
    CHECK(names.insert(row.name).second);
    CHECK(labels.insert(row.label).second);
    CHECK_FALSE(row.help.empty());
    UserSettings settings;
    CHECK_FALSE(set_setting(settings, row, standard_of(row)));
    CHECK(settings == UserSettings{});
    CHECK(set_setting(settings, row, "nonsense"));
    CHECK(set_setting(settings, row, ""));
    CHECK(settings == UserSettings{});
    CHECK(find_setting(row.name) == &row);
  }
}

TEST_CASE("writes settings and reads them back") {
  UserSettings settings;
  settings.theme = Theme::light;
  settings.text_size = 1.3;
  settings.sound = false;
  settings.budget = 500'000;
  const ReadSettings back = read_settings(settings_text(settings));
  CHECK(back.problems.empty());
  CHECK(back.settings == settings);
  // Defaults are written as comments, so that defaults of another version apply.
  CHECK(settings_text(UserSettings{}).find("\n#theme = dark\n") != std::string::npos);
  CHECK(settings_text(settings).find("\ntheme = light\n") != std::string::npos);
}

TEST_CASE("ignores only invalid lines, and reports the expected values") {
  const ReadSettings read = read_settings(
      "# mine\n theme=light\r\n\nspeed = fast\ntext-size = 99\nbudget = 1.5\nunheard-of = 1\nwithout a sign\nsound = "
      "off");
  CHECK(read.settings.theme == Theme::light);
  CHECK_FALSE(read.settings.sound);
  CHECK(read.settings.speed == 1);
  REQUIRE(read.problems.size() == 5);
  CHECK(read.problems[0] == "4: error: speed = \"fast\": expected a number from 0.01 to 100");
  CHECK(read.problems[1] == "5: error: text-size = \"99\": expected a number from 0.7 to 2.5");
  CHECK(read.problems[2] == "6: error: budget = \"1.5\": expected a whole number from 0 to 1e+09");
  CHECK(read.problems[3] == "7: error: there is no setting \"unheard-of\"");
  CHECK(read.problems[4] == "8: error: \"without a sign\": expected name = value");
}

TEST_CASE("survives any bytes in a settings file") {
  std::string all = settings_text(UserSettings{});
  for (std::size_t i = 0; i < all.size(); i += 7) {
    std::string spoilt = all;
    spoilt[i] = static_cast<char>(i * 37);
    (void)read_settings(spoilt);
    (void)read_settings(std::string_view(all).substr(0, i));
  }
  CHECK(read_settings(std::string(100'000, '=')).problems.size() == 1);
  CHECK(read_settings(std::string(1000, '\n') + "x").problems.size() == 1);
  std::string many;
  for (int i = 0; i < 1000; ++i) many += "x\n";
  CHECK(read_settings(many).problems.size() <= 20);
}

}  // namespace gs::app::user_settings_test
