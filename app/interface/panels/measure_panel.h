#pragma once

#include "app/interface/panels/panel.h"

namespace gs::app {

/// Panel of the measuring tools: value under the pointer, ruler, slices and colour bar of a volume, file series.
class MeasurePanel final : public Panel {
 public:
  void draw(const PanelFrame& frame, const UiModel& model, UiActions& actions) override;

 private:
  static void ruler_rows(const PanelFrame& frame, const UiTools& tools, UiToolActions& actions);
  static void slice_rows(const PanelFrame& frame, const UiTools& tools, UiToolActions& actions);
  static void series_rows(const PanelFrame& frame, const UiTools& tools, UiToolActions& actions);
};

/// Panel that saves pictures: size, background, stereo, metadata, turntables.
class PicturePanel final : public Panel {
 public:
  void draw(const PanelFrame& frame, const UiModel& model, UiActions& actions) override;
};

}  // namespace gs::app
