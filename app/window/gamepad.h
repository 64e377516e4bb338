#pragma once

#include "app/window/window_event.h"

#include <array>
#include <cstdint>
#include <vector>

namespace gs::app {

/// How a gamepad is held, in the order of the gamepads that SDL and GLFW know.
struct GamepadState {
  bool connected = false;
  /// -1..1, y down: left stick x, y; right stick x, y; left and right trigger, -1 where they are not pressed.
  std::array<float, 6> axes{0, 0, 0, 0, -1, -1};
  /// A, B, X, Y, left and right bumper, back, start, guide, left and right stick, up, right, down, left.
  std::array<bool, 15> buttons{};
};

/// Turns what is asked of a gamepad into events: the left stick moves, the right one turns, the triggers lead down and
/// up, buttons are keys. Pure but for what it was told last.
class Gamepad {
 public:
  /// What has changed since the last call, at `time`.
  [[nodiscard]] std::vector<WindowEvent> take(const GamepadState& state, double time);

 private:
  glm::vec3 move_{0};
  glm::vec2 turn_{0};
  std::array<bool, 15> buttons_{};
};

/// What a button stands for, in the words of the help.
struct GamepadButtonRow {
  std::size_t button;  // of GamepadState
  Key key;
  const char* name;
};
[[nodiscard]] const std::vector<GamepadButtonRow>& gamepad_buttons();

}  // namespace gs::app
