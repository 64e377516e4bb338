#pragma once

#include "app/session/viewports/panes.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gs::app {

/// Connection between viewports and the readings of their files: chooses files to read, and makes views of the results.
/// Bookkeeping only: neither reads files nor draws.
class PaneLoading {
 public:
  explicit PaneLoading(Panes& panes) : panes_(panes) {}

  /// Begins to read a file for which a visible viewport waits; the active viewport has precedence. Returns nullopt if
  /// none waits.
  [[nodiscard]] std::optional<DocumentList::Reading> begin();
  /// Stores the document of a reading. Replaces the views of an older document of the same file.
  void deliver(std::uint64_t reading, std::shared_ptr<Document> document, const glm::vec2& viewport);
  /// Stores a partial document of a reading, for display.
  void preview(std::uint64_t reading, std::shared_ptr<Document> document);
  /// Updates the views of a running world to which nodes were added. A viewer that has not moved sees the whole world.
  void grow(const Document& document);
  /// Ends a failed reading and reports the error in the viewports that waited for it. Each returns to its previous
  /// file; if it had none, it shows a listed file that no viewport shows. Returns these viewports.
  std::vector<std::size_t> fail(std::uint64_t reading, const std::string& error = {});
  /// Reports an error in every viewport of a file that was read but has nothing to draw.
  void note_failure(const std::string& path, const std::string& error);
  /// Cancels the file for which a viewport waits, and returns to the previous one. Returns false if the viewport does
  /// not wait for a file.
  bool cancel(std::size_t pane);
  /// Cancels all readings.
  void cancel_all() { panes_.documents().cancel_all(); }

  /// Viewport that now shows another file.
  struct Change {
    std::size_t pane = 0;
    bool first = false;  // the viewport shows this file for the first time
    bool found = true;  // false if the file has no Viewpoint of the requested name
  };
  /// Shows files in the viewports that wait for them, after they have been read. `places` are the rectangles of the
  /// visible viewports, in the order of Panes::visible(). Initial views are fitted to them until the user moves.
  /// `viewpoint` is the name of the initial Viewpoint; empty means the first one.
  std::vector<Change> settle(std::span<const Viewport> places, std::string_view viewpoint);
  /// Shows content over that of visible viewports after it has been read. Returns true if there is new content.
  bool settle_over();
  /// Sets the style of files that are shown for the first time.
  void set_style(const ViewStyle& style) { style_ = style; }
  [[nodiscard]] const ViewStyle& style() const { return style_; }

 private:
  Panes& panes_;
  ViewStyle style_;
};

}  // namespace gs::app
