#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gs::app {

/// Bookmark: a world and a camera or Viewpoint in it.
struct Bookmark {
  static constexpr std::size_t kCameraNumbers = 7, kParallelNumbers = 8;

  std::string place;      // path or URL
  std::string viewpoint;  // name of a Viewpoint of that world; empty means none
  std::string title;      // title in the menu
  /// Position x, y, z and orientation x, y, z, w of the camera. For an orthographic camera, the height of the picture
  /// in world units follows. Empty means the camera of the Viewpoint.
  std::vector<double> camera;

  bool operator==(const Bookmark&) const = default;
};

/// Saved position of a panel in the dock.
struct PanelMemory {
  std::string panel;  // PanelRow::id
  std::string side;
  bool open = false, front = false;

  bool operator==(const PanelMemory&) const = default;
};

/// State that the program itself saves for the next window.
struct AppState {
  static constexpr std::size_t kMaxRecent = 50;

  std::vector<std::string> recent;          // paths and URLs, newest first
  int width = 0, height = 0;  // size of the window; 0 means unknown
  std::optional<std::array<int, 2>> place;  // upper left corner of the window on the desktop; nullopt means unknown
  std::array<double, 3> areas{};  // sizes of the dock areas: left, right, bottom; 0 means unknown
  std::vector<PanelMemory> panels;          // in the order of their tabs

  bool operator==(const AppState&) const = default;
};
/// Moves a path or URL to the front of the recent files, without duplicates. Ignores presigned URLs, which expire.
void note_recent(AppState& state, const std::string& place);

/// Files and viewports of a window. They are saved so that they can be restored after a crash.
struct SessionMemory {
  /// One viewport of the window.
  struct Viewport {
    std::size_t number = 0;  // from 1, as in `split`
    std::string file;  // path or URL; empty for an empty viewport
    double weight = 1;  // weight when budget and bandwidth are divided; 0 means unknown
    bool operator==(const Viewport&) const = default;
  };
  std::vector<std::string> files;
  std::string split{};  // arrangement of the viewports, see split_text(); empty means unknown
  std::vector<Viewport> viewports{};
  bool operator==(const SessionMemory&) const = default;
};

/// Converts the state to JSON. The other functions do so for the other types, and back. Reading omits values of a wrong
/// type; it returns nullopt if the text is no JSON of this kind. Safe for untrusted text.
[[nodiscard]] std::string memory_text(const AppState& state);
[[nodiscard]] std::optional<AppState> read_memory(std::string_view text);
[[nodiscard]] std::string bookmarks_text(const std::vector<Bookmark>& bookmarks);
[[nodiscard]] std::optional<std::vector<Bookmark>> read_bookmarks(std::string_view text);
[[nodiscard]] std::string session_text(const SessionMemory& session);
[[nodiscard]] std::optional<SessionMemory> read_session(std::string_view text);

}  // namespace gs::app
