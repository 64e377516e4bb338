#pragma once

#include <cstdint>
#include <map>
#include <string>

namespace gs::simulation {

/// Result of a session that violated no invariant.
struct SessionResult {
  std::uint64_t hash = 0;  // of the trace
  std::map<std::string, std::uint64_t> counts;
};

/// Runs a session over HTTP: clients load files and watch streams, while the connection and the server fail. Throws a
/// Violation if an invariant does not hold:
/// - every delivered byte is that of the served file
/// - each prefix of a stream gives a valid picture, and a complete stream all vectors
/// - each request ends once, and all end if the failures are short
/// - bytes that were delivered are not requested again without a failure
/// - the queue of received bytes is bounded
[[nodiscard]] SessionResult run_http_session(std::uint64_t seed, bool prints);

}  // namespace gs::simulation
