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

/// Viewports of a session: their rectangles in the window, which one is active, and links between their cameras. One
/// thread.
class SessionViewports {
 public:
  explicit SessionViewports(StepContext& step) : step_(step) {}

  [[nodiscard]] Panes& panes() { return panes_; }
  [[nodiscard]] const Panes& panes() const { return panes_; }
  /// Returns the connection between the viewports and the readings of their files.
  [[nodiscard]] PaneLoading& loading() { return loading_; }
  /// Returns the view of the active viewport; null if the viewport is empty.
  [[nodiscard]] View* view() { return panes_.at(panes_.active()).view(); }
  [[nodiscard]] const View* view() const { return panes_.at(panes_.active()).view(); }

  /// Sets the area that the viewports share, in framebuffer pixels.
  void set_area(const Viewport& area) { area_ = area; }
  [[nodiscard]] const Viewport& area() const { return area_; }
  /// Returns the rectangles of the visible viewports in framebuffer pixels, in the order of Panes::visible().
  [[nodiscard]] std::vector<Viewport> places() const { return arrange(panes_.split(), area_); }
  /// Returns the rectangle of a viewport in framebuffer pixels; the whole area if it is not visible.
  [[nodiscard]] Viewport place_of(std::size_t pane) const;
  [[nodiscard]] Viewport place_of(const View& view) const;
  /// Returns the dividers between the visible viewports.
  [[nodiscard]] std::vector<SplitDivider> dividers() const { return dividers_of(panes_.split(), area_); }
  /// Returns the viewport that must handle a pointer event, as an index into places(); see PointerRouter.
  [[nodiscard]] std::optional<std::size_t> route(const WindowEvent& event) { return router_.route(event, places()); }
  /// Ends all drags.
  void release_pointer() { router_.release(); }

  /// Activates a viewport, which then receives the keys.
  void activate(std::size_t pane);
  void choose_layout(ViewportLayout layout) { change_split(split_of(layout, panes_.active())); }
  /// Changes the arrangement of the viewports.
  void change_split(SplitTree split);
  /// Moves a divider to a column or row of framebuffer pixels. Each viewport keeps at least `least` pixels. `ended`
  /// means that the user has released the divider.
  void move_divider(const SplitDivider& divider, int place, int least, bool ended);
  /// Sets the initial style of views. Applies its backdrop and axes to existing views, too.
  void set_style(const ViewStyle& style);

  /// Sets whether the cameras of all viewports move together.
  void set_linked(bool linked);
  [[nodiscard]] bool linked() const { return linked_; }
  /// Returns the viewport that the user moved last. While the cameras are linked, the others follow it.
  [[nodiscard]] std::size_t leader() const { return leader_; }
  void lead(std::size_t pane) { leader_ = pane; }
  /// Records that the user moved the active viewport last; see leader().
  void lead_active() { leader_ = panes_.active(); }

  /// Sets two functions: one is called before the rectangles change, the other when a viewport has lost its file and
  /// history.
  void observe(std::function<void()> before_change, std::function<void(std::size_t pane)> forgotten);

  /// Calls the function that observe() set for changes of rectangles. change_split() does this itself.
  void announce_change() { before_change_(); }
  /// Removes the state of a viewport that was closed.
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
