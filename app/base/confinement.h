#pragma once

#include <optional>
#include <string>

namespace gs::app {

/// Permissions of a process that reads untrusted files.
struct Confinement {
  std::string read;   // folder below which files may be read, besides the system's libraries and fonts
  std::string write;  // folder below which files may be created, written, renamed and removed; empty means none
};

/// Confinement features of this kernel.
struct ConfinementSupport {
  int landlock = 0;  // version of the Landlock interface; 0 means none
  bool seccomp = false;

  /// Returns a text for operators of servers: the active and the missing features.
  [[nodiscard]] std::string text() const;
};
[[nodiscard]] ConfinementSupport confinement_support();

/// Confines this process permanently. Landlock limits its files; seccomp refuses sockets, other processes and programs,
/// and calls that change the machine or files in other ways. Also removes environment variables that may hold secrets
/// (environment.h). Omits features that the kernel lacks (see confinement_support()).
///
/// Returns the reason if a supported feature fails; the process must then not read untrusted data. Call before there
/// are threads. See docs/security.md.
[[nodiscard]] std::optional<std::string> confine(const Confinement& confinement);

}  // namespace gs::app
