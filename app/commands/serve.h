#pragma once

#include "app/commands/common/option_groups.h"
#include "app/serve/archive.h"

namespace gs::app {

/// Options of `serve`. Without a folder, `--stdio` serves all files of the account.
struct ServeCommand : CommandOptions, ArchiveOptions {};
/// Serves a folder until SIGINT or SIGTERM. Then waits up to ten seconds for running transfers; a second signal ends
/// them at once. Prints the addresses. Returns the exit status.
int run_serve(const ServeCommand& options);
[[nodiscard]] std::optional<std::string> check_serve(const ServeCommand& options);

}  // namespace gs::app
