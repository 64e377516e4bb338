#pragma once

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

/// Options for reading a world.
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

}  // namespace gs::app
