#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace gs::net {

/// Argument that means standard input, and the path of standard input in the system.
inline constexpr char kStandardInput[] = "-";
inline constexpr char kStandardInputPath[] = "/dev/stdin";

/// Makes kStandardInputPath a regular file with the content of standard input. Copies a pipe to memory until its end,
/// at most `limit` bytes. Returns the error, or nullopt. Call it once, before other threads start.
[[nodiscard]] std::optional<std::string> hold_standard_input(std::uint64_t limit);

}  // namespace gs::net
