#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gs::app {

/// Where what the user wants kept is kept (XDG Base Directory Specification). Empty: nothing is, and nothing is read.
struct UserFolders {
  std::string settings_file;   // of settings; a path
  std::string bookmarks_file;  // a path
  std::string state;           // folder of what the program remembers by itself

  [[nodiscard]] bool any() const { return !settings_file.empty(); }
};

/// By $XDG_CONFIG_HOME and $XDG_STATE_HOME, below $HOME where these are not set. `settings_file`: another file of
/// settings, in the place of that (--config); empty: none. Nowhere where there is no home.
[[nodiscard]] UserFolders user_folders(const std::string& settings_file = {});

/// "~" and "~/..." as the user's home.
[[nodiscard]] std::string with_home(std::string_view path);
/// The other way: how a path is shown.
[[nodiscard]] std::string without_home(std::string_view path);

/// The bytes of a small file of the user's; nothing: there is none, it is longer than `most`, or cannot be read: then
/// `problem` says why.
[[nodiscard]] std::optional<std::string> read_user_file(const std::string& path, std::string& problem);
/// Writes it as a whole or not at all, and makes its folder where that is missing, for the user alone. What went wrong.
[[nodiscard]] std::optional<std::string> write_user_file(const std::string& path, std::string_view text);
/// Keeps what could not be made out as `path`.bad, in the place of what was kept so before.
void keep_bad_file(const std::string& path, std::string_view text);

}  // namespace gs::app
