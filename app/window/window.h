#pragma once

#include "app/window/gamepad.h"
#include "app/window/space_mouse.h"
#include "app/window/window_event.h"
#include "base/noncopyable.h"
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

/// Desktop window with an OpenGL 3.3 core context. Use on the main thread only, except for wake().
class Window final : public render::GlContext, NonCopyable {
 public:
  /// Opens a window that has only a colour buffer. Pictures are rendered elsewhere and copied to it. `width` and
  /// `height` are in screen units.
  static std::variant<std::unique_ptr<Window>, render::ContextError> open(const std::string& title, int width,
                                                                          int height);
  ~Window() override;

  void make_current() override;
  void release_current() override;
  void present() override;
  [[nodiscard]] Procedure proc_address(const char* name) override;
  [[nodiscard]] std::string_view backend() const override { return "glfw"; }

  /// Processes pending events. wait() first blocks for up to `seconds` until there is an event.
  void poll();
  void wait(double seconds);
  /// Ends a wait(). Any thread, while the window exists.
  static void wake();
  /// Returns the events since the previous call, oldest first.
  [[nodiscard]] std::vector<WindowEvent> take_events();
  [[nodiscard]] bool has_events() const { return !events_.empty(); }
  /// Reports whether a gamepad or 3D mouse is connected. These devices cause no window events; poll() and wait() query
  /// them.
  [[nodiscard]] bool has_axes() const { return has_gamepad_ || space_mouse_.there(); }

  [[nodiscard]] bool should_close() const;
  void close();
  /// Withdraws a request to close the window.
  void keep_open();
  /// Hides the window at once. Releasing its contents may then take a while.
  void hide();
  /// Brings the window to the front, if the desktop permits it.
  void raise();
  void set_title(const std::string& title);
  void toggle_full_screen();
  /// Returns the size in framebuffer pixels; 0 if the window is minimised.
  [[nodiscard]] glm::ivec2 framebuffer_size() const;
  /// Returns the size in screen units, as in open(); 0 if the window is minimised.
  [[nodiscard]] glm::ivec2 window_size() const;
  /// Returns the position of the upper left corner in screen units. Returns nullopt if the window is minimised or if
  /// the window system does not report the position (Wayland).
  [[nodiscard]] std::optional<glm::ivec2> place() const;
  /// Moves the upper left corner to `place`, in screen units. Does nothing unless enough of the window would be on a
  /// monitor.
  void move_to(const glm::ivec2& place);
  [[nodiscard]] bool is_full_screen() const;
  /// Returns the scale of the monitor: 1 is normal, 2 means that content should be twice as large.
  [[nodiscard]] float content_scale() const;
  /// Returns the time of a monotonic clock in seconds.
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
  glm::vec2 pointer_{0};    // pointer position at the previous event; GLFW reports only the present position
  glm::ivec4 windowed_{0};  // position and size of the window outside of full-screen mode
};

}  // namespace gs::app
