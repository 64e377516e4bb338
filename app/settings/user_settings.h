#pragma once

#include "app/formats/common/upright.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gs::app {

enum class Theme : std::uint8_t { dark, light };

/// Settings that the user has chosen.
struct UserSettings {
  Theme theme = Theme::dark;
  double text_size = 1;  // factor on the text size of the screen
  double speed = 1;  // factor on the speed of the viewer that a world sets
  bool sound = true;  // sound is on when a window opens
  bool system_dialog = true;  // the Open command uses the dialog of the desktop, if there is one
  bool offers_to_restore = true;  // after a crash, offers to open the files of the crashed window
  bool writes_log = true;  // keeps a log on disk
  UpAxis up = UpAxis::automatic;  // up axis of opened files
  bool backdrop = true;  // draws a gradient behind files other than VRML97 worlds
  bool axes = true;  // draws the axes widget in a corner of the picture
  bool first_steps = true;  // shows the hints for beginners over the demo world, until the user closes them
  double memory = 2;  // approximate limit for each opened world, in GiB
  std::size_t budget = 0;  // max vectors in all viewports together; 0 means the default

  bool operator==(const UserSettings&) const = default;
};

/// Row of the table of settings. The settings file, the preferences dialog and the manual are made from it.
struct SettingRow {
  enum class Kind : std::uint8_t { flag, number, choice };

  std::string_view name;  // name in the settings file
  std::string_view label;  // label in the preferences dialog
  Kind kind;
  std::string_view choices;    // of a choice: "dark light "; of a flag: "on off "
  double least = 0, most = 0;  // range of a number
  bool whole = false;  // a number must be an integer
  std::string_view help;  // explanation, one line
  /// Returns the value as text, in the form of the settings file.
  std::string (*get)(const UserSettings& settings);
  /// Sets the value from a text that is valid for this row.
  void (*set)(UserSettings& settings, std::string_view text);
};
[[nodiscard]] std::span<const SettingRow> setting_rows();
[[nodiscard]] const SettingRow* find_setting(std::string_view name);
/// Returns the default value of a setting as text.
[[nodiscard]] std::string standard_of(const SettingRow& row);
/// Sets a value. If `text` is invalid, changes nothing and returns a description of the valid values; otherwise returns
/// nullopt.
[[nodiscard]] std::optional<std::string> set_setting(UserSettings& settings, const SettingRow& row,
                                                     std::string_view text);

/// Result of parsing a settings file.
struct ReadSettings {
  UserSettings settings;
  std::vector<std::string> problems;  // "LINE: error: problem; expected form"; other lines are applied
};
/// Parses lines of the form `name = value`. Ignores blank lines and lines that begin with #. Safe for untrusted bytes.
[[nodiscard]] ReadSettings read_settings(std::string_view text);
/// Returns the text of a settings file with all settings and their explanations as comments. A setting with its default
/// value is itself commented out.
[[nodiscard]] std::string settings_text(const UserSettings& settings);

}  // namespace gs::app
