#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace gs::net {

/// Argument that stands for standard input, and the system's path to it.
inline constexpr char kStandardInput[] = "-";
inline constexpr char kStandardInputPath[] = "/dev/stdin";

/// Makes kStandardInputPath name a regular file with the content of standard input. Reads a pipe to its end into
/// memory, at most `limit` bytes. Returns the error, or nullopt. Call it once, before other threads start.
[[nodiscard]] std::optional<std::string> hold_standard_input(std::uint64_t limit);

}  // namespace gs::net
