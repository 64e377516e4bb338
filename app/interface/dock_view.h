#pragma once

#include "app/interface/panels/panels.h"

#include <array>
#include <memory>
#include <optional>
#include <vector>

namespace gs::app {

/// The panels of the table and the dock that they stand in: its areas with tabs, and the lines that are dragged between
/// them and the picture.
class DockView {
 public:
  DockView();

  [[nodiscard]] Dock& dock() { return dock_; }
  [[nodiscard]] const Dock& dock() const { return dock_; }
  /// For the frame that is made next; `whole`: what the bars leave.
  void lay_out(const DockRectangle& whole, float scale);
  [[nodiscard]] const DockLayout& layout() const { return layout_; }
  void build(const PanelFrame& frame, const UiModel& model, UiActions& actions);
  /// Closes what is open in a panel that shows. False: nothing is.
  bool close_one();

 private:
  void area(DockSide side, const PanelFrame& frame, const UiModel& model, UiActions& actions);
  void tabs(DockSide side, const PanelFrame& frame, const UiModel& model, UiActions& actions);
  void tab_menu(std::size_t panel);
  void divider(DockSide side, float scale);

  Dock dock_;
  DockLayout layout_;
  DockRectangle whole_;
  std::vector<std::unique_ptr<Panel>> panels_;                // by the table of panels
  std::array<std::optional<std::size_t>, kDockSides> shown_;  // whose tabs are in front on the screen
  std::array<float, kDockSides> grabbed_{};                   // from the pointer to the divider that it drags
};

}  // namespace gs::app
