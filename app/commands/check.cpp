#include "app/commands/check.h"

#include "app/base/console.h"
#include "app/commands/common/shared.h"
#include "app/loading/world_loader.h"
#include "app/script/script_runner.h"
#include "base/json_value.h"

namespace gs::app {

int run_check(const CheckCommand& options) {
  std::size_t bytes = 0, nodes = 0, errors = 0, warnings = 0;
  double seconds = 0;
  for (const std::string& file : options.files) {
    LoadOptions load = load_options(options);
    load.references = false;
    LoadedWorld world = load_world(file, load);
    if (options.scripts && world.scene) check_programs(*world.scene, world.diagnostics);
    for (const Diagnostic& diagnostic : world.diagnostics.entries()) print_line("%s", diagnostic.text().c_str());
    if (world.diagnostics.dropped() > 0)
      print_line("%s: note: %zu more diagnostics", file.c_str(), world.diagnostics.dropped());
    bytes += world.bytes;
    seconds += world.parse_seconds;
    errors += world.diagnostics.errors();
    warnings += world.diagnostics.warnings();
    if (world.scene) nodes += world.scene->nodes().count();
  }
  if (!options.stats.empty()) {
    const JsonValue stats = JsonValue::named({{"bytes", bytes},
                                              {"parse_s", seconds},
                                              {"nodes", nodes},
                                              {"peak_rss_bytes", peak_memory()},
                                              {"errors", errors},
                                              {"warnings", warnings}});
    if (const int status = write_stats(options.stats, stats.json()); status != kDone) return status;
  }
  return errors > 0 ? kFailed : kDone;
}

}  // namespace gs::app
