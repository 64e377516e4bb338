#pragma once

#include "app/loading/fetch/load_options.h"
#include "net/transfer/load_types.h"

#include <atomic>
#include <cstdint>
#include <optional>
#include <string>

namespace gs::app {

/// Answer to a small request.
struct SmallAnswer {
  std::string version;  // validators and size of the resource
  std::string body;
  std::string problem;  // empty if the request succeeded
  int status = 0;       // HTTP status of a problem; 0 if there is none
};

/// Default limit of the bytes of an answer.
inline constexpr std::uint64_t kMostSmallBytes = std::uint64_t{1} << 20;

/// Sends one request and waits for its answer, at most 30 s, or until `stop` is true. With `head_only`, returns after
/// the head, without a body. Otherwise, accepts at most `most_bytes`. Blocks. Any thread.
[[nodiscard]] SmallAnswer small_request(net::Request request, bool head_only, const LoadOptions& load,
                                        const std::atomic<bool>& stop, std::uint64_t most_bytes = kMostSmallBytes);

}  // namespace gs::app
