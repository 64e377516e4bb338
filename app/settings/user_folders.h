#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gs::app {

/// Paths of persistent user data (XDG Base Directory Specification). If a path is empty, its data are neither read nor
/// written.
struct UserFolders {
  std::string settings_file;  // settings file
  std::string bookmarks_file;  // bookmarks file
  std::string state;  // folder of the state that the program itself saves

  [[nodiscard]] bool any() const { return !settings_file.empty(); }
};

/// Returns the folders below $XDG_CONFIG_HOME and $XDG_STATE_HOME, or their defaults below $HOME. `settings_file`
/// overrides the settings file (--config). Returns empty paths if there is no home folder.
[[nodiscard]] UserFolders user_folders(const std::string& settings_file = {});

/// Replaces a leading "~" by the user's home folder.
[[nodiscard]] std::string with_home(std::string_view path);
/// Replaces the user's home folder at the start of a path by "~", for display.
[[nodiscard]] std::string without_home(std::string_view path);

/// Reads a small file of the user. Returns nullopt if the file is missing, too large or unreadable. Sets `problem` to
/// the error, except for a missing file.
[[nodiscard]] std::optional<std::string> read_user_file(const std::string& path, std::string& problem);
/// Writes a file atomically. Creates its folder if necessary, accessible only to the user. Returns the error, or
/// nullopt.
[[nodiscard]] std::optional<std::string> write_user_file(const std::string& path, std::string_view text);
/// Saves a text that could not be parsed as `path`.bad. Replaces an earlier file of that name.
void keep_bad_file(const std::string& path, std::string_view text);

}  // namespace gs::app
