#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>

namespace gs::app {

/// Returns the user's pictures folder: $XDG_PICTURES_DIR, else the entry in `user_directories`, else Pictures in the
/// home folder. `user_directories` is the text of ~/.config/user-dirs.dirs. `variable` returns the value of an
/// environment variable, or "". Returns "" if there is no home folder.
[[nodiscard]] std::string pictures_folder(const std::function<std::string(const char*)>& variable,
                                          std::string_view user_directories);
/// Returns the pictures folder of the current user.
[[nodiscard]] std::string pictures_folder();

/// Builds a file name such as "CThead 2026-11-23 09-20-11.png" from title and time, without characters that file names
/// forbid. `time` is in seconds since 1970 and is shown as local time.
[[nodiscard]] std::string picture_name(std::string_view title, double time, std::string_view extension = ".png");

/// Returns an unused path for `name` in `folder`; adds " (2)", " (3)" and so on to the name if needed.
[[nodiscard]] std::string free_path(const std::string& folder, const std::string& name);

}  // namespace gs::app
