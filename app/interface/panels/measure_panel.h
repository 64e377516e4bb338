#pragma once

#include "app/interface/panels/panel.h"

namespace gs::app {

/// The value under the pointer, the ruler, a volume's slices and its colour bar, and series of files.
class MeasurePanel final : public Panel {
 public:
  void draw(const PanelFrame& frame, const UiModel& model, UiActions& actions) override;

 private:
  static void ruler_rows(const PanelFrame& frame, const UiTools& tools, UiToolActions& actions);
  static void slice_rows(const PanelFrame& frame, const UiTools& tools, UiToolActions& actions);
  static void series_rows(const PanelFrame& frame, const UiTools& tools, UiToolActions& actions);
};

/// How pictures are saved: their size, background, eyes and what is written of them; turntables.
class PicturePanel final : public Panel {
 public:
  void draw(const PanelFrame& frame, const UiModel& model, UiActions& actions) override;
};

}  // namespace gs::app
