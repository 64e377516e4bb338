#pragma once

#include "app/view/navigation.h"
#include "app/view/viewports.h"
#include "app/window/window_event.h"

#include <glm/vec2.hpp>

#include <array>
#include <optional>
#include <set>

namespace gs::app {

/// Converter from window events to NavigationInput. It stores the held keys and the current drag.
class InputTracker {
 public:
  /// Effects of an event that the caller must handle.
  struct Gesture {
    bool needs_target = false;  // the caller must call set_target() with the world point under the pointer
    bool turns = false;  // a drag begins that rotates the view about the point under the pointer
    bool double_click = false;
    bool click = false;  // the left button was released near where it was pressed
  };

  /// Processes an event that the interface did not use.
  Gesture take(const WindowEvent& event, NavigationMode mode);
  void set_target(const glm::dvec3& target) { target_ = target; }
  /// Returns the input since the previous call.
  [[nodiscard]] NavigationInput input(NavigationMode mode, const Viewport& viewport);
  /// Forgets all held keys and buttons. Call when the window loses the focus.
  void release();

  /// Reports whether something is held that changes the view as time passes.
  [[nodiscard]] bool holding() const;
  /// Returns the start of a drag in which the distance from the start sets the speed, in framebuffer pixels; nullopt if
  /// there is no such drag. The interface marks the start.
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
  Drag drag_ = Drag::none;  // current drag; none while no button is held
  Drag moved_drag_ = Drag::none;  // drag that produced `moved_`; it may have ended already
  MouseButton button_ = MouseButton::left;
  glm::vec2 pointer_{0}, press_{0}, moved_{0};
  float wheel_ = 0;
  std::optional<glm::dvec3> target_;
  double last_click_ = -1;
  glm::vec2 last_click_place_{0};
};

}  // namespace gs::app
