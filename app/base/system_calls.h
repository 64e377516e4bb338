#pragma once

namespace gs::app {

/// Returns true if this kernel supports seccomp filters, which refuse system calls.
[[nodiscard]] bool can_refuse_calls();
/// Refuses the system calls listed in system_calls.cpp, permanently and in all threads of this process. They then fail
/// with EPERM. PR_SET_NO_NEW_PRIVS must be set. Returns false and sets errno on failure.
[[nodiscard]] bool refuse_calls();

/// Allows only the system calls for decoding listed in system_calls.cpp: memory, threads, time, and reading and writing
/// open descriptors. Others fail with EPERM. As permanent as refuse_calls(), with the same conditions.
[[nodiscard]] bool allow_decoding_calls();
/// Allows the calls of allow_decoding_calls(), and memory that can be executed, for the compiler of programs.
[[nodiscard]] bool allow_program_calls();

}  // namespace gs::app
