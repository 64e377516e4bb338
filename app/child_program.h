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
  std::uint64_t memory = std::uint64_t{8} << 30;       // bytes of address space
  std::uint64_t file_bytes = std::uint64_t{16} << 30;  // of each file that it writes
};

/// Runs a program with these arguments, without input and with its output
/// thrown away, and waits for it; what went wrong, if it did: the last line
/// that it wrote to stderr. Kills it when its time is up or when stopped. For
/// work on files of others: whatever such a file does to the child, this
/// process goes on.
[[nodiscard]] std::optional<std::string> run_child(const std::string& program,
                                                   const std::vector<std::string>& arguments, const ChildLimits& limits,
                                                   const std::stop_token& stop);

}  // namespace gs::app
