#pragma once

#include "render/gl/context.h"

#include <glm/vec2.hpp>
#include <glm/vec4.hpp>

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

struct GLFWwindow;

namespace gs::app {

/// The keys that GhostSpace knows. Letters and digits are their ASCII upper case.
enum class Key : int {
  unknown = 0,
  space = 32,
  plus = '+',
  minus = '-',
  escape = 256,
  enter,
  tab,
  left,
  right,
  up,
  down,
  page_up,
  page_down,
  home,
  end,
  f1,
  f2,
  f3,
  f4,
  f5,
  f6,
  f11,
  shift,
  control,
  alt,
};
[[nodiscard]] constexpr Key letter_key(char upper) { return static_cast<Key>(upper); }

enum class MouseButton : std::uint8_t { left, right, middle };

/// What the user or the window system did. Pointer places are framebuffer pixels from the upper left.
struct WindowEvent {
  enum class Kind : std::uint8_t {
    key_down,
    key_up,
    button_down,
    button_up,
    pointer,
    wheel,
    drop,
    focus_lost,
    refresh,
  };
  Kind kind = Kind::refresh;
  Key key = Key::unknown;
  int code = 0;  // of the key, as the window system's library numbers them
  MouseButton button = MouseButton::left;
  bool shift = false, control = false, alt = false;
  glm::vec2 pointer{0.0f};
  float wheel = 0;                 // notches, away from the user is positive
  double time = 0;                 // seconds since the window system started
  std::vector<std::string> paths;  // dropped files
};

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

  [[nodiscard]] bool should_close() const;
  void close();
  /// Takes the window off the screen at once, while what it showed is still being put away.
  void hide();
  void set_title(const std::string& title);
  void toggle_full_screen();
  /// Pixels of the framebuffer; 0 when minimised.
  [[nodiscard]] glm::ivec2 framebuffer_size() const;
  /// Of the monitor: 1 on a common screen, 2 where everything should be twice as large.
  [[nodiscard]] float content_scale() const;
  /// Seconds, monotonic.
  [[nodiscard]] static double now();
  /// For the user interface's own backend.
  [[nodiscard]] GLFWwindow* handle() const { return window_; }

 private:
  struct Callbacks;
  explicit Window(GLFWwindow* window);

  GLFWwindow* window_;
  std::vector<WindowEvent> events_;
  glm::vec2 pointer_{0};    // of the event before; what GLFW itself tells is where the pointer is by now
  glm::ivec4 windowed_{0};  // place and size to go back to from full screen
};

}  // namespace gs::app
