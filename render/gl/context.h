#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace gs::render {

/// A current OpenGL 3.3 core context from any source. The renderer draws into it and never creates one. Used by one
/// thread at a time.
class GlContext {
 public:
  using Procedure = void (*)();
  virtual ~GlContext() = default;
  virtual void make_current() = 0;
  /// Releases the context, so that another thread may make it current.
  virtual void release_current() = 0;
  /// Presents the frame; does nothing off screen.
  virtual void present() = 0;
  [[nodiscard]] virtual Procedure proc_address(const char* name) = 0;
  /// Returns "glfw", "egl" or "osmesa".
  [[nodiscard]] virtual std::string_view backend() const = 0;
};

struct ContextError {
  std::string message;
};

/// Opens a context without a window. `backend` is "auto" or the name of a headless backend ("egl", "osmesa"); their
/// libraries are opened at run time. "auto" selects EGL if there is a GPU, else OSMesa. The error lists each attempt
/// with its reason for failure.
[[nodiscard]] std::variant<std::unique_ptr<GlContext>, ContextError> open_headless_context(std::string_view backend);

/// Removes the driver's compiler and linker code from process memory: about 50 MB, a tenth of which returns on later
/// calls. Call it after the driver has compiled the programs. Thread-safe.
void release_driver_code();

/// Returns the names of the headless backends in the order in which "auto" tries them.
[[nodiscard]] std::vector<std::string_view> headless_backends();

}  // namespace gs::render
