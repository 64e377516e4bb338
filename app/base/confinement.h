#pragma once

#include <optional>
#include <string>

namespace gs::app {

/// Permissions of a process after confine().
struct Confinement {
  std::string read;   // readable folder, in addition to the system's libraries and fonts
  std::string write;  // folder below which files may be created, written, renamed and removed; empty means none
};

/// Confinement features that this kernel supports.
struct ConfinementSupport {
  int landlock = 0;  // version of the Landlock interface; 0 means that the kernel lacks it
  bool seccomp = false;

  /// Returns a text for operators of servers that lists active and missing features.
  [[nodiscard]] std::string text() const;
};
[[nodiscard]] ConfinementSupport confinement_support();

/// Confines this process permanently, so that it may read untrusted files. Landlock restricts access to files. seccomp
/// refuses sockets, other processes and programs, and other calls that change files or the machine. Environment
/// variables that may hold secrets are removed (environment.h). Skips features that the kernel lacks (see
/// confinement_support()).
///
/// Returns an error if a supported feature fails. The process must then not read untrusted data. Call before other
/// threads start. See docs/security.md.
[[nodiscard]] std::optional<std::string> confine(const Confinement& confinement);

/// Confines this process permanently to decoding: no files, sockets, programs or processes, no executable memory.
/// seccomp allows only the calls of system_calls.h; Landlock allows no file. Skips features that the kernel lacks.
/// Returns an error as confine() does. Call it after libraries are loaded, while only one thread runs.
[[nodiscard]] std::optional<std::string> confine_decoder();
/// Confines this process permanently, as confine_decoder() does. But memory may become executable, because the engine
/// compiles programs. For threads that exist already, only seccomp prevents access to files.
[[nodiscard]] std::optional<std::string> confine_programs();

}  // namespace gs::app
