#pragma once

#include "app/loading/fetch/load_options.h"
#include "app/loading/updates/loaded_world.h"

#include <string>

namespace gs::app {

/// Reads a world and its references from a path or URL. Accepts any content type, optionally gzip-compressed. If there
/// is nothing to show, `scene` is null and the diagnostics give the reason. Safe for untrusted files and servers. Any
/// thread.
[[nodiscard]] LoadedWorld load_world(const std::string& path, const LoadOptions& options = {});
class WorldLoading;
/// Reads a world like the function above, with the caller's loader, which can request urls later.
[[nodiscard]] LoadedWorld load_world(WorldLoading& loading, const std::string& path);
/// Returns an empty world with the error that memory does not suffice.
[[nodiscard]] LoadedWorld world_without_memory(const std::string& path);

}  // namespace gs::app
