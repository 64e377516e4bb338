#pragma once

#include "app/window/gamepad.h"
#include "app/window/space_mouse.h"
#include "app/window/window_event.h"
#include "render/gl/context.h"

#include <glm/vec2.hpp>
#include <glm/vec4.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

struct GLFWwindow;

namespace gs::app {

/// A window of the desktop with an OpenGL 3.3 core context. Main thread only, except `wake`.
class Window final : public render::GlContext {
 public:
  /// Opens it, with colours only: what is drawn elsewhere is shown in it.
  static std::variant<std::unique_ptr<Window>, render::ContextError> open(const std::string& title, int width,
                                                                          int height);
  ~Window() override;
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  void make_current() override;
  void release_current() override;
  void present() override;
  [[nodiscard]] Procedure proc_address(const char* name) override;
  [[nodiscard]] std::string_view backend() const override { return "glfw"; }

  /// Takes in what has happened, without or with waiting (at most `seconds`) for something to happen.
  void poll();
  void wait(double seconds);
  /// Ends a `wait`. Any thread, while the window exists.
  static void wake();
  /// The events since the last call, oldest first.
  [[nodiscard]] std::vector<WindowEvent> take_events();
  [[nodiscard]] bool has_events() const { return !events_.empty(); }
  /// Whether there is a gamepad or a 3D mouse, of which the window system does not tell: `poll` asks them.
  [[nodiscard]] bool has_axes() const { return has_gamepad_ || space_mouse_.there(); }

  [[nodiscard]] bool should_close() const;
  void close();
  /// Takes the window off the screen at once, while what it showed is still being put away.
  void hide();
  /// Before other windows, as far as the desktop lets it.
  void raise();
  void set_title(const std::string& title);
  void toggle_full_screen();
  /// Pixels of the framebuffer; 0 when minimised.
  [[nodiscard]] glm::ivec2 framebuffer_size() const;
  /// As `open` takes it; 0 when minimised.
  [[nodiscard]] glm::ivec2 window_size() const;
  /// Where its upper left corner is on the desktop, in screen coordinates; none: the window system does not tell
  /// (Wayland), or it is minimised.
  [[nodiscard]] std::optional<glm::ivec2> place() const;
  /// Moves it there, if enough of it would be on a monitor to take hold of it.
  void move_to(const glm::ivec2& place);
  [[nodiscard]] bool is_full_screen() const;
  /// Of the monitor: 1 on a common screen, 2 where everything should be twice as large.
  [[nodiscard]] float content_scale() const;
  /// Seconds, monotonic.
  [[nodiscard]] static double now();
  /// For the user interface's own backend.
  [[nodiscard]] GLFWwindow* handle() const { return window_; }

 private:
  struct Callbacks;
  explicit Window(GLFWwindow* window);
  void ask_devices();

  GLFWwindow* window_;
  Gamepad gamepad_;
  SpaceMouse space_mouse_;
  bool has_gamepad_ = false;
  std::vector<WindowEvent> events_;
  glm::vec2 pointer_{0};    // of the event before; what GLFW itself tells is where the pointer is by now
  glm::ivec4 windowed_{0};  // place and size to go back to from full screen
};

}  // namespace gs::app
