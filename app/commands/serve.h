#pragma once

#include "app/serve/archive.h"

namespace gs::app {

/// Serves a folder until SIGINT or SIGTERM, then lets running transfers end for
/// up to ten seconds (a second signal: at once). Prints where; returns the exit
/// status.
int serve(const ArchiveOptions& options);

}  // namespace gs::app
