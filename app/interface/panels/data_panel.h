#pragma once

#include "app/interface/panels/panel.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

namespace gs::app {

/// Panel of the datasets of a file: the shown dataset, its step, channel and component, the colours of surfaces, and
/// other data beside or over it. Requests changes in UiActions::data.
class DataPanel final : public Panel {
 public:
  bool close_one() override;
  void draw(const PanelFrame& frame, const UiModel& model, UiActions& actions) override;

 private:
  void tree(const UiData& data, UiDataActions& actions);
  void entry_row(const DatasetEntry& entry, const UiData& data, UiDataActions& actions);
  void step_rows(const UiData& data, VoxelComponent& choice, UiDataActions& actions);
  void component_rows(const UiData& data, VoxelComponent& choice);
  void color_rows(const UiData& data, VoxelComponent& choice);
  void live_rows(const UiData& data, UiDataActions& actions);
  void bar_row(const UiModel& model, UiToolActions& actions);
  void other_rows(const UiModel& model, UiDataActions& actions);
  void add_popup(const char* id, const UiModel& model, UiDataActions& actions, bool over);
  /// Records that a list is open. Call while drawing each one.
  void keep_popup();

  const PanelFrame* frame_ = nullptr;  // valid only while the panel is drawn
  bool all_ = false;                   // lists datasets that describe others, too
  std::string filter_;
  std::optional<int> step_;            // that the user drags
  std::array<double, 2> range_{0, 1};  // that the user types
  std::array<double, 2> range_of_{0, 1};
  std::string live_name_, live_token_;  // name of the dragged parameter; token that the user typed
  double live_value_ = 0;
  bool popup_ = false, close_popup_ = false;
};

}  // namespace gs::app
