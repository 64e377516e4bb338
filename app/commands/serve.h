#pragma once

#include "app/serve/archive.h"

namespace gs::app {

/// Serves a folder until SIGINT or SIGTERM. Running transfers may then finish for up to ten seconds; a second signal
/// ends them at once. Prints the addresses; returns the exit status.
int serve(const ArchiveOptions& options);

}  // namespace gs::app
