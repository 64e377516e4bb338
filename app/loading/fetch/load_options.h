#pragma once

#include "app/formats/common/voxel_component.h"
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
  std::uint64_t max_bytes = std::numeric_limits<std::uint64_t>::max();  // of the opened file; the rest is ignored
  Limits limits;                                                        // max memory and work of the world
  double loss = 0;  // simulated loss of the opened stream, as a fraction of its packets
  std::uint64_t loss_seed = 1;
  VoxelComponent component;                      // to read of voxels that have several
  double timeout_seconds = 30;                   // time limit for the whole world; then the missing parts are omitted
  const std::atomic<bool>* cancelled = nullptr;  // flag that another thread sets to stop; null if unused
  bool references = true;                        // true also reads Inlines, EXTERNPROTOs, textures and QNV streams
  bool whole_surfaces = false;                   // true makes displaced surfaces arrays, not patches for cuts
  bool offline = false;                          // true forbids all network access
  bool allow_network = false;                    // also for Scripts that have read private files
  bool follow = false;                           // true reads files again when they change
  std::vector<std::string> allowed;              // files and folders outside its own folder that a local world may read
  bool by_view = false;                          // true lets views choose ranges of long streams on servers
  bool large_by_view = false;                    // the same, but only of streams that are not decoded as a whole
  bool one_step = false;                         // true reads only the chosen step of time series on servers
  std::uint64_t rate = 0;                        // bandwidth limit in bits per second; 0 means unlimited
  std::string remote_program = "ghostspace";     // program for ssh: URLs (net::remote_serve_command())
  std::string cache_folder;                      // cache folder for network resources; empty means no cache
  PhaseClock* phases = nullptr;                  // clock for the parsing time; may be null
  std::shared_ptr<LoadLedger> ledger;            // ledger of the progress of files and streams; may be null
  std::function<std::unique_ptr<net::Transport>()> memory;  // factory of the transport for memory: URLs, for tests
};

}  // namespace gs::app
