#pragma once

#include "app/interface/panels/panel.h"
#include "app/view/values/transfer_editor.h"

#include <imgui.h>

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace gs::app {

struct TransferCanvas;

/// Panel of the splat style: colours, and for volumes the transfer function, opacity, threshold and clipping plane.
/// Edits the SplatStyle of the UiModel and keeps only the state of the interaction.
class TransferPanel final : public Panel {
 public:
  bool close_one() override;
  void draw(const PanelFrame& frame, const UiModel& model, UiActions& actions) override;

 private:
  using Range = std::pair<float, float>;
  void color_by_row(render::SplatStyle& look);
  void volume_rows(const UiModel& model, render::SplatStyle& look);
  void transfer_rows(const UiModel& model, render::SplatStyle& look);
  void preset_row(Transfer& transfer, bool& own, const Range& values);
  /// Draws the curve of the transfer function. Returns true if the user changed the function.
  bool curve(Transfer& transfer, const Range& values, const VolumeHistogram* histogram);
  bool edit_curve(const TransferCanvas& canvas, Transfer& transfer);
  bool point_row(Transfer& transfer, const Range& values);
  /// Draws buttons that stretch the transfer function. Returns true if the user changed it.
  bool range_buttons(Transfer& transfer, const Range& values, const VolumeHistogram* histogram);
  bool color_button(std::array<float, 3>& color);
  bool point_fields(qnv::TransferPoint& point, const Range& values, float width);
  void clip_rows(const UiModel& model, render::SplatStyle& look);
  void file_row(const UiModel& model, UiActions& actions);

  /// Draws a slider from 0 to 1 with its value beside it. Returns true if it was moved.
  bool slider(const char* id, float& place, const std::string& reading, const char* help);
  void log_slider(const char* id, float& value, const LogScale& scale, const std::string& reading, const char* help);
  /// Records that a list or colour picker is open. Call while drawing each one.
  void keep_popup();
  /// Computes the summary again if the volumes changed.
  void summarize_volumes(const std::vector<std::shared_ptr<const qnv::Volume>>& volumes);

  const PanelFrame* frame_ = nullptr;  // valid only while the panel is drawn
  std::optional<std::size_t> point_;   // selected point of the transfer function
  ImVec2 grabbed_{0, 0};               // offset from the pointer to the dragged point
  bool dragging_ = false, popup_ = false, close_popup_ = false;
  ClipChoice clip_;  // plane for the next time that clipping is switched on
  std::vector<std::weak_ptr<const qnv::Volume>> summarized_;
  VolumeSummary summary_;
  std::string path_;  // path of the transfer function file
};

}  // namespace gs::app
