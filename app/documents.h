#pragma once

#include "app/navigation.h"
#include "app/viewer.h"
#include "render/render_list.h"

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gs::app {

/// An opened world and how it is being looked at.
struct Document {
  OpenedWorld world;
  render::MeshCache meshes;
  render::RenderList list;
  bool viewer_dependent = false;  // has LOD or Billboard nodes: `list` must follow the viewer
  bool has_navigation_info = false;
  glm::vec3 collected_for{0, 0, 10};  // the viewer's place for which `list` was made

  bool entered = false;
  NavigationRules rules;
  Navigation navigation;
  Pose home;                             // of the bound Viewpoint, or the first view of the whole
  std::optional<std::size_t> viewpoint;  // the bound one
  bool headlight = true;
};

/// Gathers what is visible in a world that was opened. Any thread that owns it.
[[nodiscard]] std::unique_ptr<Document> make_document(OpenedWorld world);

/// Puts the viewer where the world is first seen from: at the Viewpoint named `viewpoint`, else at the first
/// one, else so that the whole is in view. False when a name was given that no Viewpoint has.
bool enter(Document& document, const glm::vec2& viewport, std::string_view viewpoint);

/// Gathers again when the viewer has come so far that other levels of detail may be due.
/// True when the list was made anew.
bool follow_viewer(Document& document);

/// The files of the session, of which one is shown. Plain bookkeeping: it neither reads nor draws.
class DocumentList {
 public:
  struct Entry {
    std::string path;
    bool stale = true;                   // to be read (again) once it is selected
    std::unique_ptr<Document> document;  // null until it was read
  };

  /// Adds files that were named, dropped or chosen, and selects the first of them. A path that is already
  /// in the list is read again. Empty paths are ignored.
  void open(std::span<const std::string> paths);
  void select(std::size_t index);
  /// Marks the selected file to be read again.
  void reload();

  /// The path of the selected file if it has to be read and nothing is being read; it then counts as
  /// being read until `deliver` or `fail`.
  [[nodiscard]] std::optional<std::string> begin_loading();
  /// The path that is being read, or empty.
  [[nodiscard]] const std::string& loading() const { return loading_; }
  /// The file being read has become this.
  void deliver(std::unique_ptr<Document> document);
  /// The file being read could not be opened: it leaves the list, unless an older state of it is open.
  void fail();

  [[nodiscard]] const std::vector<Entry>& entries() const { return entries_; }
  [[nodiscard]] std::size_t selected() const { return selected_; }
  /// What is to be shown: the selected document, or the one before until that is read. Null: nothing yet.
  [[nodiscard]] Document* shown();

 private:
  [[nodiscard]] std::optional<std::size_t> find(std::string_view path) const;

  std::vector<Entry> entries_;
  std::size_t selected_ = 0;
  std::string shown_;  // path of what is shown
  std::string loading_;
};

/// The last part of a path or URL.
[[nodiscard]] std::string file_label(std::string_view path);

}  // namespace gs::app
