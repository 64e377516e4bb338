#pragma once

#include "app/loading/updates/loaded_world.h"
#include "app/loading/world_loading.h"
#include "app/session/documents/world_runtime.h"
#include "qnv/base/description.h"
#include "render/scene/render_list.h"

#include <glm/vec3.hpp>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gs::app {

class WorldReader;

/// Opened world, shared by all views of it.
struct Document {
  LoadedWorld world;
  render::MeshCache meshes;
  std::unique_ptr<WorldRuntime> runtime;           // null if there is no scene (yet)
  std::shared_ptr<RuntimeScene> first_scene;       // the initial view; null if there is no scene (yet)
  std::shared_ptr<const render::RenderList> list;  // of `first_scene`, or of the parts received so far; never null
  Upright upright;                                 // up axis, from the format or from the file
  bool is_preview = false;                         // more data will be received; there is no scene yet
  bool viewer_dependent = false;  // has LOD or Billboard nodes, so each moving viewer needs an own render list
  bool has_navigation_info = false;
  bool has_surface_clouds = false, has_volumes = false;  // of QNV vectors
  std::shared_ptr<WorldReader> reader;  // still reads references, and the parts of streams that views want; may be null
  LoadingState arriving;                // progress of loading; empty if everything is loaded
  bool all_came = false;
  const void* viewer = nullptr;           // the view that reports its viewer to the sensors
  std::optional<glm::dvec3> destination;  // destination of that viewer's animated move
  bool controlled = false;                // changed by a --control client, which may have created its Scripts

  [[nodiscard]] bool has_clouds() const { return has_surface_clouds || has_volumes; }
};

/// Makes a document of an opened world without starting time in it. `meshes` holds meshes that were already made for
/// its nodes. Called on any thread that owns the world.
[[nodiscard]] std::shared_ptr<Document> hold_world(LoadedWorld world, render::MeshCache meshes = {});
/// Starts the world at `now`, in seconds since 1970, and collects its render list. Call once.
void begin_world(Document& document, double now);
/// Applies received updates to a running world. Returns true if nodes were added: Inlines or bodies of EXTERNPROTOs.
bool arrive(Document& document, ResourceUpdates&& updates);
/// Calls `hold_world` and `begin_world`, at the present time. A world with Scripts is not started here, because its own
/// thread must start it; only its meshes are made.
[[nodiscard]] std::shared_ptr<Document> make_document(LoadedWorld world, render::MeshCache meshes = {});
/// Makes a document of the parts of a world that were read so far, without its scene.
[[nodiscard]] std::shared_ptr<Document> preview_document(const std::string& path, const WorldLoading& loading,
                                                         render::RenderList list);

/// Files of the session. Bookkeeping only: neither reads files nor draws.
class DocumentList {
 public:
  struct Entry {
    std::string path;
    bool stale = true;                             // to be read (again) when a viewport shows it
    std::uint64_t reading = 0;                     // number of the current reading; 0 means none
    std::shared_ptr<Document> document;            // null until the file is read
    std::shared_ptr<std::atomic<bool>> cancelled;  // cancellation flag of the current reading
  };
  /// Reading of a file that has begun. The reader polls `cancelled`.
  struct Reading {
    std::uint64_t number = 0;
    std::string path;
    std::shared_ptr<std::atomic<bool>> cancelled;
  };

  /// Adds a file, or marks it to be read again if it is already listed. Ignores an empty path.
  void add(std::string_view path);
  /// Marks a file to be read again.
  void reload(std::string_view path);

  /// Begins to read a file. Returns nullopt if it is up to date or already being read.
  [[nodiscard]] std::optional<Reading> begin(std::string_view path);
  /// Stores the result of a reading. Returns its path, or nullopt if the reading was cancelled; the result is then
  /// dropped.
  std::optional<std::string> deliver(std::uint64_t reading, std::shared_ptr<Document> document);
  /// Shows a partial result, unless an older version of the file is open. Returns the path, or nullopt if nothing was
  /// shown.
  std::optional<std::string> preview(std::uint64_t reading, std::shared_ptr<Document> document);
  /// Ends a reading that failed. The file leaves the list unless an older version is open. Returns the path, or nullopt
  /// if the reading was cancelled.
  std::optional<std::string> fail(std::uint64_t reading);
  /// Cancels the reading of a file. The next request reads it from the beginning.
  void cancel(std::string_view path);
  /// Cancels a file. An older version stays open; without one, the file leaves the list.
  void give_up(std::string_view path);
  /// Cancels all readings.
  void cancel_all();

  [[nodiscard]] const std::vector<Entry>& entries() const { return entries_; }
  [[nodiscard]] const Entry* find(std::string_view path) const;
  [[nodiscard]] std::shared_ptr<Document> document(std::string_view path) const;
  /// Returns the document of the file that a reading belongs to, or null.
  [[nodiscard]] std::shared_ptr<Document> document_of(std::uint64_t reading) const;
  /// Returns true if a file is being read or waits to be read.
  [[nodiscard]] bool awaited(std::string_view path) const;
  /// Returns true if a file's world is open and parts of it are still loading.
  [[nodiscard]] bool arriving(std::string_view path) const;

 private:
  [[nodiscard]] Entry* entry(std::string_view path);
  [[nodiscard]] Entry* entry_of(std::uint64_t reading);

  std::vector<Entry> entries_;
  std::uint64_t readings_ = 0;
};

/// Returns the last part of a path or URL.
[[nodiscard]] std::string file_label(std::string_view path);

}  // namespace gs::app
