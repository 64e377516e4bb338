#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gs::app {

/// A place to come back to.
struct Bookmark {
  static constexpr std::size_t kCameraNumbers = 7, kParallelNumbers = 8;

  std::string place;      // path or URL
  std::string viewpoint;  // by its name in that world; empty: none
  std::string title;      // how it is shown
  /// x, y, z, and the orientation's x, y, z, w; by parallel rays also the height of the picture in world units. Empty:
  /// the viewpoint's own.
  std::vector<double> camera;

  bool operator==(const Bookmark&) const = default;
};

/// Where a panel stood.
struct PanelMemory {
  std::string panel;  // id
  std::string side;
  bool open = false, front = false;

  bool operator==(const PanelMemory&) const = default;
};

/// What the program remembers by itself from one window to the next.
struct UserMemory {
  static constexpr std::size_t kMostRecent = 50;

  std::vector<std::string> recent;          // paths and URLs, the newest first
  int width = 0, height = 0;                // of the window; 0: not known
  std::optional<std::array<int, 2>> place;  // likewise, its upper left corner on the desktop; none: not known
  std::array<double, 3> areas{};            // of the dock: left, right, bottom; 0: not known
  std::vector<PanelMemory> panels;          // in the order of their tabs

  bool operator==(const UserMemory&) const = default;
};
/// The newest place comes first; what is listed already is not listed twice.
void note_recent(UserMemory& memory, const std::string& place);

/// The files of a window, as it is: what is offered where it ends by itself.
struct SessionMemory {
  /// What one of its viewports shows.
  struct Viewport {
    std::size_t number = 0;  // from 1, as in `split`
    std::string file;        // empty: none
    double weight = 1;       // of its shares; 0: not known
    bool operator==(const Viewport&) const = default;
  };
  std::vector<std::string> files;
  std::string split{};  // how it is split into viewports, see split_text; empty: not known
  std::vector<Viewport> viewports{};
  bool operator==(const SessionMemory&) const = default;
};

/// JSON of them, and back. Anything may stand in the text: what is not as expected is left out; nothing: it is no JSON
/// of this kind at all.
[[nodiscard]] std::string memory_text(const UserMemory& memory);
[[nodiscard]] std::optional<UserMemory> read_memory(std::string_view text);
[[nodiscard]] std::string bookmarks_text(const std::vector<Bookmark>& bookmarks);
[[nodiscard]] std::optional<std::vector<Bookmark>> read_bookmarks(std::string_view text);
[[nodiscard]] std::string session_text(const SessionMemory& session);
[[nodiscard]] std::optional<SessionMemory> read_session(std::string_view text);

}  // namespace gs::app
