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

/// Confines this process, for good: files by Landlock; no sockets, no other processes or programs, nothing that changes
/// the machine or files by other ways, by seccomp. What the kernel does not have is left out (`confinement_support`
/// tells); what went wrong with what it has, if anything: then nothing hostile may be read. To be called before there
/// are threads. See docs/security.md.
[[nodiscard]] std::optional<std::string> confine(const Confinement& confinement);

}  // namespace gs::app
