#pragma once

#include <span>
#include <string>
#include <vector>

#include <sys/types.h>

namespace gs::app {

/// Starts a program as a child process without copying this process. Its standard input and output are /dev/null. It
/// inherits standard error, and the descriptors `given` under the numbers from 3 on. Its environment has no secrets
/// (environment.h). Returns 0 on failure.
[[nodiscard]] pid_t start_child(const std::string& program, std::vector<std::string> arguments,
                                std::span<const int> given);

/// Ends a child for certain: kills it if it has not ended by itself. Returns the signal that had ended it before, as
/// text; empty if there was none.
std::string end_child(pid_t child);

}  // namespace gs::app
