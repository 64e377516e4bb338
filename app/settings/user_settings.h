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
  double text_size = 1;           // factor on the screen's text size
  double speed = 1;               // factor on the worlds' viewer speed
  bool sound = true;              // at the start of a window
  bool system_dialog = true;      // opens files with the desktop's dialog, if there is one
  bool offers_to_restore = true;  // files of a window that ended unexpectedly
  bool writes_log = true;         // to a file
  UpAxis up = UpAxis::automatic;  // of files that are opened
  bool backdrop = true;           // gradient if the world has no Background
  bool axes = true;               // in a corner of the picture
  bool first_steps = true;        // three lines over the demo world, until the user closes them
  double memory = 2;              // GiB for each opened world, approximately
  std::size_t budget = 0;         // vectors of all viewports together; 0 means the window's default

  bool operator==(const UserSettings&) const = default;
};

/// Setting. The settings file, the preferences and the manual are made from these rows.
struct SettingRow {
  enum class Kind : std::uint8_t { flag, number, choice };

  std::string_view name;   // in the file
  std::string_view label;  // in the preferences
  Kind kind;
  std::string_view choices;    // of a choice: "dark light "; of a flag: "on off "
  double least = 0, most = 0;  // of a number
  bool whole = false;          // of a number
  std::string_view help;       // one line
  /// Returns the value as text, in the form of the file.
  std::string (*get)(const UserSettings& settings);
  /// Sets the value from text that is known to be valid for this row.
  void (*set)(UserSettings& settings, std::string_view text);
};
[[nodiscard]] std::span<const SettingRow> setting_rows();
[[nodiscard]] const SettingRow* find_setting(std::string_view name);
/// Returns the default value as text.
[[nodiscard]] std::string standard_of(const SettingRow& row);
/// Sets a value. Returns the expected form if `text` is wrong, otherwise nullopt.
[[nodiscard]] std::optional<std::string> set_setting(UserSettings& settings, const SettingRow& row,
                                                     std::string_view text);

/// Contents of a settings file.
struct ReadSettings {
  UserSettings settings;
  std::vector<std::string> problems;  // "LINE: error: problem; expected form"; other lines are applied
};
/// Parses lines of `name = value`. Ignores blank lines and lines that begin with #. Safe for any bytes.
[[nodiscard]] ReadSettings read_settings(std::string_view text);
/// Returns the text of a settings file: all rows with their help as comments. Default values are commented out.
[[nodiscard]] std::string settings_text(const UserSettings& settings);

}  // namespace gs::app
