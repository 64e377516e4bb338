#pragma once

namespace gs::app {

/// Exit statuses of every command. Not written: files were read, but there is no room for what was made of them, or no
/// right to write it; the same may work another time.
enum ExitStatus : int { kDone = 0, kFailed = 1, kUsage = 2, kNotWritten = 3 };

}  // namespace gs::app
