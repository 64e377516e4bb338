#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace gs::app {

struct CommandOptions;

/// Name of the program's desktop entry, icon and metainfo.
inline constexpr std::string_view kDesktopName = "org.ghostspace.GhostSpace";

/// File that integrates the program in a desktop or shell. The tables of options, commands and content types are its
/// source.
struct DesktopFile {
  std::string_view name;  // argument of the command `desktop` that prints this file
  std::string_view help;
  std::string (*make)();
};
[[nodiscard]] std::span<const DesktopFile> desktop_files();

/// Prints one of the files of desktop_files().
int run_desktop(const CommandOptions& options);
std::optional<std::string> check_desktop(const CommandOptions& options);

/// Return a script for completion of command lines in the named shell.
[[nodiscard]] std::string bash_completion();
[[nodiscard]] std::string zsh_completion();
[[nodiscard]] std::string fish_completion();

}  // namespace gs::app
