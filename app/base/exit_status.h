#pragma once

namespace gs::app {

/// Exit statuses of all commands. kNotWritten means that the input is good, but space or permission for the output is
/// missing. A retry may succeed.
enum ExitStatus : int { kDone = 0, kFailed = 1, kUsage = 2, kNotWritten = 3 };

}  // namespace gs::app
