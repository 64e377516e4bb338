#pragma once

namespace gs::app {

/// Whether this kernel can refuse system calls (seccomp).
[[nodiscard]] bool can_refuse_calls();
/// Refuses this process, for good and in all its threads, the calls of the table in system_calls.cpp; they fail with
/// EPERM. It must have given up new privileges (PR_SET_NO_NEW_PRIVS). False, and errno, when that is not possible.
[[nodiscard]] bool refuse_calls();

}  // namespace gs::app
