#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace gs::app {

/// Keys that shortcuts can use. Letters and digits have their upper-case ASCII codes.
enum class Key : int {
  unknown = 0,
  space = 32,
  plus = '+',
  minus = '-',
  escape = 256,
  enter,
  tab,
  left,
  right,
  up,
  down,
  page_up,
  page_down,
  home,
  end,
  f1,
  f2,
  f3,
  f4,
  f5,
  f6,
  f11,
  f12,
  shift,
  control,
  alt,
};
[[nodiscard]] constexpr Key letter_key(char upper) { return static_cast<Key>(upper); }

enum class MouseButton : std::uint8_t { left, right, middle };

/// Device with analog axes: the sticks of a gamepad, or the cap of a 3D mouse.
enum class AxisDevice : std::uint8_t { gamepad, space_mouse };
inline constexpr std::size_t kAxisDevices = 2;

/// Event from the user or the window system. Pointer positions are in framebuffer pixels from the upper left.
struct WindowEvent {
  enum class Kind : std::uint8_t {
    key_down,
    key_up,
    button_down,
    button_up,
    pointer,
    pointer_left,  // the pointer left the window
    character,  // the keyboard typed a character
    wheel,
    drop,
    focus_lost,
    axes,
    refresh,
  };
  Kind kind = Kind::refresh;
  Key key = Key::unknown;
  int code = 0;  // key code of GLFW; for Kind::character, the code point
  MouseButton button = MouseButton::left;
  bool shift = false, control = false, alt = false;
  glm::vec2 pointer{0.0f};
  float wheel = 0;  // notches; positive means turned away from the user
  AxisDevice device = AxisDevice::gamepad;
  glm::vec3 move{0};  // for Kind::axes: right, up, forward in -1..1; until the next event of the device
  glm::vec2 turn{0};  // for Kind::axes: right, up in -1..1; until the next event of the device
  double time = 0;  // seconds since the window system was started
  std::vector<std::string> paths;  // paths of dropped files
};

}  // namespace gs::app
