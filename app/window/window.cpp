#include "app/window/window.h"

#include <GLFW/glfw3.h>

#include <algorithm>
#include <utility>

namespace gs::app {
namespace {

std::string last_error;  // message of the last GLFW error; main thread only

void on_error(int, const char* description) { last_error = description ? description : ""; }

struct KeyRow {
  int glfw;
  Key key;
};
constexpr KeyRow kKeys[] = {
    {GLFW_KEY_ESCAPE, Key::escape},
    {GLFW_KEY_ENTER, Key::enter},
    {GLFW_KEY_KP_ENTER, Key::enter},
    {GLFW_KEY_TAB, Key::tab},
    {GLFW_KEY_LEFT, Key::left},
    {GLFW_KEY_RIGHT, Key::right},
    {GLFW_KEY_UP, Key::up},
    {GLFW_KEY_DOWN, Key::down},
    {GLFW_KEY_PAGE_UP, Key::page_up},
    {GLFW_KEY_PAGE_DOWN, Key::page_down},
    {GLFW_KEY_HOME, Key::home},
    {GLFW_KEY_END, Key::end},
    {GLFW_KEY_F1, Key::f1},
    {GLFW_KEY_F2, Key::f2},
    {GLFW_KEY_F3, Key::f3},
    {GLFW_KEY_F4, Key::f4},
    {GLFW_KEY_F5, Key::f5},
    {GLFW_KEY_F6, Key::f6},
    {GLFW_KEY_F11, Key::f11},
    {GLFW_KEY_F12, Key::f12},
    {GLFW_KEY_LEFT_SHIFT, Key::shift},
    {GLFW_KEY_RIGHT_SHIFT, Key::shift},
    {GLFW_KEY_LEFT_CONTROL, Key::control},
    {GLFW_KEY_RIGHT_CONTROL, Key::control},
    {GLFW_KEY_LEFT_ALT, Key::alt},
    {GLFW_KEY_RIGHT_ALT, Key::alt},
    {GLFW_KEY_SPACE, Key::space},
    {GLFW_KEY_EQUAL, Key::plus},
    {GLFW_KEY_KP_ADD, Key::plus},
    {GLFW_KEY_MINUS, Key::minus},
    {GLFW_KEY_KP_SUBTRACT, Key::minus},
    {GLFW_KEY_COMMA, letter_key(',')},
    {GLFW_KEY_PERIOD, letter_key('.')},
};

Key key_of(int glfw, int scancode) {
  for (const KeyRow& row : kKeys)
    if (row.glfw == glfw) return row.key;
  if (glfw >= GLFW_KEY_KP_0 && glfw <= GLFW_KEY_KP_9) return static_cast<Key>('0' + (glfw - GLFW_KEY_KP_0));
  if (glfw >= '0' && glfw <= '9') return static_cast<Key>(glfw);
  if (glfw < 'A' || glfw > 'Z') return Key::unknown;
  // Use the letter printed on the key instead of its position on a US keyboard, because shortcuts are letters.
  const char* name = glfwGetKeyName(glfw, scancode);
  if (name && name[0] >= 'a' && name[0] <= 'z' && name[1] == 0) return static_cast<Key>(name[0] - 'a' + 'A');
  return static_cast<Key>(glfw);
}

glm::vec2 pixels_per_unit(GLFWwindow* window) {
  int width = 0, height = 0, framebuffer_width = 0, framebuffer_height = 0;
  glfwGetWindowSize(window, &width, &height);
  glfwGetFramebufferSize(window, &framebuffer_width, &framebuffer_height);
  if (width <= 0 || height <= 0) return glm::vec2(1.0f);
  return {static_cast<float>(framebuffer_width) / static_cast<float>(width),
          static_cast<float>(framebuffer_height) / static_cast<float>(height)};
}

GLFWwindow* create(const std::string& title, int width, int height) {
  glfwDefaultWindowHints();
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
#ifdef __APPLE__
  glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);  // required there; elsewhere it would forbid wide lines
#endif
  // The window needs no depth or stencil buffer, because pictures are rendered off screen.
  glfwWindowHint(GLFW_DEPTH_BITS, 0);
  glfwWindowHint(GLFW_STENCIL_BITS, 0);
  glfwWindowHint(GLFW_SCALE_TO_MONITOR, GLFW_TRUE);
  for (const render::GlVersion& version : render::kContextVersions) {
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, version.major);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, version.minor);
    if (GLFWwindow* const window = glfwCreateWindow(width, height, title.c_str(), nullptr, nullptr)) return window;
  }
  return nullptr;
}

}  // namespace

/// GLFW callbacks that convert input to WindowEvents.
struct Window::Callbacks {
  static Window& self(GLFWwindow* window) { return *static_cast<Window*>(glfwGetWindowUserPointer(window)); }

  static WindowEvent event(GLFWwindow* window, WindowEvent::Kind kind) {
    WindowEvent result;
    result.kind = kind;
    result.time = glfwGetTime();
    result.pointer = self(window).pointer_;
    return result;
  }
  static WindowEvent event(GLFWwindow* window, WindowEvent::Kind kind, int modifiers) {
    WindowEvent result = event(window, kind);
    result.shift = (modifiers & GLFW_MOD_SHIFT) != 0;
    result.control = (modifiers & GLFW_MOD_CONTROL) != 0;
    result.alt = (modifiers & GLFW_MOD_ALT) != 0;
    return result;
  }
  static void key(GLFWwindow* window, int key, int scancode, int action, int modifiers) {
    if (action == GLFW_REPEAT) return;
    WindowEvent e =
        event(window, action == GLFW_PRESS ? WindowEvent::Kind::key_down : WindowEvent::Kind::key_up, modifiers);
    e.key = key_of(key, scancode);
    e.code = key;
    self(window).events_.push_back(std::move(e));
  }
  static void button(GLFWwindow* window, int button, int action, int modifiers) {
    if (button > GLFW_MOUSE_BUTTON_MIDDLE) return;
    WindowEvent e =
        event(window, action == GLFW_PRESS ? WindowEvent::Kind::button_down : WindowEvent::Kind::button_up, modifiers);
    e.button = button == GLFW_MOUSE_BUTTON_LEFT    ? MouseButton::left
               : button == GLFW_MOUSE_BUTTON_RIGHT ? MouseButton::right
                                                   : MouseButton::middle;
    self(window).events_.push_back(std::move(e));
  }
  static void pointer(GLFWwindow* window, double x, double y) {
    self(window).pointer_ = glm::vec2(x, y) * pixels_per_unit(window);
    self(window).events_.push_back(event(window, WindowEvent::Kind::pointer));
  }
  static void wheel(GLFWwindow* window, double, double y) {
    WindowEvent e = event(window, WindowEvent::Kind::wheel);
    e.wheel = static_cast<float>(y);
    self(window).events_.push_back(std::move(e));
  }
  static void drop(GLFWwindow* window, int count, const char** paths) {
    WindowEvent e = event(window, WindowEvent::Kind::drop);
    double x = 0, y = 0;  // query the position, because GLFW reports no pointer movement during a drag and drop
    glfwGetCursorPos(window, &x, &y);
    e.pointer = glm::vec2(x, y) * pixels_per_unit(window);
    e.paths.assign(paths, paths + std::max(count, 0));
    self(window).events_.push_back(std::move(e));
  }
  static void focus(GLFWwindow* window, int focused) {
    self(window).events_.push_back(event(window, focused ? WindowEvent::Kind::refresh : WindowEvent::Kind::focus_lost));
  }
  static void refresh(GLFWwindow* window) { self(window).events_.push_back(event(window, WindowEvent::Kind::refresh)); }
  static void character(GLFWwindow* window, unsigned code_point) {
    WindowEvent e = event(window, WindowEvent::Kind::character);
    e.code = static_cast<int>(code_point);
    self(window).events_.push_back(std::move(e));
  }
  static void entered(GLFWwindow* window, int entered) {
    self(window).events_.push_back(
        event(window, entered ? WindowEvent::Kind::pointer : WindowEvent::Kind::pointer_left));
  }
  static void resized(GLFWwindow* window, int, int) { refresh(window); }
  static void rescaled(GLFWwindow* window, float, float) { refresh(window); }
  static void closing(GLFWwindow* window) { refresh(window); }
};

std::variant<std::unique_ptr<Window>, render::ContextError> Window::open(const std::string& title, int width,
                                                                         int height) {
  last_error.clear();
  glfwSetErrorCallback(on_error);
  if (!glfwInit()) return render::ContextError{"cannot start the window system: " + last_error};
  width = std::clamp(width, 64, 16384);
  height = std::clamp(height, 64, 16384);
  GLFWwindow* handle = create(title, width, height);
  if (!handle) {
    const std::string message = "cannot open a window with OpenGL 3.3: " + last_error;
    glfwTerminate();
    return render::ContextError{message};
  }
  return std::unique_ptr<Window>(new Window(handle));
}

Window::Window(GLFWwindow* window) : window_(window) {
  glfwSetWindowUserPointer(window_, this);
  glfwSetKeyCallback(window_, Callbacks::key);
  glfwSetCharCallback(window_, Callbacks::character);
  glfwSetMouseButtonCallback(window_, Callbacks::button);
  glfwSetCursorPosCallback(window_, Callbacks::pointer);
  glfwSetCursorEnterCallback(window_, Callbacks::entered);
  glfwSetScrollCallback(window_, Callbacks::wheel);
  glfwSetDropCallback(window_, Callbacks::drop);
  glfwSetWindowFocusCallback(window_, Callbacks::focus);
  glfwSetWindowRefreshCallback(window_, Callbacks::refresh);
  glfwSetFramebufferSizeCallback(window_, Callbacks::resized);
  glfwSetWindowContentScaleCallback(window_, Callbacks::rescaled);
  glfwSetWindowCloseCallback(window_, Callbacks::closing);
  glfwSetWindowSizeLimits(window_, 320, 240, GLFW_DONT_CARE, GLFW_DONT_CARE);
  double x = 0, y = 0;
  glfwGetCursorPos(window_, &x, &y);
  pointer_ = glm::vec2(x, y) * pixels_per_unit(window_);
  glfwMakeContextCurrent(window_);
  glfwSwapInterval(1);
}

Window::~Window() {
  glfwDestroyWindow(window_);
  glfwTerminate();
}

void Window::release_current() { glfwMakeContextCurrent(nullptr); }
void Window::make_current() { glfwMakeContextCurrent(window_); }
void Window::present() { glfwSwapBuffers(window_); }
Window::Procedure Window::proc_address(const char* name) { return glfwGetProcAddress(name); }

void Window::poll() {
  glfwPollEvents();
  ask_devices();
}

void Window::wait(double seconds) {
  if (seconds <= 0) return poll();
  constexpr double kBetweenAxes = 1.0 / 60;
  glfwWaitEventsTimeout(has_axes() ? std::min(seconds, kBetweenAxes) : seconds);
  ask_devices();
}

// Reads the state of the first gamepad with a known mapping of its buttons, and of the 3D mouse.
void Window::ask_devices() {
  GamepadState state;
  for (int i = GLFW_JOYSTICK_1; i <= GLFW_JOYSTICK_LAST && !state.connected; ++i) {
    GLFWgamepadstate held;
    if (!glfwJoystickIsGamepad(i) || !glfwGetGamepadState(i, &held)) continue;
    state.connected = true;
    std::copy(std::begin(held.axes), std::end(held.axes), state.axes.begin());
    std::transform(std::begin(held.buttons), std::end(held.buttons), state.buttons.begin(),
                   [](unsigned char button) { return button == GLFW_PRESS; });
  }
  has_gamepad_ = state.connected;
  const double time = glfwGetTime();
  for (WindowEvent& event : gamepad_.take(state, time)) events_.push_back(std::move(event));
  for (WindowEvent& event : space_mouse_.take(time)) events_.push_back(std::move(event));
}

void Window::wake() { glfwPostEmptyEvent(); }
std::vector<WindowEvent> Window::take_events() { return std::exchange(events_, {}); }

bool Window::should_close() const { return glfwWindowShouldClose(window_) != 0; }
void Window::close() { glfwSetWindowShouldClose(window_, GLFW_TRUE); }
void Window::keep_open() { glfwSetWindowShouldClose(window_, GLFW_FALSE); }
void Window::raise() {
  glfwRestoreWindow(window_);
  glfwShowWindow(window_);
  glfwFocusWindow(window_);
  glfwRequestWindowAttention(window_);
}
void Window::hide() { glfwHideWindow(window_); }
void Window::set_title(const std::string& title) { glfwSetWindowTitle(window_, title.c_str()); }

void Window::toggle_full_screen() {
  if (glfwGetWindowMonitor(window_)) {
    glfwSetWindowMonitor(window_, nullptr, windowed_.x, windowed_.y, windowed_.z, windowed_.w, GLFW_DONT_CARE);
    return;
  }
  GLFWmonitor* monitor = glfwGetPrimaryMonitor();
  const GLFWvidmode* mode = monitor ? glfwGetVideoMode(monitor) : nullptr;
  if (!mode) return;
  glfwGetWindowPos(window_, &windowed_.x, &windowed_.y);
  glfwGetWindowSize(window_, &windowed_.z, &windowed_.w);
  glfwSetWindowMonitor(window_, monitor, 0, 0, mode->width, mode->height, mode->refreshRate);
}

glm::ivec2 Window::framebuffer_size() const {
  glm::ivec2 size(0);
  glfwGetFramebufferSize(window_, &size.x, &size.y);
  return size;
}

glm::ivec2 Window::window_size() const {
  glm::ivec2 size(0);
  glfwGetWindowSize(window_, &size.x, &size.y);
  return size;
}

std::optional<glm::ivec2> Window::place() const {
  if (glfwGetWindowAttrib(window_, GLFW_ICONIFIED)) return std::nullopt;
  glm::ivec2 at(0);
  (void)glfwGetError(nullptr);
  glfwGetWindowPos(window_, &at.x, &at.y);
  return glfwGetError(nullptr) == GLFW_NO_ERROR ? std::optional(at) : std::nullopt;
}

void Window::move_to(const glm::ivec2& place) {
  constexpr int kHold = 100;  // screen units; min width and height of the window that must be on a monitor
  int count = 0;
  GLFWmonitor** const monitors = glfwGetMonitors(&count);
  for (int i = 0; i < count; ++i) {
    glm::ivec4 area(0);
    glfwGetMonitorWorkarea(monitors[i], &area.x, &area.y, &area.z, &area.w);
    if (place.x >= area.x && place.y >= area.y && place.x + kHold <= area.x + area.z &&
        place.y + kHold <= area.y + area.w) {
      glfwSetWindowPos(window_, place.x, place.y);
      return;
    }
  }
}

bool Window::is_full_screen() const { return glfwGetWindowMonitor(window_) != nullptr; }

float Window::content_scale() const {
  float x = 1, y = 1;
  glfwGetWindowContentScale(window_, &x, &y);
  return std::clamp(std::max(x, y), 0.5f, 4.0f);
}

double Window::now() { return glfwGetTime(); }

}  // namespace gs::app
