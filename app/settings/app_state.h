#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gs::app {

/// Saved camera position in a world.
struct Bookmark {
  static constexpr std::size_t kCameraNumbers = 7, kParallelNumbers = 8;

  std::string place;      // path or URL
  std::string viewpoint;  // name of the Viewpoint in that world; empty means none
  std::string title;      // title in the menu
  /// x, y, z, and the orientation's x, y, z, w; for an orthographic camera also the height of the picture in world
  /// units. Empty means the Viewpoint's own camera.
  std::vector<double> camera;

  bool operator==(const Bookmark&) const = default;
};

/// Position of a panel.
struct PanelMemory {
  std::string panel;  // id
  std::string side;
  bool open = false, front = false;

  bool operator==(const PanelMemory&) const = default;
};

/// State that the program stores by itself between windows.
struct AppState {
  static constexpr std::size_t kMaxRecent = 50;

  std::vector<std::string> recent;          // paths and URLs, newest first
  int width = 0, height = 0;                // of the window; 0 means unknown
  std::optional<std::array<int, 2>> place;  // upper left corner of the window on the desktop; nullopt means unknown
  std::array<double, 3> areas{};            // of the dock: left, right, bottom; 0 means unknown
  std::vector<PanelMemory> panels;          // in the order of their tabs

  bool operator==(const AppState&) const = default;
};
/// Moves a path or URL to the front of the recent list, without duplicates.
void note_recent(AppState& state, const std::string& place);

/// Files of a window, stored so that they can be restored if the program ends unexpectedly.
struct SessionMemory {
  /// One viewport of the window.
  struct Viewport {
    std::size_t number = 0;  // from 1, as in `split`
    std::string file;        // empty means none
    double weight = 1;       // of its shares; 0 means unknown
    bool operator==(const Viewport&) const = default;
  };
  std::vector<std::string> files;
  std::string split{};  // split into viewports, see split_text(); empty means unknown
  std::vector<Viewport> viewports{};
  bool operator==(const SessionMemory&) const = default;
};

/// Convert these structs to JSON and back. Readers omit unexpected values, and return nullopt if the text is not JSON
/// of this kind. Safe for untrusted text.
[[nodiscard]] std::string memory_text(const AppState& state);
[[nodiscard]] std::optional<AppState> read_memory(std::string_view text);
[[nodiscard]] std::string bookmarks_text(const std::vector<Bookmark>& bookmarks);
[[nodiscard]] std::optional<std::vector<Bookmark>> read_bookmarks(std::string_view text);
[[nodiscard]] std::string session_text(const SessionMemory& session);
[[nodiscard]] std::optional<SessionMemory> read_session(std::string_view text);

}  // namespace gs::app
