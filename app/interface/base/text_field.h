#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>

namespace gs::app {

/// What the user has done in a text field in this frame.
struct FieldEvents {
  bool active = false;   // the keys go into it
  bool changed = false;  // its text is another than before
  bool entered = false;  // Enter
  int moved = 0;         // Up is -1, Down is 1: through the list that belongs to it
};

inline constexpr std::size_t kLongestTyped = 20'000;  // bytes of a text field

/// What keys make of the text in a field.
struct FieldKeys {
  /// Of Tab; null: Tab goes on to the next item.
  std::function<std::string(const std::string&)> complete{};
  /// Of Up (true) and Down; nothing: it stays. Null: they are counted in FieldEvents::moved.
  std::function<std::optional<std::string>(bool up, const std::string&)> recall{};
};

/// A field of one line, in which what is written from right to left is seen so. `width`: pixels; 0: the room that there
/// is, negative: but for so many. `selects_all`: of what is in it when it gets the keys. A text of more than
/// kLongestTyped bytes is cut.
FieldEvents text_field(const char* id, const char* hint, std::string& text, float width, bool selects_all,
                       const FieldKeys& keys = {});

}  // namespace gs::app
