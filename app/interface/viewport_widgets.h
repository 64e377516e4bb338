#pragma once

#include "app/interface/base/ui_style.h"
#include "app/interface/base/viewport_area.h"
#include "app/interface/model/ui_model.h"

#include <cstddef>
#include <string>

namespace gs::app {

/// Widgets over the pictures of the viewports: bars, dividers, progress, errors, axes and marks. An object is valid for
/// one frame.
class ViewportWidgets {
 public:
  /// `scale` is the number of pixels per unit of the design; `now` is the time of the frame in seconds.
  ViewportWidgets(float scale, double now, Tooltips& tooltips) : scale_(scale), now_(now), tooltips_(tooltips) {}

  /// Draws the borders of the viewports, and marks the active one.
  void viewport_marks(const UiModel& model) const;
  void loading_line(const UiViewport& viewport, std::size_t index, UiActions& actions);
  /// Draws the texts of the start page in an empty viewport. A click on a thumbnail opens its file.
  void welcome(const UiViewport& viewport, std::size_t index, const UiModel& model, UiActions& actions);
  void first_steps(const UiViewport& viewport, const UiModel& model, UiActions& actions);
  void divider_handles(const UiModel& model, UiActions& actions);
  void pane_bar(const UiViewport& viewport, const UiModel& model, UiActions& actions);
  /// Draws a card with the error of a viewport. If `log_open`, omits the button that opens the log.
  void failure_card(const UiViewport& viewport, const UiModel& model, bool log_open, UiActions& actions);
  /// Draws a card over a world with programs that have ended because one of them hung or crashed.
  void stopped_card(const UiViewport& viewport, bool log_open, UiActions& actions);
  void travel_mark(const UiModel& model);
  void tool_marks(const UiModel& model) const;
  void axes_widget(const UiViewport& viewport, const UiModel& model, UiActions& actions);

 private:
  void recent_card(const ViewportArea& area, const std::string& id, const std::string& place, UiActions& actions);
  void pane_menu(const UiViewport& viewport, const UiModel& model, UiActions& actions);
  void pane_shares(const UiViewport& viewport, UiActions& actions);
  void grid_line(const UiViewport& viewport, const std::string& grid);

  float scale_;
  double now_;
  Tooltips& tooltips_;
};

}  // namespace gs::app
