#include "app/commands/commands.h"
#include "app/world_loader.h"
#include "vrml/printer.h"

#include <cstdio>
#include <string_view>

namespace gs::app {

int run_print(const Options& options) {
  LoadOptions load = load_options(options);
  load.references = false;
  const OpenedWorld world = load_world(options.files.front(), load);
  print_diagnostics(world.diagnostics);
  if (!world.scene) return kFailed;
  bool written = true;
  vrml::print(*world.scene, [&](std::string_view text) {
    written = std::fwrite(text.data(), 1, text.size(), stdout) == text.size();
    return written;
  });
  if (!written || std::fflush(stdout) != 0) {
    std::fprintf(stderr, "ghostspace: error: the text could not be written\n");
    return kFailed;
  }
  return world.truncated ? kFailed : kDone;
}

}  // namespace gs::app
