#include "app/commands/commands.h"
#include "app/console.h"
#include "app/world_loader.h"
#include "vrml/printer.h"

namespace gs::app {

int run_print(const Options& options) {
  LoadOptions load = load_options(options);
  load.references = false;
  const OpenedWorld world = load_world(options.files.front(), load);
  print_diagnostics(world.diagnostics);
  if (!world.scene) return kFailed;
  print_text(vrml::print(*world.scene));
  return world.truncated ? kFailed : kDone;
}

}  // namespace gs::app
