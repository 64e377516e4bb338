#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

namespace gs::app {

/// Limits of a child process.
struct ChildLimits {
  std::chrono::seconds time{60};
  std::uint64_t memory = std::uint64_t{4} << 30;  // max bytes of data, without mapped files (RLIMIT_DATA)
  std::uint64_t file_bytes = std::uint64_t{16} << 30;  // max bytes of each file that the child writes
};

/// Reason why a child process failed.
struct ChildFailure {
  std::string message;  // last line on standard error; a general message if there is none
  bool lasting = true;  // true if a retry would also fail; false if this machine lacked a resource
};

/// Runs a program with these arguments, and returns the reason if it fails. Blocks until the program ends. The program
/// has no input, its output is discarded, and it gets the environment variables of app/base/environment.h. Kills the
/// program after `limits.time` or when `stop` is requested; it also ends with this process. Meant for work on untrusted
/// files: a crash of the program does not affect this process. Expects the exit statuses of GhostSpace.
[[nodiscard]] std::optional<ChildFailure> run_child(const std::string& program,
                                                    const std::vector<std::string>& arguments,
                                                    const ChildLimits& limits, const std::stop_token& stop);

}  // namespace gs::app
