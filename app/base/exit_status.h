#pragma once

namespace gs::app {

/// Exit statuses of all commands. kNotWritten: the input was read, but the output could not be written because of
/// missing space or permission; a retry may succeed.
enum ExitStatus : int { kDone = 0, kFailed = 1, kUsage = 2, kNotWritten = 3 };

}  // namespace gs::app
