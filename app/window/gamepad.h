#pragma once

#include "app/window/window_event.h"

#include <array>
#include <cstdint>
#include <vector>

namespace gs::app {

/// State of a gamepad. Buttons and axes have the order of SDL and GLFW.
struct GamepadState {
  bool connected = false;
  /// In -1..1, y downwards: left stick x, y; right stick x, y; left and right trigger. A released trigger is -1.
  std::array<float, 6> axes{0, 0, 0, 0, -1, -1};
  /// A, B, X, Y, left and right bumper, back, start, guide, left and right stick, up, right, down, left.
  std::array<bool, 15> buttons{};
};

/// Converter from the state of a gamepad to events. The left stick moves, the right stick turns, the triggers move down
/// and up, and buttons act as keys. The events depend only on the present and previous state.
class Gamepad {
 public:
  /// Returns the events for the changes since the previous call. `time` is their time in seconds.
  [[nodiscard]] std::vector<WindowEvent> take(const GamepadState& state, double time);

 private:
  glm::vec3 move_{0};
  glm::vec2 turn_{0};
  std::array<bool, 15> buttons_{};
};

/// Row of the table of buttons. The help shows its texts.
struct GamepadButtonRow {
  std::size_t button;  // index in GamepadState::buttons
  Key key;
  const char* name;
};
[[nodiscard]] const std::vector<GamepadButtonRow>& gamepad_buttons();

}  // namespace gs::app
