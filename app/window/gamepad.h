#pragma once

#include "app/window/window_event.h"

#include <array>
#include <cstdint>
#include <vector>

namespace gs::app {

/// State of a gamepad, in the button and axis order of SDL and GLFW.
struct GamepadState {
  bool connected = false;
  /// -1..1, y down: left stick x, y; right stick x, y; left and right trigger, -1 if released.
  std::array<float, 6> axes{0, 0, 0, 0, -1, -1};
  /// A, B, X, Y, left and right bumper, back, start, guide, left and right stick, up, right, down, left.
  std::array<bool, 15> buttons{};
};

/// Converts gamepad state to events: the left stick moves, the right one turns, the triggers move down and up, buttons
/// are keys. Deterministic given the previous state.
class Gamepad {
 public:
  /// Returns the events since the last call, at `time`.
  [[nodiscard]] std::vector<WindowEvent> take(const GamepadState& state, double time);

 private:
  glm::vec3 move_{0};
  glm::vec2 turn_{0};
  std::array<bool, 15> buttons_{};
};

/// Row of the table of buttons, worded for the help.
struct GamepadButtonRow {
  std::size_t button;  // index into GamepadState::buttons
  Key key;
  const char* name;
};
[[nodiscard]] const std::vector<GamepadButtonRow>& gamepad_buttons();

}  // namespace gs::app
