#pragma once

#include "app/session/session.h"
#include "app/settings/settings_store.h"

#include <cstddef>
#include <optional>
#include <string>

namespace gs::app {

/// Bookmarks of the user, and their relation to the active viewport of a session. Main thread.
class ViewBookmarks {
 public:
  /// Both arguments must outlive the object.
  ViewBookmarks(Session& session, SettingsStore& store) : session_(session), store_(store) {}

  /// Returns the index of the bookmark of the active viewport's view; nullopt if there is none.
  [[nodiscard]] std::optional<std::size_t> find() const;
  /// Removes the bookmark of the view, or adds one. Returns a notice for the user; empty if there is no view.
  [[nodiscard]] std::string toggle();
  void remove(std::size_t index);
  /// Opens the file of a bookmark, at its Viewpoint and camera.
  void open(std::size_t index);

 private:
  [[nodiscard]] std::optional<Bookmark> bookmark_of_view() const;

  Session& session_;
  SettingsStore& store_;
};

/// Returns the title of a world, made of its title and its file name.
[[nodiscard]] std::string title_of_world(const std::string& title, const std::string& file);

}  // namespace gs::app
