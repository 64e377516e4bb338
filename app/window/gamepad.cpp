#include "app/window/gamepad.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace gs::app {
namespace {

constexpr float kStickAtRest = 0.15f;  // dead zone of a stick, 0..1, because worn sticks do not return to the centre

float number(float value) { return std::isfinite(value) ? std::clamp(value, -1.0f, 1.0f) : 0.0f; }

/// Converts the position of a stick. The dead zone is a circle, so that it does not change the direction. The result is
/// quadratic, for fine control near the centre.
glm::vec2 stick(float x, float y) {
  const glm::vec2 place(number(x), number(y));
  const float length = glm::length(place);
  if (length <= kStickAtRest) return glm::vec2(0);
  const float part = std::min((length - kStickAtRest) / (1 - kStickAtRest), 1.0f);
  return place / length * (part * part);
}

float trigger(float value) {
  const float pressed = (number(value) + 1) / 2;
  return pressed <= kStickAtRest ? 0.0f : (pressed - kStickAtRest) / (1 - kStickAtRest);
}

}  // namespace

const std::vector<GamepadButtonRow>& gamepad_buttons() {
  static const std::vector<GamepadButtonRow> kRows = {{4, Key::page_up, "left bumper"},
                                                      {5, Key::page_down, "right bumper"},
                                                      {3, letter_key('F'), "Y"},
                                                      {2, letter_key('H'), "X"},
                                                      {7, Key::home, "start"},
                                                      {10, letter_key('G'), "right stick"},
                                                      {9, Key::shift, "left stick pressed"}};
  return kRows;
}

std::vector<WindowEvent> Gamepad::take(const GamepadState& given, double time) {
  const GamepadState state = given.connected ? given : GamepadState{};
  std::vector<WindowEvent> events;
  WindowEvent event;
  event.time = time;
  const glm::vec2 left = stick(state.axes[0], state.axes[1]), right = stick(state.axes[2], state.axes[3]);
  event.move = {left.x, trigger(state.axes[5]) - trigger(state.axes[4]), -left.y};
  event.turn = {right.x, -right.y};
  if (event.move != move_ || event.turn != turn_) {
    event.kind = WindowEvent::Kind::axes;
    event.device = AxisDevice::gamepad;
    move_ = event.move;
    turn_ = event.turn;
    events.push_back(event);
  }
  event.move = glm::vec3(0);
  event.turn = glm::vec2(0);
  for (const GamepadButtonRow& row : gamepad_buttons()) {
    if (state.buttons[row.button] == buttons_[row.button]) continue;
    event.kind = state.buttons[row.button] ? WindowEvent::Kind::key_down : WindowEvent::Kind::key_up;
    event.key = row.key;
    events.push_back(event);
  }
  buttons_ = state.buttons;
  return events;
}

}  // namespace gs::app
