#pragma once

#include "tests/simulation/http_session.h"

namespace gs::simulation {

/// Runs a session over cells: clients watch streams over links that lose, repeat and reorder datagrams, while links are
/// cut and the server restarts. Throws a Violation if an invariant does not hold:
/// - every received chunk is that of the file
/// - each state of a stream gives a valid picture
/// - streams that repair losses become complete, and all sessions end
/// - received data that wait are bounded
[[nodiscard]] SessionResult run_cell_session(std::uint64_t seed, bool prints);

}  // namespace gs::simulation
