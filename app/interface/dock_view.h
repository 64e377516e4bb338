#pragma once

#include "app/interface/panels/panels.h"

#include <array>
#include <memory>
#include <optional>
#include <vector>

namespace gs::app {

/// View of the dock: its areas with tabs of panels, and the draggable dividers.
class DockView {
 public:
  DockView();

  [[nodiscard]] Dock& dock() { return dock_; }
  [[nodiscard]] const Dock& dock() const { return dock_; }
  /// Computes the layout of the next frame. `whole` is the window without its bars.
  void lay_out(const DockRectangle& whole, float scale);
  [[nodiscard]] const DockLayout& layout() const { return layout_; }
  void build(const PanelFrame& frame, const UiModel& model, UiActions& actions);
  /// Closes an open list or dialog of a visible panel. Returns false if none is open.
  bool close_one();

 private:
  void area(DockSide side, const PanelFrame& frame, const UiModel& model, UiActions& actions);
  void tabs(DockSide side, const PanelFrame& frame, const UiModel& model, UiActions& actions);
  void tab_menu(std::size_t panel);
  void divider(DockSide side, float scale);

  Dock dock_;
  DockLayout layout_;
  DockRectangle whole_;
  std::vector<std::unique_ptr<Panel>> panels_;  // by index in the table of panels
  std::array<std::optional<std::size_t>, kDockSides> shown_;  // by DockSide: panel of the visible tab
  std::array<float, kDockSides> grabbed_{};  // by DockSide: offset from the pointer to the divider
};

}  // namespace gs::app
