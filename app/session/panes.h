#pragma once

#include "app/session/documents/documents.h"
#include "app/session/view.h"
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

/// A file that a viewport was to show, and why it does not: the first error, with its place in the file.
struct PaneFailure {
  std::string path, error;
};

/// One viewport of the window: which file it shows and how.
struct Pane {
  static constexpr double kLeastWeight = 0.25, kMostWeight = 4;

  std::string wanted;                 // path of the file chosen; empty: none
  std::string shown;                  // path of what is on the screen: `wanted`, or the one before until it is read
  std::map<std::string, View> views;  // by path: who comes back to a file finds it as he left it
  InputTracker input;
  render::FrameStatistics statistics;
  double weight = 1;                   // of its share of what the viewports divide: vectors, and what is read for them
  std::optional<std::uint64_t> rate;   // bits a second at most of what is read for it; 0: any; nothing: as for all
  std::optional<PaneFailure> failure;  // until it shows another file, or somebody has read it

  /// What is on the screen; null: nothing.
  [[nodiscard]] View* view();
  [[nodiscard]] const View* view() const;
};

/// The viewports and the files in them. Plain bookkeeping: it neither reads nor draws.
class Panes {
 public:
  /// The files that the program starts with: each in a viewport, in the smallest layout that has so many; what is
  /// left over is only listed. In a split of the user's, those without a file of their own show the first one.
  void start(std::span<const std::string> paths, const std::optional<SplitTree>& split = {});
  /// Adds files that were dropped or chosen, and shows the first in the active viewport, others in those that are
  /// visible and free. A path that is already in the list is read again. Empty paths are ignored.
  void open(std::span<const std::string> paths);
  /// Shows a file of the list in the active viewport.
  void select(std::size_t file);
  /// Has the file of the active viewport read again.
  void reload();
  /// Has this file read again once a viewport shows it.
  void reload(std::string_view path) { documents_.reload(path); }
  /// No longer reads the file that a viewport waits for; it goes back to what it showed. False: it waits for none.
  bool cancel(std::size_t pane);

  /// Viewports that come into sight and are free show the listed files that no other does, else what the active one
  /// shows, as it shows it.
  void set_layout(ViewportLayout layout);
  /// How the window is split from now on; the active viewport is one in sight.
  void set_split(SplitTree split);
  /// The same viewports, otherwise shaped.
  void set_shape(SplitTree split) { split_ = std::move(split); }
  [[nodiscard]] const SplitTree& split() const { return split_; }
  /// A new viewport, in half of the place of `pane`, is active: with a listed file that no other shows, else with what
  /// `pane` shows, as it shows it. False: there are as many as there can be.
  bool split_pane(std::size_t pane, SplitAxis axis);
  /// The viewport is gone, with all that it has shown. False: it is the only one.
  bool close(std::size_t pane);
  /// Shows a file in a viewport.
  void show_in(std::size_t pane, const std::string& path);
  /// Keys go to this one from now on. One that is out of sight comes into sight, if it has a file: alone, with its
  /// pair, or in the place of the one that was active.
  void activate(std::size_t pane);
  [[nodiscard]] std::size_t active() const { return active_; }
  /// The viewports in sight, in the order of their places.
  [[nodiscard]] std::vector<std::size_t> visible() const { return panes_in_sight(split_); }
  [[nodiscard]] Pane& at(std::size_t pane) { return panes_[pane]; }
  [[nodiscard]] const Pane& at(std::size_t pane) const { return panes_[pane]; }

  /// Begins to read what a viewport in sight waits for, the active one first. Nothing when none does.
  [[nodiscard]] std::optional<DocumentList::Reading> begin_loading();
  /// True when a viewport's file is being read, or waits for it.
  [[nodiscard]] bool loading(std::size_t pane) const {
    return documents_.awaited(panes_[pane].wanted) || documents_.arriving(panes_[pane].wanted);
  }
  /// A reading has become this. Views of an older state of the file are renewed.
  void deliver(std::uint64_t reading, std::shared_ptr<Document> document, const glm::vec2& viewport);
  /// So much of a reading has come; it shows already.
  void preview(std::uint64_t reading, std::shared_ptr<Document> document);
  /// A living world has got more nodes: who has not moved yet sees all of it.
  void grow(const Document& document);
  /// A reading came to nothing. The viewports that waited for it say so, and go back to what they showed, or on to a
  /// file that no other shows; their numbers. Empty when nobody waits any more.
  std::vector<std::size_t> fail(std::uint64_t reading, const std::string& error = {});
  /// A viewport that shows another file than before.
  struct Change {
    std::size_t pane = 0;
    bool first = false;  // it has not shown this file before
    bool found = true;   // false: no Viewpoint has the name that was asked for
  };
  /// A file that is there has nothing to be shown, because of this error: the viewports that want it say so.
  void note_failure(const std::string& path, const std::string& error);
  /// Shows what has been read in the viewports that wait for it, in the `places` of those in sight, to which first
  /// views are fitted as long as nobody has moved. `viewpoint`: the name of
  /// the Viewpoint where worlds are entered, or empty.
  std::vector<Change> settle(std::span<const Viewport> places, std::string_view viewpoint);
  /// Nobody waits for anything any more.
  void cancel_all() { documents_.cancel_all(); }

  /// How files are seen that are seen for the first time from now on.
  void set_style(const ViewStyle& style) { style_ = style; }
  [[nodiscard]] const ViewStyle& style() const { return style_; }
  /// Makes all others in sight look as this one does; see `link_view`.
  void link(std::size_t leader);
  /// Lets go of all keys and drags.
  void release_input();

  [[nodiscard]] const DocumentList& documents() const { return documents_; }
  /// Index in the list of files of what the active viewport shows or waits for.
  [[nodiscard]] std::optional<std::size_t> selected() const;

 private:
  void want(std::size_t pane, const std::string& path);
  void fill(std::size_t pane, std::size_t model);
  [[nodiscard]] std::optional<std::size_t> free_pane() const;
  [[nodiscard]] bool wanted_by_any(std::string_view path) const;
  void cancel_unwanted();

  std::array<Pane, kMostViewports> panes_;
  SplitTree split_;
  std::size_t active_ = 0;
  DocumentList documents_;
  ViewStyle style_;
};

}  // namespace gs::app
