#pragma once

#include "app/serve/archive.h"

namespace gs::app {

/// Serves over standard input and output until the input ends: the other end of `ssh://` (docs/remote.md). `options`
/// has `standard_streams`. Messages go to standard error. Returns the error, or nullopt.
[[nodiscard]] std::optional<std::string> serve_standard_streams(const ArchiveOptions& options);

}  // namespace gs::app
