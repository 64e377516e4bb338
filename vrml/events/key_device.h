#pragma once

#include "vrml/event_model/behaviour.h"

#include <cstdint>
#include <unordered_map>
#include <vector>

namespace gs::vrml {

/// Key that changes the meaning of other keys.
enum class ModifierKey : std::uint8_t { none, shift, control, alt };

/// Press or release of a key, or a typed character (X3D clause 21).
struct KeyStroke {
  enum class Kind : std::uint8_t { press, release, character };
  Kind kind = Kind::press;
  int key = 0;             // identifies the key; not for characters
  int action = 0;          // value of actionKeyPress: F1 to F12 are 1 to 12, then Home, End, Page Up, ...; 0 means none
  char32_t character = 0;  // code point; 0 if the key has none
  ModifierKey modifier = ModifierKey::none;
};

/// Keyboard of a world, for KeySensor and StringSensor. All enabled sensors receive all keys. Part of Execution.
class KeyDevice {
 public:
  explicit KeyDevice(Execution& execution) : execution_(execution) {}

  void add(EventNode node);
  void remove(EventNode node);
  /// Reports whether the world has an enabled sensor.
  [[nodiscard]] bool is_sensed() const;
  /// Sends a keystroke to all enabled sensors, as one cascade with a new timestamp.
  void send(const KeyStroke& stroke);
  /// Releases all pressed keys, because the window has lost the keyboard.
  void release_all();
  /// Reports whether a key is held.
  [[nodiscard]] bool is_any_held() const { return !held_.empty(); }

 private:
  void deliver(const KeyStroke& stroke);

  Execution& execution_;
  std::vector<EventNode> nodes_;
  std::unordered_map<int, KeyStroke> held_;  // held keys, with the characters that they typed
  int last_ = 0;                             // key that was pressed last
};

}  // namespace gs::vrml
