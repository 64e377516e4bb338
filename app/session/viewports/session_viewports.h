#pragma once

#include "app/session/viewports/pane_loading.h"
#include "app/session/viewports/panes.h"
#include "app/session/viewports/step.h"
#include "app/view/panes/split_tree.h"

#include <glm/vec2.hpp>

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

namespace gs::app {

/// Viewports of a session: their rectangles in the window, the active one, and links between their cameras. One thread.
class SessionViewports {
 public:
  explicit SessionViewports(StepContext& step) : step_(step) {}

  [[nodiscard]] Panes& panes() { return panes_; }
  [[nodiscard]] const Panes& panes() const { return panes_; }
  /// Returns the results of readings, as the viewports show them.
  [[nodiscard]] PaneLoading& loading() { return loading_; }
  /// Returns the view of the active viewport, or null if it is empty.
  [[nodiscard]] View* view() { return panes_.at(panes_.active()).view(); }
  [[nodiscard]] const View* view() const { return panes_.at(panes_.active()).view(); }

  /// Sets the area of all viewports, in framebuffer pixels.
  void set_area(const Viewport& area) { area_ = area; }
  [[nodiscard]] const Viewport& area() const { return area_; }
  /// Returns the rectangles of the visible viewports, in the order of `Panes::visible`.
  [[nodiscard]] std::vector<Viewport> places() const { return arrange(panes_.split(), area_); }
  /// Returns the rectangle of a viewport, or the whole area if it is not visible.
  [[nodiscard]] Viewport place_of(std::size_t pane) const;
  [[nodiscard]] Viewport place_of(const View& view) const;
  /// Returns the dividers between the visible viewports.
  [[nodiscard]] std::vector<SplitDivider> dividers() const { return dividers_of(panes_.split(), area_); }
  /// Returns the viewport that handles a pointer event, as an index into `places`; see PointerRouter.
  [[nodiscard]] std::optional<std::size_t> route(const WindowEvent& event) { return router_.route(event, places()); }
  /// Ends all drags.
  void release_pointer() { router_.release(); }

  /// Activates a viewport, which then receives the keys.
  void activate(std::size_t pane);
  void choose_layout(ViewportLayout layout) { change_split(split_of(layout, panes_.active())); }
  /// Changes the split of the window.
  void change_split(SplitTree split);
  /// Moves a divider to a column or row of framebuffer pixels. Viewports keep at least `least` pixels. `ended` is true
  /// when the drag is over.
  void move_divider(const SplitDivider& divider, int place, int least, bool ended);
  /// Sets the style of files that are shown for the first time, and backdrop and axes of existing views.
  void set_style(const ViewStyle& style);

  /// Links the cameras of the viewports, so that they move together.
  void set_linked(bool linked);
  [[nodiscard]] bool linked() const { return linked_; }
  /// Returns the viewport that the user moved last. The others follow it while they are linked.
  [[nodiscard]] std::size_t leader() const { return leader_; }
  void lead(std::size_t pane) { leader_ = pane; }
  /// Makes the active viewport the one that the user moved last.
  void lead_active() { leader_ = panes_.active(); }

  /// Sets the functions to call before the rectangles change, and after a viewport has lost its file and history.
  void observe(std::function<void()> before_change, std::function<void(std::size_t pane)> forgotten);

  /// Announces that rectangles are about to change. `change_split` calls it.
  void announce_change() { before_change_(); }
  /// Removes the state of the former viewport with this number.
  void forget(std::size_t pane);

 private:
  StepContext& step_;
  Panes panes_;
  PaneLoading loading_{panes_};
  PointerRouter router_;
  Viewport area_;
  bool linked_ = false;
  std::size_t leader_ = 0;
  std::function<void()> before_change_ = [] {};
  std::function<void(std::size_t)> forgotten_ = [](std::size_t) {};
};

}  // namespace gs::app
