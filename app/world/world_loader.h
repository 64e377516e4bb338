#pragma once

#include "app/world/opened_world.h"
#include "render/base/phases.h"
#include "vrml/scene/limits.h"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

namespace gs::net {
class MemoryNetwork;
}

namespace gs::app {

class LoadLedger;

struct LoadOptions {
  std::uint64_t max_bytes = std::numeric_limits<std::uint64_t>::max();  // of the file: the rest never arrives
  vrml::Limits limits;                                                  // what the world may cost
  double loss = 0;  // of a stream: this share of its packets never comes
  std::uint64_t loss_seed = 1;
  double timeout_seconds = 30;                   // for everything together; what is missing then is left out
  const std::atomic<bool>* cancelled = nullptr;  // set by another thread: as if the time were over
  bool references = true;                        // also Inlines, EXTERNPROTOs, textures and QNV streams
  bool whole_surfaces = false;       // displaced surfaces as arrays, not as patches of which views take cuts
  bool offline = false;              // nothing is read over the network
  bool allow_network = false;        // also for Scripts that have read private files
  std::vector<std::string> allowed;  // folders and files, besides its own folder, that a world of this machine may read
  bool by_view = false;      // of long streams on servers, views choose what is read; else they come front to back
  std::uint64_t rate = 0;    // bits a second that are asked for, or taken of a server at most; 0: as many as there are
  std::string cache_folder;  // for what comes over the network; empty: none
  render::PhaseClock* phases = nullptr;        // of who measures how long texts take to parse; null: nobody does
  std::shared_ptr<LoadLedger> ledger;          // of who wants to see how far files and streams are; null: nobody
  std::shared_ptr<net::MemoryNetwork> memory;  // for tests: what memory: URLs name
};

/// Reads a world from a path or URL, of any type of the table of content types, gzip'd or not, and what it refers to.
/// `scene` is null when there is nothing to show; the diagnostics say why. Any thread; touches nothing else. Safe for
/// untrusted files and servers.
[[nodiscard]] OpenedWorld load_world(const std::string& path, const LoadOptions& options = {});
class WorldLoading;
/// The same by one who goes on to ask for what its nodes name later.
[[nodiscard]] OpenedWorld load_world(WorldLoading& loading, const std::string& path);
/// What has become of a world for which there is not enough memory.
[[nodiscard]] OpenedWorld world_without_memory(const std::string& path);

}  // namespace gs::app
