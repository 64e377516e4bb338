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

/// Desktop window with an OpenGL 3.3 core context. Use on the main thread only, except `wake`.
class Window final : public render::GlContext {
 public:
  /// Opens a window with a colour buffer only; pictures are rendered elsewhere and copied to it.
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

  /// Process pending events. `wait` blocks for up to `seconds` until an event occurs.
  void poll();
  void wait(double seconds);
  /// Ends a `wait`. Callable on any thread while the window exists.
  static void wake();
  /// Returns the events since the last call, oldest first.
  [[nodiscard]] std::vector<WindowEvent> take_events();
  [[nodiscard]] bool has_events() const { return !events_.empty(); }
  /// Reports whether a gamepad or 3D mouse is connected. The window system sends no events for them, so `poll` queries
  /// them.
  [[nodiscard]] bool has_axes() const { return has_gamepad_ || space_mouse_.there(); }

  [[nodiscard]] bool should_close() const;
  void close();
  /// Hides the window at once, while its contents are still being released.
  void hide();
  /// Raises the window above others, if the desktop permits.
  void raise();
  void set_title(const std::string& title);
  void toggle_full_screen();
  /// Size in pixels; 0 if minimised.
  [[nodiscard]] glm::ivec2 framebuffer_size() const;
  /// Size in the units of `open`; 0 if minimised.
  [[nodiscard]] glm::ivec2 window_size() const;
  /// Returns the position of the upper left corner in screen coordinates. Returns nullopt if the window is minimised or
  /// the window system does not report it (Wayland).
  [[nodiscard]] std::optional<glm::ivec2> place() const;
  /// Moves the window to `place`, if enough of it would be on a monitor to grab it.
  void move_to(const glm::ivec2& place);
  [[nodiscard]] bool is_full_screen() const;
  /// Scale of the monitor: 1 normally, 2 if content should be twice as large.
  [[nodiscard]] float content_scale() const;
  /// Seconds on a monotonic clock.
  [[nodiscard]] static double now();
  /// Returns the GLFW window, for the backend of the user interface.
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
  glm::vec2 pointer_{0};    // at the previous event; GLFW reports only the present position
  glm::ivec4 windowed_{0};  // position and size to restore after full screen
};

}  // namespace gs::app
