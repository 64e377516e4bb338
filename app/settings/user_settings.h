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

/// What the user has chosen for good.
struct UserSettings {
  Theme theme = Theme::dark;
  double text_size = 1;           // times what the screen has
  double speed = 1;               // times what worlds say
  bool sound = true;              // when a window opens
  bool system_dialog = true;      // to open files, where the desktop has one
  bool offers_to_restore = true;  // the files of a window that ended by itself
  bool writes_log = true;         // into a file
  UpAxis up = UpAxis::automatic;  // of files that are opened
  bool backdrop = true;           // a gradient behind what no author has given a background
  bool axes = true;               // in a corner of the picture
  bool first_steps = true;        // three lines over the demo world, until they are closed
  double memory = 2;              // GiB, about, for one world that is opened
  std::size_t budget = 0;         // vectors of all viewports together; 0: as many as suit a window

  bool operator==(const UserSettings&) const = default;
};

/// A setting: the row from which its file, the preferences and the manual are made.
struct SettingRow {
  enum class Kind : std::uint8_t { flag, number, choice };

  std::string_view name;   // in the file
  std::string_view label;  // in the preferences
  Kind kind;
  std::string_view choices;    // of a choice: "dark light "; of a flag: "on off "
  double least = 0, most = 0;  // of a number
  bool whole = false;          // likewise
  std::string_view help;       // one line
  /// The value as text, as the file has it.
  std::string (*get)(const UserSettings& settings);
  /// Takes it from text that is known to be a value of this row.
  void (*set)(UserSettings& settings, std::string_view text);
};
[[nodiscard]] std::span<const SettingRow> setting_rows();
[[nodiscard]] const SettingRow* find_setting(std::string_view name);
/// What the settings have when nobody has chosen anything.
[[nodiscard]] std::string standard_of(const SettingRow& row);
/// What was expected in the place of `text`; nothing: it was taken.
[[nodiscard]] std::optional<std::string> set_setting(UserSettings& settings, const SettingRow& row,
                                                     std::string_view text);

/// A file of settings, read.
struct ReadSettings {
  UserSettings settings;
  std::vector<std::string> problems;  // "LINE: error: what, and what was expected"; the other lines count
};
/// Lines of `name = value`; blank ones, and those that begin with #, say nothing. Any bytes are survived.
[[nodiscard]] ReadSettings read_settings(std::string_view text);
/// All rows with their help as comments; what is as it was at first, as a comment, too.
[[nodiscard]] std::string settings_text(const UserSettings& settings);

}  // namespace gs::app
