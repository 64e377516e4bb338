#include "app/world_loader.h"

#include "app/stream_feed.h"
#include "app/world_loading.h"

namespace gs::app {

OpenedWorld load_world(const std::string& path, const LoadOptions& options) {
  WorldLoading loading(path, options);
  while (!loading.done()) (void)loading.step(std::chrono::milliseconds(1000));
  OpenedWorld world = loading.take();
  for (const auto& feed : world.feeds) (void)feed->apply();
  return world;
}

}  // namespace gs::app
