#pragma once

#include "app/interface/base/ui_model.h"
#include "app/interface/base/ui_style.h"

#include <memory>

namespace gs::app {

/// Drawing context of a panel.
struct PanelFrame {
  float scale = 1;     // screen scale (1 is normal) times the user's text size
  Tooltips& tooltips;  // show() sets the tooltip of the previous item
};

/// Dock panel with its own tab. It keeps the user's choices between frames, but no world data, which come from the
/// model. Use on the window's thread.
class Panel {
 public:
  Panel() = default;
  Panel(const Panel&) = delete;
  Panel& operator=(const Panel&) = delete;
  virtual ~Panel() = default;

  /// Draws the contents at the cursor in the tab's scrolling window; begins no window itself. Adds the user's requests
  /// to `actions`.
  virtual void draw(const PanelFrame& frame, const UiModel& model, UiActions& actions) = 0;
  /// Closes a list or picker that is open in the panel (Esc). Returns false if there is none.
  virtual bool close_one() { return false; }
};

template <class OnePanel>
[[nodiscard]] std::unique_ptr<Panel> make_panel() {
  return std::make_unique<OnePanel>();
}

}  // namespace gs::app
