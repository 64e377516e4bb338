#pragma once

#include <optional>
#include <string>

#include <sys/stat.h>

namespace gs::net {

/// Returns the kind of a file, such as a folder, if it is not a regular file. Returns nullopt for regular files.
[[nodiscard]] inline std::optional<std::string> not_a_regular_file(const struct stat& status) {
  if (S_ISREG(status.st_mode)) return std::nullopt;
  if (S_ISDIR(status.st_mode)) return "it is a folder; expected a file";
  if (S_ISFIFO(status.st_mode)) return "it is a pipe; expected a regular file";
  if (S_ISSOCK(status.st_mode)) return "it is a socket; expected a regular file";
  return "it is a device; expected a regular file";
}

}  // namespace gs::net
