#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gs::app {

/// Paths of persistent user data (XDG Base Directory Specification). If empty, nothing is read or written.
struct UserFolders {
  std::string settings_file;   // path of the settings
  std::string bookmarks_file;  // path of the bookmarks
  std::string state;           // folder for state that the program stores by itself

  [[nodiscard]] bool any() const { return !settings_file.empty(); }
};

/// Returns the folders below $XDG_CONFIG_HOME and $XDG_STATE_HOME, or their defaults below $HOME. `settings_file`
/// overrides the settings file (--config). Returns empty paths if there is no home folder.
[[nodiscard]] UserFolders user_folders(const std::string& settings_file = {});

/// Replaces a leading "~" by the user's home folder.
[[nodiscard]] std::string with_home(std::string_view path);
/// Replaces the user's home folder by "~", to show a path.
[[nodiscard]] std::string without_home(std::string_view path);

/// Reads a small file of the user. Returns nullopt if the file is missing, too large or unreadable; `problem` is the
/// reason, unless it is missing.
[[nodiscard]] std::optional<std::string> read_user_file(const std::string& path, std::string& problem);
/// Writes a file atomically. Creates its folder, readable only by the user, if it is missing. Returns the error, or
/// nullopt.
[[nodiscard]] std::optional<std::string> write_user_file(const std::string& path, std::string_view text);
/// Saves text that could not be parsed as `path`.bad, replacing an earlier one.
void keep_bad_file(const std::string& path, std::string_view text);

}  // namespace gs::app
