#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace gs::app {

/// The keys that GhostSpace knows. Letters and digits are their ASCII upper case.
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

/// What has axes, which are held at a place between none and full: sticks of a gamepad, the cap of a 3D mouse.
enum class AxisDevice : std::uint8_t { gamepad, space_mouse };
inline constexpr std::size_t kAxisDevices = 2;

/// What the user or the window system did. Pointer places are framebuffer pixels from the upper left.
struct WindowEvent {
  enum class Kind : std::uint8_t {
    key_down,
    key_up,
    button_down,
    button_up,
    pointer,
    pointer_left,  // the window
    character,     // of text, as keys make it
    wheel,
    drop,
    focus_lost,
    axes,
    refresh,
  };
  Kind kind = Kind::refresh;
  Key key = Key::unknown;
  int code = 0;  // of the key, as the window system's library numbers them; of the character, its code point
  MouseButton button = MouseButton::left;
  bool shift = false, control = false, alt = false;
  glm::vec2 pointer{0.0f};
  float wheel = 0;  // notches, away from the user is positive
  AxisDevice device = AxisDevice::gamepad;
  glm::vec3 move{0};               // of `axes`, -1..1 until the next ones of the device: right, up, forward
  glm::vec2 turn{0};               // likewise: right, up
  double time = 0;                 // seconds since the window system started
  std::vector<std::string> paths;  // dropped files
};

}  // namespace gs::app
