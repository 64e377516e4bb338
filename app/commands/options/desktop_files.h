#pragma once

#include <span>
#include <string>
#include <string_view>

namespace gs::app {

/// The program's name in desktops: of its entry, icon and metainfo.
inline constexpr std::string_view kDesktopName = "org.ghostspace.GhostSpace";

/// A file that tells a desktop or a shell of the program, made of the tables of options, commands and content types.
struct DesktopFile {
  std::string_view name;  // as `desktop` is asked for it
  std::string_view help;
  std::string (*make)();
};
[[nodiscard]] std::span<const DesktopFile> desktop_files();

/// Completion of its command line.
[[nodiscard]] std::string bash_completion();
[[nodiscard]] std::string zsh_completion();
[[nodiscard]] std::string fish_completion();

}  // namespace gs::app
