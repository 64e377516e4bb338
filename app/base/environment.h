#pragma once

#include <string_view>
#include <vector>

namespace gs::app {

/// Returns true for variables that a process with untrusted input keeps: language, time zone, temporary folder, search
/// paths, and settings of fonts, drivers and sanitizers. All others may hold secrets.
[[nodiscard]] bool is_kept_variable(std::string_view name);

/// Returns the kept entries of this process, `NAME=VALUE`, and a null pointer at the end: an argument for execve. The
/// entries belong to the environment; changing it invalidates them.
[[nodiscard]] std::vector<char*> kept_environment();

/// Removes all other entries and overwrites their bytes with zeros, so that /proc/self/environ does not show them. Call
/// before there are threads.
void clear_environment();

}  // namespace gs::app
