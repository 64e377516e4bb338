#include "app/commands/commands.h"
#include "app/world_loader.h"

#include <nlohmann/json.hpp>

#include <cstdio>

namespace gs::app {

int run_check(const Options& options) {
  std::size_t bytes = 0, nodes = 0, errors = 0, warnings = 0;
  double seconds = 0;
  for (const std::string& file : options.files) {
    LoadOptions load = load_options(options);
    load.references = false;
    const OpenedWorld world = load_world(file, load);
    for (const vrml::Diagnostic& diagnostic : world.diagnostics.entries())
      std::printf("%s\n", diagnostic.text().c_str());
    if (world.diagnostics.dropped() > 0)
      std::printf("%s: note: %zu more diagnostics\n", file.c_str(), world.diagnostics.dropped());
    bytes += world.bytes;
    seconds += world.parse_seconds;
    errors += world.diagnostics.errors();
    warnings += world.diagnostics.warnings();
    if (world.scene) nodes += world.scene->node_count();
  }
  if (!options.stats.empty()) {
    const nlohmann::json stats = {{"bytes", bytes},   {"parse_s", seconds},
                                  {"nodes", nodes},   {"peak_rss_bytes", peak_memory()},
                                  {"errors", errors}, {"warnings", warnings}};
    if (!write_stats(options.stats, stats.dump(2) + "\n")) return kFailed;
  }
  return errors > 0 ? kFailed : kDone;
}

}  // namespace gs::app
