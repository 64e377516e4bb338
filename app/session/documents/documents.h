#pragma once

#include "app/loading/updates/loaded_world.h"
#include "app/loading/world_loading.h"
#include "app/session/documents/splat_edits.h"
#include "app/session/documents/world_edits.h"
#include "app/session/running/world_runtime.h"
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

/// Opened world. All views of the world share it.
struct Document {
  LoadedWorld world;
  render::MeshCache meshes;
  std::unique_ptr<WorldRuntime> runtime;           // null until there is a scene
  std::shared_ptr<RuntimeScene> first_scene;       // render scene for the initial view; null until there is a scene
  std::shared_ptr<const render::RenderList> list;  // of `first_scene`, or of the parts received so far; never null
  Upright upright;                                 // up axis, from the format or from the file
  bool is_preview = false;                         // only a part was received, and there is no scene yet
  bool viewer_dependent = false;  // has LOD or Billboard nodes, so each moving viewer needs an own render list
  bool has_navigation_info = false;
  bool has_surface_vectors = false, has_volumes = false;  // kinds of QNV data in the world
  std::shared_ptr<WorldReader> reader;  // reader of references and of stream parts that views need; may be null
  LoadingState arriving;                // progress of loading; empty after everything was loaded
  bool all_came = false;
  const void* viewer = nullptr;           // view with the camera that the sensors follow; never dereferenced
  std::optional<glm::dvec3> destination;  // destination of that camera's animated move
  WorldEdits edits;                       // edits of the user
  SplatEdits splats;                      // edit of the splats of a file
  VoxelComponent data;                    // choice of data with which it was read; its list has those of the file
  bool controlled = false;                // changed by a --control client, which may also have created its Scripts

  /// Returns true if edits of the user are not saved.
  [[nodiscard]] bool unsaved() const { return edits.unsaved() || splats.unsaved(); }
  [[nodiscard]] bool has_vectors() const { return has_surface_vectors || has_volumes; }
};

/// Makes a document from an opened world. Time does not start yet. `meshes` holds meshes that were already made for its
/// nodes. Any thread, if it owns the world.
[[nodiscard]] std::shared_ptr<Document> hold_world(LoadedWorld world, render::MeshCache meshes = {});
/// Starts the world at `now`, in seconds since 1970, and collects its render list. Call once.
void begin_world(Document& document, double now);
/// Applies updates from the reader to a running world. Returns true if nodes were added by Inlines or EXTERNPROTOs.
bool arrive(Document& document, ResourceUpdates&& updates);
/// Calls hold_world(), and begin_world() at the present time. But a world with Scripts must be started by the thread
/// that will run it; for such a world, only the meshes are made.
[[nodiscard]] std::shared_ptr<Document> make_document(LoadedWorld world, render::MeshCache meshes = {});
/// Makes a document from the parts of a world that were read so far. The document has no scene.
[[nodiscard]] std::shared_ptr<Document> preview_document(const std::string& path, const WorldLoading& loading,
                                                         render::RenderList list);

/// List of the session's files. It does bookkeeping only: it neither reads files nor draws.
class DocumentList {
 public:
  struct Entry {
    std::string path;
    bool stale = true;                             // must be read, or read again, when a viewport shows the file
    std::uint64_t reading = 0;                     // serial number of the current reading; 0 means that there is none
    std::shared_ptr<Document> document;            // null until the file is read
    std::shared_ptr<std::atomic<bool>> cancelled;  // cancellation flag of the current reading
  };
  /// Reading in progress. The reader polls `cancelled`.
  struct Reading {
    std::uint64_t number = 0;
    std::string path;
    std::shared_ptr<std::atomic<bool>> cancelled;
  };

  /// Adds a file to the list. If the file is already listed, marks it to be read again, unless its world has unsaved
  /// edits. Ignores an empty path.
  void add(std::string_view path);
  /// Marks a file to be read again.
  void reload(std::string_view path);
  /// Marks a file to be read again, unless its world has unsaved edits.
  void reload_unedited(std::string_view path);

  /// Begins to read a file. Returns nullopt if the document is up to date or the file is already being read.
  [[nodiscard]] std::optional<Reading> begin(std::string_view path);
  /// Stores the document that a reading produced. Returns the path. Returns nullopt and drops the document if the
  /// reading was cancelled.
  std::optional<std::string> deliver(std::uint64_t reading, std::shared_ptr<Document> document);
  /// Stores a partial document of a reading. Returns the path. Returns nullopt and drops the document if an older
  /// complete one is open.
  std::optional<std::string> preview(std::uint64_t reading, std::shared_ptr<Document> document);
  /// Ends a reading that failed. Removes the file from the list, unless an older document of it is open. Returns the
  /// path; nullopt if the reading was cancelled.
  std::optional<std::string> fail(std::uint64_t reading);
  /// Cancels the reading of a file. The next reading starts from the beginning of the file.
  void cancel(std::string_view path);
  /// Cancels the reading of a file and gives it up. Removes the file from the list, unless an older document of it is
  /// open.
  void give_up(std::string_view path);
  /// Cancels all readings.
  void cancel_all();

  [[nodiscard]] const std::vector<Entry>& entries() const { return entries_; }
  [[nodiscard]] const Entry* find(std::string_view path) const;
  [[nodiscard]] std::shared_ptr<Document> document(std::string_view path) const;
  /// Returns the document of the file that a reading belongs to; null if there is none.
  [[nodiscard]] std::shared_ptr<Document> document_of(std::uint64_t reading) const;
  /// Returns true if a file is being read or waits to be read.
  [[nodiscard]] bool awaited(std::string_view path) const;
  /// Returns true if the file's world is open but parts of it are still loading.
  [[nodiscard]] bool arriving(std::string_view path) const;

 private:
  [[nodiscard]] Entry* entry(std::string_view path);
  [[nodiscard]] Entry* entry_of(std::uint64_t reading);

  std::vector<Entry> entries_;
  std::uint64_t readings_ = 0;
};

/// Returns the last part of a path or URL; behind it the number of a further view of the file.
[[nodiscard]] std::string file_label(std::string_view path);

/// Entries of the list may be further views of a file, with other data of it: "run.h5#view=2".
[[nodiscard]] std::string further_view(std::string_view path, std::size_t number);
/// Returns the number of a further view, at least 2; 1 for a path without one.
[[nodiscard]] std::size_t view_number(std::string_view path);
/// Returns the path of the file of an entry.
[[nodiscard]] std::string file_of_view(std::string_view path);

}  // namespace gs::app
