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

/// The panel that chooses how clouds look: colours for all of them; transfer function, opacity, threshold and clipping
/// plane for volumes. Edits the CloudLook of the UiModel, and has nothing of it but what is under the pointer.
class CloudPanel final : public Panel {
 public:
  bool close_one() override;
  void draw(const PanelFrame& frame, const UiModel& model, UiActions& actions) override;

 private:
  using Range = std::pair<float, float>;
  void color_by_row(render::CloudLook& look);
  void volume_rows(const UiModel& model, render::CloudLook& look);
  void transfer_rows(const UiModel& model, render::CloudLook& look);
  void preset_row(Transfer& transfer, bool& own, const Range& values);
  /// These return true when they have changed the function.
  bool curve(Transfer& transfer, const Range& values);
  bool edit_curve(const TransferCanvas& canvas, Transfer& transfer);
  bool point_row(Transfer& transfer, const Range& values);
  bool color_button(std::array<float, 3>& color);
  bool point_fields(qnv::TransferPoint& point, const Range& values, float width);
  void clip_rows(const UiModel& model, render::CloudLook& look);
  void file_row(const UiModel& model, UiActions& actions);

  /// From 0 to 1, with its reading beside it. True when it was moved.
  bool slider(const char* id, float& place, const std::string& reading, const char* help);
  void log_slider(const char* id, float& value, const LogScale& scale, const std::string& reading, const char* help);
  /// To be called in every list and picker that is open.
  void keep_popup();
  /// Summarises volumes only when they are others than before.
  void summarize_volumes(const std::vector<std::shared_ptr<const qnv::Cloud>>& volumes);

  const PanelFrame* frame_ = nullptr;  // while it builds
  std::optional<std::size_t> point_;   // chosen, of the transfer function
  ImVec2 grabbed_{0, 0};               // from the pointer to the point that it drags
  bool dragging_ = false, popup_ = false, close_popup_ = false;
  ClipChoice clip_;  // for when it is switched on
  std::vector<std::weak_ptr<const qnv::Cloud>> summarized_;
  VolumeSummary summary_;
  std::string path_;  // of the transfer function's file
};

}  // namespace gs::app
