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

/// Readings of the files that viewports want, and their results as views. Bookkeeping only: neither reads files nor
/// draws.
class PaneLoading {
 public:
  explicit PaneLoading(Panes& panes) : panes_(panes) {}

  /// Begins to read a file that a visible viewport waits for, the active one first. Returns nullopt if none waits.
  [[nodiscard]] std::optional<DocumentList::Reading> begin();
  /// Stores the result of a reading, and renews the views of an older version of the file.
  void deliver(std::uint64_t reading, std::shared_ptr<Document> document, const glm::vec2& viewport);
  /// Shows the partial result of a reading.
  void preview(std::uint64_t reading, std::shared_ptr<Document> document);
  /// Updates the views of a running world that has new nodes. Viewers that have not moved see the whole world.
  void grow(const Document& document);
  /// Ends a failed reading. The viewports that waited for it report the error and return to the previous file, or show
  /// a file that no other viewport shows. Returns these viewports; empty if none waited.
  std::vector<std::size_t> fail(std::uint64_t reading, const std::string& error = {});
  /// Reports, in every viewport that shows this file, that it was read but has nothing to draw.
  void note_failure(const std::string& path, const std::string& error);
  /// Cancels the file that a viewport waits for and returns to the previous one. Returns false if it waits for none.
  bool cancel(std::size_t pane);
  /// Cancels all readings.
  void cancel_all() { panes_.documents().cancel_all(); }

  /// Viewport that shows another file than before.
  struct Change {
    std::size_t pane = 0;
    bool first = false;  // the viewport has not shown this file before
    bool found = true;   // false if no Viewpoint has the requested name
  };
  /// Shows files that were read in the viewports that wait for them. `places` are the rectangles of the visible
  /// viewports; initial views fit them until the user moves. `viewpoint` is the name of the initial Viewpoint, or
  /// empty.
  std::vector<Change> settle(std::span<const Viewport> places, std::string_view viewpoint);
  /// Sets the style of files that are shown for the first time.
  void set_style(const ViewStyle& style) { style_ = style; }
  [[nodiscard]] const ViewStyle& style() const { return style_; }

 private:
  Panes& panes_;
  ViewStyle style_;
};

}  // namespace gs::app
