#pragma once

#include "app/commands/common/option_groups.h"
#include "app/serve/archive.h"

namespace gs::app {

/// Options of `serve`.
struct ServeCommand : CommandOptions, ArchiveOptions {};
/// Serves a folder until SIGINT or SIGTERM. Running transfers may then finish for up to ten seconds; a second signal
/// ends them at once. Prints the addresses; returns the exit status.
int run_serve(const ServeCommand& options);

}  // namespace gs::app
