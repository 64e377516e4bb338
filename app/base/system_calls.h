#pragma once

namespace gs::app {

/// Returns true if this kernel can refuse system calls (seccomp).
[[nodiscard]] bool can_refuse_calls();
/// Refuses the system calls of the table in system_calls.cpp permanently, in all threads of this process; they fail
/// with EPERM. PR_SET_NO_NEW_PRIVS must be set. Returns false and sets errno if that is not possible.
[[nodiscard]] bool refuse_calls();

}  // namespace gs::app
