#pragma once

#include "app/opened_world.h"

#include <atomic>
#include <cstddef>
#include <limits>
#include <string>

namespace gs::app {

struct LoadOptions {
  std::size_t max_bytes = std::numeric_limits<std::size_t>::max();  // of the file: the rest never arrives
  double loss = 0;  // of a stream: this share of its packets never comes
  std::uint64_t loss_seed = 1;
  double timeout_seconds = 30;                   // for everything together; what is missing then is left out
  const std::atomic<bool>* cancelled = nullptr;  // set by another thread: as if the time were over
  bool references = true;                        // also Inlines, EXTERNPROTOs and textures
};

/// Reads a world from a local path or file: URL, of any type of the table of content types, gzip'd or not,
/// and what it refers to. `scene` is null when there is nothing to show; the diagnostics say why.
/// Any thread; touches nothing else. Safe for untrusted files.
[[nodiscard]] OpenedWorld load_world(const std::string& path, const LoadOptions& options = {});

}  // namespace gs::app
