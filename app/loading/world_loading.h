#pragma once

#include "app/loading/fetch/fetcher.h"
#include "app/loading/updates/loaded_world.h"
#include "app/loading/updates/resource_updates.h"
#include "app/loading/world_loader.h"
#include "net/cells/cell_receiver.h"
#include "render/scene/render_list.h"

#include <glm/vec3.hpp>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <vector>

namespace gs::app {

/// Reader of a world and all its references (EXTERNPROTOs, Inlines, textures, QNV streams), from files and the network
/// concurrently. Received parts are added at once: Shapes before their file ends, parts of long number lists, coarse
/// vectors before fine ones.
///
/// Used by one thread; results are plain data or are moved out. Safe for untrusted files and servers.
class WorldLoading {
 public:
  /// Begins to read a path or URL.
  WorldLoading(const std::string& asked, const LoadOptions& options);
  ~WorldLoading();
  WorldLoading(const WorldLoading&) = delete;
  WorldLoading& operator=(const WorldLoading&) = delete;

  /// Handles some received data, or waits for it for at most `wait`. Returns false when the world is done: each part is
  /// loaded or can no longer be loaded.
  bool step(std::chrono::milliseconds wait);
  [[nodiscard]] bool done() const;
  /// Ends the wait of a `step`. Any thread.
  void wake();

  /// Returns true if all nodes of the file itself are read. The file can then be taken while Inlines, EXTERNPROTOs,
  /// polygons, images and vectors still load.
  [[nodiscard]] bool root_is_read() const;
  /// Returns the updates since the last call. Call after `take`.
  [[nodiscard]] ResourceUpdates take_updates();
  /// Requests urls that were set, after `take`. Call `step` until it is done again. The updates contain the results; an
  /// Inline is included when its file is complete.
  void request(std::vector<UrlRequest> requests);
  /// Blocks until `wake` is called, or for at most `wait`.
  void rest(std::chrono::milliseconds wait);
  /// Sets the importance of waiting nodes, after `take`. The nodes are from `wanted`.
  void prioritize(std::unordered_map<const vrml::Node*, float> importance);
  /// Returns the nodes that wait for data from the network.
  [[nodiscard]] std::unordered_set<const vrml::Node*> wanted() const;

  /// Returns true if something visible has changed since the last `collect`.
  [[nodiscard]] bool changed() const;
  /// Returns the render list of the parts read so far, for a viewer at `viewer`. Empty before the first part is read.
  [[nodiscard]] render::RenderList collect(const glm::dvec3& viewer);

  [[nodiscard]] LoadingState state() const;
  /// Returns the feeds of streams that grow; the drawing thread feeds them, see stream_feed.h.
  [[nodiscard]] const std::vector<std::shared_ptr<StreamFeed>>& feeds() const;
  /// Returns the diagnostics so far.
  [[nodiscard]] const Diagnostics& diagnostics() const;
  /// Returns the title of the world, or the name of its file.
  [[nodiscard]] const std::string& title() const;
  /// Returns the up axis. `size` is the extent of all visible objects.
  [[nodiscard]] Upright upright(const glm::vec3& size) const;
  /// Returns true for an authored world; see LoadedWorld.
  [[nodiscard]] bool authored() const;
  /// Moves the world out. Call once, when the world is done or its root is read. The scene is not used afterwards;
  /// later results are updates. Meshes that `collect` made are moved to `meshes`.
  [[nodiscard]] LoadedWorld take(render::MeshCache* meshes = nullptr);

  /// Returns the number of received and lost datagrams of cells.
  [[nodiscard]] net::CellClientStatistics cells() const;

  /// Returns true, after `take`, if views still request finer vectors of streams. `step` must then be called further;
  /// it changes nothing of the world but the streams.
  [[nodiscard]] bool streaming() const;
  /// Returns true if bytes of such streams were received since the last call.
  [[nodiscard]] bool streams_grew();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace gs::app
