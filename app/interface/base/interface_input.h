#pragma once

#include "app/window/window_event.h"

#include <glm/vec2.hpp>

#include <array>
#include <deque>
#include <optional>
#include <vector>

struct ImGuiIO;

namespace gs::app {

/// Queue that passes user input to Dear ImGui. Dear ImGui reads the state of keys and buttons only at the start of a
/// frame. Therefore the queue spreads the events of one slow frame over several frames, so that no event is lost or
/// reordered. For example, Ctrl is still held when V is processed, and a click keeps its own position.
class InterfaceInput {
 public:
  void add(const std::vector<WindowEvent>& events);
  /// Passes pending events to Dear ImGui. Call between the platform's NewFrame and Dear ImGui's. If `text_waits`, a
  /// text field is about to take the focus, and characters stay pending.
  void apply(ImGuiIO& io, bool text_waits);
  /// Reports whether events are pending, so that another frame is needed.
  [[nodiscard]] bool waiting() const { return !events_.empty(); }

 private:
  /// Kinds of events already passed to Dear ImGui in this frame.
  struct Changes {
    std::vector<int> keys;
    std::array<bool, 3> buttons{};
    bool editing = false;  // a key that text fields handle: arrow, Backspace or Ctrl shortcut
    bool modifier = false;   // Shift, Ctrl or Alt
    bool plain = false;      // any other key
    bool character = false;  // typed text
  };
  /// Processes an event. Returns false if it must wait for the next frame.
  bool take(const WindowEvent& event, ImGuiIO& io, Changes& changes, bool text_waits);
  bool take_key(const WindowEvent& event, ImGuiIO& io, Changes& changes, bool text_waits) const;

  std::deque<WindowEvent> events_;
  std::array<bool, 3> buttons_{};
  std::optional<glm::vec2> pointer_;  // framebuffer pixels; empty if the pointer is outside the window
};

}  // namespace gs::app
