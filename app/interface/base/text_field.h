#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>

namespace gs::app {

/// Events of a text field in the current frame.
struct FieldEvents {
  bool active = false;  // the field has the keyboard focus
  bool changed = false;  // the text changed
  bool entered = false;  // Enter was pressed
  int moved = 0;  // rows to move in the list below the field: Up is -1, Down is 1
};

inline constexpr std::size_t kLongestTyped = 20'000;  // max length of the text of a field, in bytes

/// Optional handlers of keys that change a field's text.
struct FieldKeys {
  /// Returns the completed text for Tab. If null, Tab moves the focus to the next item.
  std::function<std::string(const std::string&)> complete{};
  /// Returns the new text for the Up key (true) or Down key (false); nullopt keeps the text. If null,
  /// FieldEvents::moved counts these keys.
  std::function<std::optional<std::string>(bool up, const std::string&)> recall{};
};

/// Draws a one-line text field that shows right-to-left text in visual order. `width` is in pixels: 0 uses the
/// available width; a negative width leaves that much free. `selects_all` selects the text when the field gets the
/// focus. Truncates text over kLongestTyped bytes.
FieldEvents text_field(const char* id, const char* hint, std::string& text, float width, bool selects_all,
                       const FieldKeys& keys = {});

}  // namespace gs::app
