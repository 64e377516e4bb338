#pragma once

#include "app/window/window_event.h"

#include <glm/vec2.hpp>

#include <array>
#include <deque>
#include <optional>
#include <vector>

struct ImGuiIO;

namespace gs::app {

/// Passes user input to Dear ImGui, which sees only the state of keys and buttons at the start of a frame. Spreads
/// events of one slow frame over several frames, so that none is lost or reordered. Ctrl is still held when V arrives,
/// and a click counts at its own position.
class InterfaceInput {
 public:
  void add(const std::vector<WindowEvent>& events);
  /// Passes events on; call between the platform's NewFrame and Dear ImGui's. `text_waits` means that a text field is
  /// about to take the focus, so characters wait.
  void apply(ImGuiIO& io, bool text_waits);
  /// Reports whether another frame is needed for the pending events.
  [[nodiscard]] bool waiting() const { return !events_.empty(); }

 private:
  /// Changes in the present frame.
  struct Changes {
    std::vector<int> keys;
    std::array<bool, 3> buttons{};
    bool editing = false;    // key that text fields handle: arrows, Backspace, and Ctrl shortcuts
    bool modifier = false;   // Shift, Ctrl or Alt
    bool plain = false;      // any other key
    bool character = false;  // text
  };
  /// Processes an event. Returns false if it must wait for the next frame.
  bool take(const WindowEvent& event, ImGuiIO& io, Changes& changes, bool text_waits);
  bool take_key(const WindowEvent& event, ImGuiIO& io, Changes& changes, bool text_waits) const;

  std::deque<WindowEvent> events_;
  std::array<bool, 3> buttons_{};
  std::optional<glm::vec2> pointer_;  // framebuffer pixels; empty if it is outside the window
};

}  // namespace gs::app
