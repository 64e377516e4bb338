#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

namespace gs::app {

/// What a child may take.
struct ChildLimits {
  std::chrono::seconds time{60};
  std::uint64_t memory = std::uint64_t{4} << 30;       // bytes of its own, without files that it maps (RLIMIT_DATA)
  std::uint64_t file_bytes = std::uint64_t{16} << 30;  // of each file that it writes
};

/// Why a child did not do its work.
struct ChildFailure {
  std::string message;  // the last line that it wrote to stderr, where there is one
  bool lasting = true;  // it would be so again; else it was for want of something in this machine
};

/// Runs a program with these arguments, without input, with its output discarded and with the kept part of the
/// environment (app/base/environment.h). Waits for its end and returns the reason of a failure. Kills the child after
/// its time, or when stopped; the child also ends with this process. Meant for work on untrusted files: no failure of
/// the child ends this process. Interprets the exit statuses of this program.
[[nodiscard]] std::optional<ChildFailure> run_child(const std::string& program,
                                                    const std::vector<std::string>& arguments,
                                                    const ChildLimits& limits, const std::stop_token& stop);

}  // namespace gs::app
