#pragma once

#include <string_view>
#include <vector>

namespace gs::app {

/// Returns true for variables that a process with untrusted input keeps: language, time zone, temporary folder, search
/// paths, and settings of fonts, drivers and sanitizers. All others may hold secrets.
[[nodiscard]] bool is_kept_variable(std::string_view name);

/// Returns the kept `NAME=VALUE` entries, ended by a null pointer, as execve expects. Any change of the environment
/// invalidates them.
[[nodiscard]] std::vector<char*> kept_environment();

/// Removes all entries that are not kept. Overwrites their bytes with zeros, so that /proc/self/environ does not show
/// them. Call before starting threads.
void clear_environment();

}  // namespace gs::app
