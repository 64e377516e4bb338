#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>

namespace gs::app {

/// Where a user's pictures go: $XDG_PICTURES_DIR, else what `user_directories` says of it, which is the text of
/// ~/.config/user-dirs.dirs, else Pictures in the home folder. `variable` has the value of an environment variable, or
/// is empty. Empty: there is no home either.
[[nodiscard]] std::string pictures_folder(const std::function<std::string(const char*)>& variable,
                                          std::string_view user_directories);
/// Of this user.
[[nodiscard]] std::string pictures_folder();

/// "CThead 2026-11-23 09-20-11.png": what the picture shows and when, without what file names cannot have. `time`:
/// seconds since 1970, told as the local time.
[[nodiscard]] std::string picture_name(std::string_view title, double time, std::string_view extension = ".png");

/// A path for it in a folder where there is nothing yet: " (2)" and so on behind the name.
[[nodiscard]] std::string free_path(const std::string& folder, const std::string& name);

}  // namespace gs::app
