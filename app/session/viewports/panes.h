#pragma once

#include "app/session/documents/documents.h"
#include "app/session/viewports/view.h"
#include "app/view/input_tracker.h"
#include "app/view/panes/pane_request.h"
#include "app/view/panes/split_tree.h"
#include "render/draw/renderer.h"

#include <glm/vec2.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace gs::app {

/// File that a viewport could not show, with the first error.
struct PaneFailure {
  std::string path, error;
};

/// Viewport of the window: its file and its views.
struct Pane {
  static constexpr double kMinWeight = 0.25, kMaxWeight = 4;

  std::string wanted;                 // path of the file that the viewport should show; empty means none
  std::string shown;                  // path of the visible file: `wanted`, or the previous one until `wanted` is read
  std::map<std::string, View> views;  // by path; a file that is shown again gets its former view
  InputTracker input;
  render::FrameStatistics statistics;
  double weight = 1;                   // weight when the vector budget and the bandwidth are divided
  std::optional<std::uint64_t> rate;   // bandwidth limit in bits/s; 0 means unlimited, nullopt the limit of the session
  std::optional<PaneFailure> failure;  // kept until the viewport shows another file, or the user dismisses it

  /// Returns the view of the shown file; null if there is none.
  [[nodiscard]] View* view();
  [[nodiscard]] const View* view() const;
};

/// All viewports and their files. Bookkeeping only: neither reads files nor draws.
class Panes {
 public:
  /// Shows the files of the command line, one in each viewport. Uses the smallest layout with enough viewports; further
  /// files are only listed. If the user chose a split, viewports without a file show the first one.
  void start(std::span<const std::string> paths, const std::optional<SplitTree>& split = {});
  /// Adds files that the user dropped or chose. The first one is shown in the active viewport, the others in free
  /// visible viewports. A file that is already listed is read again. Ignores empty paths.
  void open(std::span<const std::string> paths);
  /// Shows the file at an index of the list in the active viewport.
  void select(std::size_t file);
  /// Reads the file of the active viewport again.
  void reload() { reload(active_); }
  void reload(std::size_t pane);
  /// Marks a file to be read again when a viewport shows it.
  void reload(std::string_view path) { documents_.reload(path); }

  /// Sets the arrangement of the viewports. If the active viewport is no longer visible, activates another one.
  void set_split(SplitTree split);
  /// Sets new sizes of the viewports. Their arrangement must not change.
  void set_shape(SplitTree split) { split_ = std::move(split); }
  [[nodiscard]] const SplitTree& split() const { return split_; }
  /// Splits a viewport and activates the new half. The new half shows a listed file that no viewport shows; if there is
  /// none, it gets a copy of the view. Returns false if the maximum number of viewports is reached.
  bool split_pane(std::size_t pane, SplitAxis axis);
  /// Closes a viewport and removes its views. The only viewport stays, without a file, and shows the start page.
  /// Returns false if it has no file already.
  bool close(std::size_t pane);
  /// Shows a file in a viewport.
  void show_in(std::size_t pane, const std::string& path);
  /// Activates a viewport, which then receives the keys. Makes a hidden viewport with a file visible: alone, with its
  /// pair, or in place of the formerly active one.
  void activate(std::size_t pane);
  [[nodiscard]] std::size_t active() const { return active_; }
  /// Returns the indices of the visible viewports in layout order.
  [[nodiscard]] std::vector<std::size_t> visible() const { return panes_in_sight(split_); }
  [[nodiscard]] Pane& at(std::size_t pane) { return panes_[pane]; }
  [[nodiscard]] const Pane& at(std::size_t pane) const { return panes_[pane]; }
  /// Returns all viewports, by index.
  [[nodiscard]] std::span<Pane> all() { return panes_; }

  /// Returns true if a viewport's file is being read or waits to be read.
  [[nodiscard]] bool loading(std::size_t pane) const {
    return documents_.awaited(panes_[pane].wanted) || documents_.arriving(panes_[pane].wanted);
  }
  /// Applies the camera of viewport `leader` to all other visible viewports; see link_view().
  void link(std::size_t leader);
  /// Returns the views of the visible viewports, and those over them.
  [[nodiscard]] std::vector<View*> views_in_sight();
  /// Adds a file that is drawn over the content of a viewport. Does nothing if it is there already.
  void add_over(std::size_t pane, const std::string& path);
  /// Removes content that is drawn over that of a viewport, by its index.
  void remove_over(std::size_t pane, std::size_t index);
  /// Returns true if a viewport should show this file.
  [[nodiscard]] bool wanted_by_any(std::string_view path) const;
  /// Releases all keys and drags.
  void release_input();

  [[nodiscard]] DocumentList& documents() { return documents_; }
  [[nodiscard]] const DocumentList& documents() const { return documents_; }
  /// Returns the index in the list of files of the active viewport's file; nullopt if it has none.
  [[nodiscard]] std::optional<std::size_t> selected() const;

 private:
  void want(std::size_t pane, const std::string& path);
  void fill(std::size_t pane, std::size_t model);
  [[nodiscard]] std::optional<std::size_t> free_pane() const;
  void cancel_unwanted();

  std::array<Pane, kMaxViewports> panes_;
  SplitTree split_;
  std::size_t active_ = 0;
  DocumentList documents_;
};

}  // namespace gs::app
