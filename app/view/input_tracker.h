#pragma once

#include "app/view/navigation.h"
#include "app/view/viewports.h"
#include "app/window/window_event.h"

#include <glm/vec2.hpp>

#include <array>
#include <optional>
#include <set>

namespace gs::app {

/// Converter from window events to NavigationInput; tracks held keys and the current drag.
class InputTracker {
 public:
  /// Result of an event beyond navigation input.
  struct Gesture {
    bool needs_target = false;  // the caller must call `set_target` with the point under the pointer
    bool turns = false;         // a drag starts that turns about the point under the pointer
    bool double_click = false;
    bool click = false;  // the left button was released where it was pressed
  };

  /// Processes one event that the user interface did not consume.
  Gesture take(const WindowEvent& event, NavigationMode mode);
  void set_target(const glm::dvec3& target) { target_ = target; }
  /// Returns the input since the last call.
  [[nodiscard]] NavigationInput input(NavigationMode mode, const Viewport& viewport);
  /// Forgets all held keys and buttons, for example when the window loses focus.
  void release();

  /// Reports whether something is held, so that the view changes with time alone.
  [[nodiscard]] bool holding() const;
  /// Returns the press position of a drag that steers by distance, in framebuffer pixels, to mark it on screen.
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
  Drag drag_ = Drag::none;        // current drag
  Drag moved_drag_ = Drag::none;  // drag that produced `moved_`; it may have ended since
  MouseButton button_ = MouseButton::left;
  glm::vec2 pointer_{0}, press_{0}, moved_{0};
  float wheel_ = 0;
  std::optional<glm::dvec3> target_;
  double last_click_ = -1;
  glm::vec2 last_click_place_{0};
};

}  // namespace gs::app
