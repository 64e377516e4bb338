#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>

namespace gs::app {

/// Returns the user's folder for pictures: $XDG_PICTURES_DIR, else the entry in `user_directories`, else Pictures in
/// the home folder. `user_directories` is the text of ~/.config/user-dirs.dirs. `variable` returns the value of an
/// environment variable, or "" if it is not set. Returns "" if there is no home folder.
[[nodiscard]] std::string pictures_folder(const std::function<std::string(const char*)>& variable,
                                          std::string_view user_directories);
/// Returns the pictures folder of the current user, by the environment and ~/.config/user-dirs.dirs.
[[nodiscard]] std::string pictures_folder();

/// Builds a file name such as "CThead 2026-11-23 09-20-11.png" from a title and a time. Replaces characters that are
/// not allowed in file names. `time` is in seconds since 1970; the name has local time.
[[nodiscard]] std::string picture_name(std::string_view title, double time, std::string_view extension = ".png");

/// Returns the path of `name` in `folder`. If that file exists, adds " (2)", " (3)" and so on to the name.
[[nodiscard]] std::string free_path(const std::string& folder, const std::string& name);

}  // namespace gs::app
