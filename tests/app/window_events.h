#pragma once

#include "app/window/window.h"

namespace gs::app {

using EventKind = WindowEvent::Kind;

/// Returns an event. `pointer` is in pixels, `time` in seconds.
inline WindowEvent event(EventKind kind, glm::vec2 pointer = {}, MouseButton button = MouseButton::left,
                         double time = 0) {
  WindowEvent result;
  result.kind = kind;
  result.pointer = pointer;
  result.button = button;
  result.time = time;
  return result;
}

}  // namespace gs::app
