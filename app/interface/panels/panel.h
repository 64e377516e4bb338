#pragma once

#include "app/interface/base/ui_style.h"
#include "app/interface/model/ui_model.h"
#include "base/noncopyable.h"

#include <memory>

namespace gs::app {

/// Data for drawing a panel.
struct PanelFrame {
  float scale = 1;     // screen scale (1 is normal) times the user's text size
  Tooltips& tooltips;  // show() sets the tooltip of the item drawn last
};

/// Panel of the dock, with its own tab. It may keep choices of the user between frames, but no data of the world: these
/// are in the model. Use only on the window's thread.
class Panel : NonCopyable {
 public:
  virtual ~Panel() = default;

  /// Draws the contents into the scrolling window of the tab, which the caller has begun. Adds the user's requests to
  /// `actions`.
  virtual void draw(const PanelFrame& frame, const UiModel& model, UiActions& actions) = 0;
  /// Closes a list or picker that is open in the panel, after Esc. Returns false if none is open.
  virtual bool close_one() { return false; }
};

template <class OnePanel>
[[nodiscard]] std::unique_ptr<Panel> make_panel() {
  return std::make_unique<OnePanel>();
}

}  // namespace gs::app
