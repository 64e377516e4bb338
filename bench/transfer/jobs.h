#pragma once

#include "bench/transfer/run.h"

#include <vector>

namespace gs::bench {

/// Makes many transfers, several at once where the machine has room for them: those that are fast run alone. `parallel`
/// slow ones at most. The recordings stand in the order of the specs. Says on stderr how far it is.
[[nodiscard]] std::vector<Recording> transfer_all(const std::vector<TransferSpec>& specs, const ServerSpec& server,
                                                  unsigned parallel);

}  // namespace gs::bench
