#pragma once

#include "app/world/updates/loaded_world.h"
#include "base/limits.h"
#include "base/phases.h"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

namespace gs::net {
class Transport;
}

namespace gs::app {

class LoadLedger;

struct LoadOptions {
  std::uint64_t max_bytes = std::numeric_limits<std::uint64_t>::max();  // of the file; the rest is ignored
  Limits limits;                                                        // max cost of the world
  double loss = 0;  // simulated loss of a stream, as a fraction of its packets
  std::uint64_t loss_seed = 1;
  double timeout_seconds = 30;                   // for the whole world; everything that is missing then is omitted
  const std::atomic<bool>* cancelled = nullptr;  // set by another thread to stop like a timeout
  bool references = true;                        // also reads Inlines, EXTERNPROTOs, textures and QNV streams
  bool whole_surfaces = false;                   // displaced surfaces as arrays instead of patches that views cut
  bool offline = false;                          // reads nothing over the network
  bool allow_network = false;                    // also for Scripts that have read private files
  std::vector<std::string> allowed;  // folders and files outside of its own folder that a local world may read
  bool by_view = false;      // views choose ranges of long streams on servers; otherwise they are read front to back
  std::uint64_t rate = 0;    // max bits per second of a server; 0 means unlimited
  std::string cache_folder;  // cache of network resources; empty means none
  PhaseClock* phases = nullptr;                             // measures parsing; may be null
  std::shared_ptr<LoadLedger> ledger;                       // receives the progress of files and streams; may be null
  std::function<std::unique_ptr<net::Transport>()> memory;  // for tests: makes the transport of memory: URLs
};

/// Reads a world and its references from a path or URL, of any content type, optionally gzip-compressed. `scene` is
/// null if there is nothing to show; the diagnostics give the reason. Safe for untrusted files and servers. Any thread.
[[nodiscard]] LoadedWorld load_world(const std::string& path, const LoadOptions& options = {});
class WorldLoading;
/// Reads a world with a loader that the caller keeps, so that it can request urls later.
[[nodiscard]] LoadedWorld load_world(WorldLoading& loading, const std::string& path);
/// Returns the result for a world that does not fit in memory.
[[nodiscard]] LoadedWorld world_without_memory(const std::string& path);

}  // namespace gs::app
