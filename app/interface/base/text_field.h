#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>

namespace gs::app {

/// Events of a text field in this frame.
struct FieldEvents {
  bool active = false;   // has the keyboard focus
  bool changed = false;  // text changed
  bool entered = false;  // Enter was pressed
  int moved = 0;         // selection moved in the associated list: Up is -1, Down is 1
};

inline constexpr std::size_t kLongestTyped = 20'000;  // max length of a text field in bytes

/// Key handlers that change a field's text.
struct FieldKeys {
  /// Returns the completion for Tab. If null, Tab moves to the next item.
  std::function<std::string(const std::string&)> complete{};
  /// Returns the text for Up (true) or Down; nullopt keeps the text. If null, FieldEvents::moved counts the keys.
  std::function<std::optional<std::string>(bool up, const std::string&)> recall{};
};

/// Draws a one-line text field that shows right-to-left text correctly. `width` is in pixels: 0 uses the available
/// width; a negative width leaves that much free. `selects_all` selects the text on focus. Truncates text over
/// kLongestTyped bytes.
FieldEvents text_field(const char* id, const char* hint, std::string& text, float width, bool selects_all,
                       const FieldKeys& keys = {});

}  // namespace gs::app
