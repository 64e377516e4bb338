#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace gs::net {

/// What a command line means by standard input, and the name by which the system opens that.
inline constexpr char kStandardInput[] = "-";
inline constexpr char kStandardInputPath[] = "/dev/stdin";

/// Makes kStandardInputPath a name of a regular file with what comes on standard input: a pipe is read to its end, into
/// memory, at most `limit` bytes. What is wrong, or nothing. Once, before there are other threads.
[[nodiscard]] std::optional<std::string> hold_standard_input(std::uint64_t limit);

}  // namespace gs::net
