#include "app/commands/print.h"

#include "app/base/console.h"
#include "app/commands/common/shared.h"
#include "app/loading/world_loader.h"
#include "vrml/syntax/printer.h"

#include <string_view>

namespace gs::app {

int run_print(const LoadingOptions& options) {
  LoadOptions load = load_options(options);
  load.references = false;
  const LoadedWorld world = load_world(options.files.front(), load);
  print_diagnostics(world.diagnostics);
  if (!world.scene) return kFailed;
  vrml::print(*world.scene, [](std::string_view text) {
    print_text(text);
    return !output_failed();
  });
  return world.truncated ? kFailed : kDone;
}

}  // namespace gs::app
