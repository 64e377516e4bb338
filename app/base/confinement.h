#pragma once

#include <optional>
#include <string>

namespace gs::app {

/// What a process may still do that reads files of strangers.
struct Confinement {
  std::string read;   // what lies beneath this folder may be read, and the system's libraries and fonts
  std::string write;  // in this folder and beneath files may be made, written, renamed and removed; empty: nowhere
};

/// What of it this kernel has.
struct ConfinementSupport {
  int landlock = 0;  // the version of its interface; 0: none
  bool seccomp = false;

  /// For whoever serves: what keeps the processes in check, and what is missing.
  [[nodiscard]] std::string text() const;
};
[[nodiscard]] ConfinementSupport confinement_support();

/// Confines this process permanently. Landlock limits its files; seccomp refuses sockets, other processes and programs,
/// and calls that change the machine or files by other ways; the environment loses all variables that may hold secrets
/// (environment.h). Leaves out what the kernel lacks (see `confinement_support`). Returns the reason if something fails
/// that the kernel has: then the process must read nothing untrusted. Call it before there are threads. See
/// docs/security.md.
[[nodiscard]] std::optional<std::string> confine(const Confinement& confinement);

}  // namespace gs::app
