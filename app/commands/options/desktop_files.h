#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace gs::app {

struct CommandOptions;

/// Name of the program in desktops: of its entry, icon and metainfo.
inline constexpr std::string_view kDesktopName = "org.ghostspace.GhostSpace";

/// File for a desktop or shell, made from the tables of options, commands and content types.
struct DesktopFile {
  std::string_view name;  // argument of `desktop`
  std::string_view help;
  std::string (*make)();
};
[[nodiscard]] std::span<const DesktopFile> desktop_files();

/// Prints a file of desktop_files().
int run_desktop(const CommandOptions& options);
std::optional<std::string> check_desktop(const CommandOptions& options);

/// Return the scripts that complete the command line.
[[nodiscard]] std::string bash_completion();
[[nodiscard]] std::string zsh_completion();
[[nodiscard]] std::string fish_completion();

}  // namespace gs::app
