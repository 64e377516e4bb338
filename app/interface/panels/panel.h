#pragma once

#include "app/interface/base/ui_model.h"
#include "app/interface/base/ui_style.h"

#include <memory>

namespace gs::app {

/// What a panel needs of the interface around it.
struct PanelFrame {
  float scale = 1;     // 1 on a common screen, times the user's size of text
  Tooltips& tooltips;  // show() says more about the item before
};

/// What stands in the dock beside the picture, in a tab of its own: it remembers between frames what the user chose in
/// it, and nothing of the world, which the model has. The thread of the window.
class Panel {
 public:
  Panel() = default;
  Panel(const Panel&) = delete;
  Panel& operator=(const Panel&) = delete;
  virtual ~Panel() = default;

  /// Lays out its contents from the cursor on, in the window of its tab, which scrolls; it begins no window itself.
  /// What the user wants done goes into `actions`.
  virtual void draw(const PanelFrame& frame, const UiModel& model, UiActions& actions) = 0;
  /// Closes a list or picker that is open in it (Esc). False: there is none.
  virtual bool close_one() { return false; }
};

template <class OnePanel>
[[nodiscard]] std::unique_ptr<Panel> make_panel() {
  return std::make_unique<OnePanel>();
}

}  // namespace gs::app
