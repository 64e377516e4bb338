#pragma once

#include "app/session/documents/living_world.h"
#include "app/world/opened_world.h"
#include "app/world/world_loading.h"
#include "qnv/base/cloud.h"
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

/// An opened world: what all that look at it share.
struct Document {
  OpenedWorld world;
  render::MeshCache meshes;
  std::unique_ptr<LivingWorld> living;             // null: it has no scene (yet)
  std::shared_ptr<LivingScene> first_scene;        // as it is first seen; null: it has no scene (yet)
  std::shared_ptr<const render::RenderList> list;  // of `first_scene`, or of what has come so far; never null
  Upright upright;                                 // how it stands, by its format or what it says itself
  bool is_preview = false;                         // more of it comes, and it has no scene yet
  bool viewer_dependent = false;                   // has LOD or Billboard nodes: who moves needs a list of his own
  bool has_navigation_info = false;
  bool has_surface_clouds = false, has_volumes = false;  // of QNV vectors
  std::shared_ptr<WorldReader> reader;  // that still reads what arrives, and of streams what views want; null: none
  LoadingState arriving;                // how far it is; nothing waits when all is there
  bool all_came = false;
  const void* viewer = nullptr;           // the view whose place its sensors know
  std::optional<glm::dvec3> destination;  // to which its viewer is on the way
  bool controlled = false;                // a client of --control has changed it, and may have made its Scripts

  [[nodiscard]] bool has_clouds() const { return has_surface_clouds || has_volumes; }
};

/// A world that was opened and has not begun to live. `meshes`: what was made of its nodes before. Any thread that owns
/// it.
[[nodiscard]] std::shared_ptr<Document> hold_world(OpenedWorld world, render::MeshCache meshes = {});
/// Brings it to life at `now`, in seconds since 1970, and gathers what is visible. Once.
void begin_world(Document& document, double now);
/// Takes in what has come for a living world. True where there are other nodes than before: Inlines and bodies of
/// EXTERNPROTOs.
bool arrive(Document& document, Arrivals&& arrivals);
/// `hold_world` and `begin_world` at once, at the present time; but a world with Scripts begins on the thread that lets
/// it live: here its meshes are made.
[[nodiscard]] std::shared_ptr<Document> make_document(OpenedWorld world, render::MeshCache meshes = {});
/// A world that is still being read: what there is to see, without its scene.
[[nodiscard]] std::shared_ptr<Document> preview_document(const std::string& path, const WorldLoading& loading,
                                                         render::RenderList list);

/// The files of the session. Plain bookkeeping: it neither reads nor draws.
class DocumentList {
 public:
  struct Entry {
    std::string path;
    bool stale = true;                             // to be read (again) once somebody wants to see it
    std::uint64_t reading = 0;                     // the number of the reading that goes on; 0: none
    std::shared_ptr<Document> document;            // null until it was read
    std::shared_ptr<std::atomic<bool>> cancelled;  // of the reading that goes on
  };
  /// One reading of a file, begun. Who reads looks at `cancelled` now and then.
  struct Reading {
    std::uint64_t number = 0;
    std::string path;
    std::shared_ptr<std::atomic<bool>> cancelled;
  };

  /// Adds a file; one that is in the list already is read again. An empty path is ignored.
  void add(std::string_view path);
  /// Marks a file to be read again.
  void reload(std::string_view path);

  /// Begins to read a file, if it has to be read and is not being read.
  [[nodiscard]] std::optional<Reading> begin(std::string_view path);
  /// A reading has become this. The path, or nothing when it was cancelled meanwhile: then it is dropped.
  std::optional<std::string> deliver(std::uint64_t reading, std::shared_ptr<Document> document);
  /// So much of it has come. Does nothing where an older state of the file is open. The path, or nothing.
  std::optional<std::string> preview(std::uint64_t reading, std::shared_ptr<Document> document);
  /// A reading came to nothing: its file leaves the list, unless an older state of it is open. The path, or nothing
  /// when it was cancelled meanwhile.
  std::optional<std::string> fail(std::uint64_t reading);
  /// Nobody waits for this file any more. It will be read from its beginning when somebody does again.
  void cancel(std::string_view path);
  /// Nobody wants to read this file any more: an older state of it stays, else it leaves the list.
  void give_up(std::string_view path);
  /// Nobody waits for anything any more.
  void cancel_all();

  [[nodiscard]] const std::vector<Entry>& entries() const { return entries_; }
  [[nodiscard]] const Entry* find(std::string_view path) const;
  [[nodiscard]] std::shared_ptr<Document> document(std::string_view path) const;
  /// What is there of the file that a reading is of.
  [[nodiscard]] std::shared_ptr<Document> document_of(std::uint64_t reading) const;
  /// True when a file is being read or waits for it.
  [[nodiscard]] bool awaited(std::string_view path) const;
  /// True when a file's world is there, and something of it is still to come.
  [[nodiscard]] bool arriving(std::string_view path) const;

 private:
  [[nodiscard]] Entry* entry(std::string_view path);
  [[nodiscard]] Entry* entry_of(std::uint64_t reading);

  std::vector<Entry> entries_;
  std::uint64_t readings_ = 0;
};

/// The last part of a path or URL.
[[nodiscard]] std::string file_label(std::string_view path);

}  // namespace gs::app
