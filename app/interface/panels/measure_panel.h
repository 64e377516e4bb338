#pragma once

#include "app/interface/panels/panel.h"

namespace gs::app {

/// Panel of the measuring tools: value under the pointer, ruler, slices, projections and isosurface of a volume, colour
/// bar, file series.
class MeasurePanel final : public Panel {
 public:
  void draw(const PanelFrame& frame, const UiModel& model, UiActions& actions) override;

 private:
  static void ruler_rows(const PanelFrame& frame, const UiTools& tools, UiToolActions& actions);
  static void slice_rows(const PanelFrame& frame, const UiTools& tools, UiToolActions& actions);
  static void window_buttons(const PanelFrame& frame, const UiTools& tools, VolumeSlices& slices);
  static void volume_rows(const PanelFrame& frame, const UiTools& tools, VolumeSlices& slices, UiToolActions& actions);
  static void step_rows(const PanelFrame& frame, const UiTools& tools, UiToolActions& actions);
  static void series_rows(const PanelFrame& frame, const UiTools& tools, UiToolActions& actions);
};

/// Panel that saves pictures: size, background, stereo, metadata, turntables.
class PicturePanel final : public Panel {
 public:
  void draw(const PanelFrame& frame, const UiModel& model, UiActions& actions) override;
};

}  // namespace gs::app
