#pragma once

#include <string_view>

namespace gs::app::script {

/// First argument of a child that runs programs; the second one is kLive or kRepeatable. Internal; users never pass it.
inline constexpr std::string_view kProgramsArgument = "--confined-programs";
inline constexpr char kLive[] = "live", kRepeatable[] = "repeatable";

/// Runs a child that runs the programs of one world: confines this process, then follows orders until it is killed. The
/// process must have the shared memory of the channel as descriptor 3, and one thread.
[[noreturn]] void run_program_child(std::string_view mode);

}  // namespace gs::app::script
