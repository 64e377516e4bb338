#pragma once

#include <functional>
#include <string>

namespace gs::app {

/// What the user has done in a text field in this frame.
struct FieldEvents {
  bool active = false;   // the keys go into it
  bool changed = false;  // its text is another than before
  bool entered = false;  // Enter
  int moved = 0;         // Up is -1, Down is 1: through the list that belongs to it
};

/// A field of one line, in which what is written from right to left is seen so. `complete`: the text that Tab makes of
/// what is in it; null: Tab goes on to the next item. `selects_all`: of what is in it when it gets the keys.
FieldEvents text_field(const char* id, const char* hint, std::string& text, float width, bool selects_all,
                       const std::function<std::string(const std::string&)>& complete = nullptr);

}  // namespace gs::app
