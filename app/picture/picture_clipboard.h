#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace gs::app {

/// Program that puts a PNG file from its standard input on the clipboard of the desktop.
struct ClipboardProgram {
  std::string name;  // file name; searched in $PATH unless it contains a /
  std::vector<std::string> arguments;
  std::string variable;  // environment variable that exists on the desktops of the program
};
/// Returns the known programs, best first.
[[nodiscard]] std::span<const ClipboardProgram> clipboard_programs();

/// Copies a PNG file to the clipboard of the desktop. Returns the error, or nullopt. Waits at most a second.
[[nodiscard]] std::optional<std::string> copy_png(std::span<const std::byte> png,
                                                  std::span<const ClipboardProgram> programs = clipboard_programs());

}  // namespace gs::app
