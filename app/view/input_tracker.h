#pragma once

#include "app/view/navigation.h"
#include "app/view/viewports.h"
#include "app/window/window_event.h"

#include <glm/vec2.hpp>

#include <array>
#include <optional>
#include <set>

namespace gs::app {

/// Turns window events into NavigationInput: remembers which keys are held and which drag goes on.
class InputTracker {
 public:
  /// What an event asks of the viewer besides.
  struct Gesture {
    bool needs_target = false;  // call `set_target` with what lies under the pointer
    bool turns = false;         // a drag begins that turns about what lies under the pointer
    bool double_click = false;
    bool click = false;  // the left button went up where it went down
  };

  /// Takes in one event that the user interface did not want.
  Gesture take(const WindowEvent& event, NavigationMode mode);
  void set_target(const glm::dvec3& target) { target_ = target; }
  /// What happened since the last call.
  [[nodiscard]] NavigationInput input(NavigationMode mode, const Viewport& viewport);
  /// Forgets all that is held, as when another window takes the keys.
  void release();

  /// True while something is held, so that time alone changes the view.
  [[nodiscard]] bool holding() const;
  /// Where a drag that steers by distance went down, for a mark on the screen. Framebuffer pixels.
  [[nodiscard]] std::optional<glm::vec2> travel_anchor() const;
  [[nodiscard]] const glm::vec2& pointer() const { return pointer_; }

 private:
  [[nodiscard]] bool down(Key key) const { return keys_.count(key) != 0; }
  [[nodiscard]] float axis(Key negative, Key positive) const;

  struct Axes {
    glm::vec3 move{0};
    glm::vec2 turn{0};
  };

  std::set<Key> keys_;
  std::array<Axes, kAxisDevices> axes_{};
  Drag drag_ = Drag::none;        // that goes on
  Drag moved_drag_ = Drag::none;  // that `moved_` belongs to; it may have ended since
  MouseButton button_ = MouseButton::left;
  glm::vec2 pointer_{0}, press_{0}, moved_{0};
  float wheel_ = 0;
  std::optional<glm::dvec3> target_;
  double last_click_ = -1;
  glm::vec2 last_click_place_{0};
};

}  // namespace gs::app
