#pragma once

#include <string_view>
#include <vector>

namespace gs::app {

/// Returns true if a process keeps this variable while it reads untrusted input. These are language, time zone,
/// temporary folder, search paths, and settings of fonts, drivers and sanitizers. All other variables may hold secrets.
[[nodiscard]] bool is_kept_variable(std::string_view name);

/// Returns the `NAME=VALUE` entries that is_kept_variable() accepts, and a null pointer at the end, as for execve. The
/// pointers are valid until the environment changes.
[[nodiscard]] std::vector<char*> kept_environment();

/// Disables the shader cache of Mesa if the disk of the cache is almost full. Mesa maps the index of that cache. On
/// a full disk, the kernel kills a process that writes to such a map. Call before other threads start.
void spare_full_disk();

/// Removes all variables that is_kept_variable() rejects. Overwrites their bytes with zeros, so that /proc/self/environ
/// does not show them. Call before other threads start.
void clear_environment();

}  // namespace gs::app
