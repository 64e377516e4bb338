#pragma once

#include "app/interface/panels/panel.h"

#include <cstdint>
#include <string>

namespace gs::app {

/// Panel that edits the Gaussian splats of a file: crops, limits of opacity and size, transformation and exposure.
/// Requests changes in UiActions::splats.
class SplatsPanel final : public Panel {
 public:
  void draw(const PanelFrame& frame, const UiModel& model, UiActions& actions) override;

 private:
  bool crop_head(const char* label, SplatCrop& crop);
  bool crop_row(double speed, SplatCrop& crop);
  void crop_rows(const UiSplats& splats, SplatEdit& edit);
  void limit_rows(const UiSplats& splats, SplatEdit& edit);
  void transform_rows(const UiSplats& splats, SplatEdit& edit);
  void button_rows(const UiSplats& splats, SplatEdit& edit, UiActions& actions);
  void vector_row(const char* label, const char* id, double* values, double speed, const char* format,
                  const char* help);

  const PanelFrame* frame_ = nullptr;  // valid only while the panel is drawn
  std::uint64_t gesture_ = 1;          // changes while a control is held are undone together
};

}  // namespace gs::app
