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
  std::uint64_t memory = std::uint64_t{4} << 30;       // bytes of its data, without mapped files (RLIMIT_DATA)
  std::uint64_t file_bytes = std::uint64_t{16} << 30;  // of each file that it writes
};

/// Reason of the failure of a child process.
struct ChildFailure {
  std::string message;  // last line on standard error, if there is one
  bool lasting = true;  // a retry would fail, too; false if this machine lacked a resource
};

/// Runs a program with these arguments, without input, with its output discarded and with the kept part of the
/// environment (app/base/environment.h). Waits for its end and returns the reason of a failure. Kills the child after
/// its time, or when stopped; the child also ends with this process. Meant for work on untrusted files: no failure of
/// the child ends this process. Interprets the exit statuses of this program.
[[nodiscard]] std::optional<ChildFailure> run_child(const std::string& program,
                                                    const std::vector<std::string>& arguments,
                                                    const ChildLimits& limits, const std::stop_token& stop);

}  // namespace gs::app
