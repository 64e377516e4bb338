#include "app/commands/commands.h"
#include "app/viewer.h"
#include "app/world_loader.h"

#include <cstdio>

namespace gs::app {

int run_open(const Options& options) {
  const std::string first = options.files.empty() ? demo_world() : options.files.front();
  if (!options.snapshot.empty()) return run_snapshot(options, first);
  ViewerOptions viewer;
  viewer.files = options.files.empty() ? std::vector<std::string>{first} : options.files;
  viewer.width = options.width;
  viewer.height = options.height;
  viewer.samples = options.samples;
  viewer.headlight = options.headlight;
  viewer.background = options.background;
  viewer.viewpoint = options.viewpoint;
  LoadOptions load;
  load.max_bytes = options.max_bytes;
  load.timeout_seconds = options.timeout_seconds;
  std::string error;
  const int status = run_viewer(
      viewer, [load](const std::string& path) { return load_world(path, load); }, error);
  if (status != 0)
    std::fprintf(stderr, "ghostspace: error: %s\nA picture without a window: ghostspace --snapshot OUT.png FILE\n",
                 error.c_str());
  return status;
}

}  // namespace gs::app
