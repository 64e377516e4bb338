#pragma once

#include "bench/transfer/run.h"

#include <vector>

namespace gs::bench {

/// Runs many transfers, up to `parallel` slow ones at a time and fast ones alone. Returns the recordings in the order
/// of the specs. Prints progress on stderr.
[[nodiscard]] std::vector<Recording> transfer_all(const std::vector<TransferSpec>& specs, const ServerSpec& server,
                                                  unsigned parallel);

}  // namespace gs::bench
