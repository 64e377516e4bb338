#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace gs::render {

/// A current OpenGL 3.3 core context, whoever made it. The renderer draws into it and never makes one.
/// One thread at a time.
class GlContext {
 public:
  using Procedure = void (*)();
  virtual ~GlContext() = default;
  virtual void make_current() = 0;
  /// So that another thread may make it current.
  virtual void release_current() = 0;
  /// Shows what was drawn; nothing to do off screen.
  virtual void present() = 0;
  [[nodiscard]] virtual Procedure proc_address(const char* name) = 0;
  /// "glfw", "egl" or "osmesa".
  [[nodiscard]] virtual std::string_view backend() const = 0;
};

struct ContextError {
  std::string message;
};

/// Opens a context without a window. `backend` is "auto" or the name of a row of the table of headless
/// backends ("egl", "osmesa"), each of whose libraries is opened at run time. "auto" takes EGL where
/// there is a GPU, else OSMesa. Fails with what was tried and why each failed.
[[nodiscard]] std::variant<std::unique_ptr<GlContext>, ContextError> open_headless_context(std::string_view backend);

/// The code of the driver's compiler, and what linked it, leave the memory of the process: 50 MB, of which a tenth
/// comes back from their file as it is called again. Any thread; for when a driver is ready for what it will draw.
void release_driver_code();

/// The names of the headless backends, in the order in which "auto" tries them.
[[nodiscard]] std::vector<std::string_view> headless_backends();

}  // namespace gs::render
