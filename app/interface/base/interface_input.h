#pragma once

#include "app/window/window_event.h"

#include <glm/vec2.hpp>

#include <array>
#include <deque>
#include <optional>
#include <vector>

struct ImGuiIO;

namespace gs::app {

/// Hands what the user does to Dear ImGui, which sees only how keys and buttons are when a frame begins. What went down
/// and up again in one slow frame is spread over as many frames as it takes, so that nothing is lost and nothing comes
/// in another order: Ctrl is still held when V is seen, and a click counts where it was made.
class InterfaceInput {
 public:
  void add(const std::vector<WindowEvent>& events);
  /// Between the platform's NewFrame and that of Dear ImGui. `text_waits`: a text field is about to take the keys, and
  /// characters wait for it.
  void apply(ImGuiIO& io, bool text_waits);
  /// Whether another frame is needed for what has come.
  [[nodiscard]] bool waiting() const { return !events_.empty(); }

 private:
  /// What has changed in the frame that is being made.
  struct Changes {
    std::vector<int> keys;
    std::array<bool, 3> buttons{};
    bool editing = false;    // a key that a text field takes by itself: arrows, Backspace, and all with Ctrl
    bool modifier = false;   // Shift, Ctrl or Alt
    bool plain = false;      // any other key
    bool character = false;  // text
  };
  /// False: it belongs to the next frame.
  bool take(const WindowEvent& event, ImGuiIO& io, Changes& changes, bool text_waits);
  bool take_key(const WindowEvent& event, ImGuiIO& io, Changes& changes, bool text_waits) const;

  std::deque<WindowEvent> events_;
  std::array<bool, 3> buttons_{};
  std::optional<glm::vec2> pointer_;  // framebuffer pixels; nothing: it is not over the window
};

}  // namespace gs::app
