#include "app/loading/world_loader.h"

#include "app/loading/world_loading.h"
#include "app/streams/stream_feed.h"
#include "net/base/url_signature.h"

#include <new>

namespace gs::app {

LoadedWorld world_without_memory(const std::string& path) {
  LoadedWorld none;
  none.path = path;
  none.truncated = true;
  none.diagnostics.add({Severity::error, net::without_signature(path), {}, "not enough memory to open it"});
  return none;
}

LoadedWorld load_world(const std::string& path, const LoadOptions& options) try {
  WorldLoading loading(path, options);
  return load_world(loading, path);
} catch (const std::bad_alloc&) {
  return world_without_memory(path);
}

LoadedWorld load_world(WorldLoading& loading, const std::string& path) try {
  while (!loading.done()) (void)loading.step(std::chrono::milliseconds(1000));
  LoadedWorld world = loading.take();
  for (const auto& feed : world.feeds) (void)feed->apply();
  return world;
} catch (const std::bad_alloc&) {
  return world_without_memory(path);
}

}  // namespace gs::app
