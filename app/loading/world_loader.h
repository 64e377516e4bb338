#pragma once

#include "app/loading/fetch/load_options.h"
#include "app/loading/updates/loaded_world.h"

#include <string>

namespace gs::app {

/// Reads a world and its references from a path or URL, of any content type, optionally gzip-compressed. `scene` is
/// null if there is nothing to show; the diagnostics give the reason. Safe for untrusted files and servers. Any thread.
[[nodiscard]] LoadedWorld load_world(const std::string& path, const LoadOptions& options = {});
class WorldLoading;
/// Reads a world with a loader that the caller keeps, so that it can request urls later.
[[nodiscard]] LoadedWorld load_world(WorldLoading& loading, const std::string& path);
/// Returns the result for a world that does not fit in memory.
[[nodiscard]] LoadedWorld world_without_memory(const std::string& path);

}  // namespace gs::app
