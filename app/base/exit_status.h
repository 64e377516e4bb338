#pragma once

namespace gs::app {

/// Exit statuses of all commands. kNotWritten means that the input was read, but the output could not be written. Space
/// or permission was missing, so a retry may succeed.
enum ExitStatus : int { kDone = 0, kFailed = 1, kUsage = 2, kNotWritten = 3 };

}  // namespace gs::app
