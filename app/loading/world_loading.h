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

/// Returns the URL of the coarse stream that a server reached by ssh makes quickly (streamed_names.h). Returns an empty
/// text if the server does not make one of this file.
[[nodiscard]] std::string coarse_url_of(const std::string& path, const LoadOptions& options);

/// Reader of a world and all its references: EXTERNPROTOs, Inlines, textures and QNV streams. Reads files and the
/// network concurrently. Adds received parts at once: Shapes before their file ends, parts of long number lists, coarse
/// vectors before fine ones.
///
/// One thread. Results are plain data or are moved out. Safe for untrusted files and servers.
class WorldLoading {
 public:
  /// Begins to read a path or URL.
  WorldLoading(const std::string& asked, const LoadOptions& options);
  ~WorldLoading();
  WorldLoading(const WorldLoading&) = delete;
  WorldLoading& operator=(const WorldLoading&) = delete;

  /// Handles some received data, or waits at most `wait` for data. Returns false when the world is done: each part is
  /// loaded or has failed.
  bool step(std::chrono::milliseconds wait);
  [[nodiscard]] bool done() const;
  /// Ends the wait in `step`. Any thread.
  void wake();

  /// Returns true if the file itself is completely read. `take` is then allowed while references still load.
  [[nodiscard]] bool root_is_read() const;
  /// Returns the updates since the last call. Call only after `take`.
  [[nodiscard]] ResourceUpdates take_updates();
  /// Requests urls that the running world has set. Call only after `take`, and then call `step` until it returns false.
  /// The updates contain the results. The content of an Inline follows when its file is complete.
  void request(std::vector<UrlRequest> requests);
  /// Blocks until `wake` is called, or for at most `wait`.
  void rest(std::chrono::milliseconds wait);
  /// Sets the importance of waiting nodes; `wanted` returns these nodes. Call only after `take`.
  void prioritize(std::unordered_map<const vrml::Node*, float> importance);
  /// Returns the nodes that wait for data from the network.
  [[nodiscard]] std::unordered_set<const vrml::Node*> wanted() const;

  /// Returns true if the picture has changed since the last `collect`.
  [[nodiscard]] bool changed() const;
  /// Returns the render list of the parts read so far, for a viewer at `viewer` (world space). The list is empty before
  /// the first part is read.
  [[nodiscard]] render::RenderList collect(const glm::dvec3& viewer);

  [[nodiscard]] LoadingState state() const;
  /// Returns the feeds of streams that still grow. The drawing thread uses them; see stream_feed.h.
  [[nodiscard]] const std::vector<std::shared_ptr<StreamFeed>>& feeds() const;
  /// Returns the diagnostics so far.
  [[nodiscard]] const Diagnostics& diagnostics() const;
  /// Returns the title of the world, or the name of its file.
  [[nodiscard]] const std::string& title() const;
  /// Returns the up axis of the world. `size` is the extent of all visible objects.
  [[nodiscard]] Upright upright(const glm::vec3& size) const;
  /// Returns true for an authored world; see LoadedWorld.
  [[nodiscard]] bool authored() const;
  /// Moves the world out. Call once, after `step` returned false or `root_is_read` returned true. Do not use the scene
  /// through this object afterwards; later results are updates. Meshes from `collect` are moved to `meshes`.
  [[nodiscard]] LoadedWorld take(render::MeshCache* meshes = nullptr);

  /// Returns the statistics of received and lost datagrams with cells.
  [[nodiscard]] net::CellClientStatistics cells() const;

  /// Returns true if views still request finer vectors of streams. The caller must then continue to call `step`, which
  /// changes only these streams. Call only after `take`.
  [[nodiscard]] bool streaming() const;
  /// Returns true if these streams have received everything that views requested before the last `step`.
  [[nodiscard]] bool streams_rest() const;
  /// Returns true if bytes of the streams of `streaming` were received since the last call.
  [[nodiscard]] bool streams_grew();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace gs::app
