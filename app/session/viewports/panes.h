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

/// File that a viewport could not show, with the first error and its position in the file.
struct PaneFailure {
  std::string path, error;
};

/// Viewport of the window: the file that it shows, and its views.
struct Pane {
  static constexpr double kMinWeight = 0.25, kMaxWeight = 4;

  std::string wanted;                 // path of the chosen file; empty means none
  std::string shown;                  // path of the visible file: `wanted`, or the previous file until `wanted` is read
  std::map<std::string, View> views;  // by path; returning to a file restores its view
  InputTracker input;
  render::FrameStatistics statistics;
  double weight = 1;                   // weight of its share of the vector budget and of the bandwidth
  std::optional<std::uint64_t> rate;   // max bits per second; 0 means unlimited, nullopt means the session's limit
  std::optional<PaneFailure> failure;  // until the viewport shows another file, or the user dismisses it

  /// Returns the view on the screen, or null if there is none.
  [[nodiscard]] View* view();
  [[nodiscard]] const View* view() const;
};

/// Viewports and their files. Bookkeeping only: neither reads files nor draws.
class Panes {
 public:
  /// Shows the files of the command line, one per viewport, in the smallest layout that has enough viewports. Excess
  /// files are only listed. In a split that the user chose, remaining viewports show the first file.
  void start(std::span<const std::string> paths, const std::optional<SplitTree>& split = {});
  /// Adds files that the user dropped or chose. The first is shown in the active viewport, the others in free visible
  /// viewports. A path that is already listed is read again. Ignores empty paths.
  void open(std::span<const std::string> paths);
  /// Shows a listed file in the active viewport.
  void select(std::size_t file);
  /// Reads the file of the active viewport again.
  void reload();
  /// Reads this file again once a viewport shows it.
  void reload(std::string_view path) { documents_.reload(path); }

  /// Sets the split of the window. The active viewport becomes a visible one.
  void set_split(SplitTree split);
  /// Changes the sizes of the viewports only.
  void set_shape(SplitTree split) { split_ = std::move(split); }
  [[nodiscard]] const SplitTree& split() const { return split_; }
  /// Splits viewport `pane` and activates the new half. It shows a listed file that no other viewport shows, or else
  /// copies the view of `pane`. Returns false if the maximum number of viewports is reached.
  bool split_pane(std::size_t pane, SplitAxis axis);
  /// Closes a viewport and forgets its views. Returns false if it is the only one.
  bool close(std::size_t pane);
  /// Shows a file in a viewport.
  void show_in(std::size_t pane, const std::string& path);
  /// Activates a viewport, which then receives the keys. A hidden viewport with a file becomes visible: alone, with its
  /// pair, or instead of the previously active one.
  void activate(std::size_t pane);
  [[nodiscard]] std::size_t active() const { return active_; }
  /// Returns the visible viewports in layout order.
  [[nodiscard]] std::vector<std::size_t> visible() const { return panes_in_sight(split_); }
  [[nodiscard]] Pane& at(std::size_t pane) { return panes_[pane]; }
  [[nodiscard]] const Pane& at(std::size_t pane) const { return panes_[pane]; }
  /// Returns all viewports, by number.
  [[nodiscard]] std::span<Pane> all() { return panes_; }

  /// Returns true if a viewport's file is being read or waits to be read.
  [[nodiscard]] bool loading(std::size_t pane) const {
    return documents_.awaited(panes_[pane].wanted) || documents_.arriving(panes_[pane].wanted);
  }
  /// Links all other visible viewports to the camera of this one; see `link_view`.
  void link(std::size_t leader);
  /// Returns true if a viewport shows this file or waits for it.
  [[nodiscard]] bool wanted_by_any(std::string_view path) const;
  /// Releases all keys and drags.
  void release_input();

  [[nodiscard]] DocumentList& documents() { return documents_; }
  [[nodiscard]] const DocumentList& documents() const { return documents_; }
  /// Returns the index in the file list of the file that the active viewport shows or waits for.
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
