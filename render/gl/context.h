#pragma once

#include <array>
#include <memory>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace gs::render {

/// Current OpenGL 3.3 core context from any source. The renderer draws into it and never creates one. One thread at a
/// time.
class GlContext {
 public:
  using Procedure = void (*)();
  virtual ~GlContext() = default;
  virtual void make_current() = 0;
  /// Releases the context, so that another thread can make it current.
  virtual void release_current() = 0;
  /// Presents the frame in the window. Does nothing off screen.
  virtual void present() = 0;
  [[nodiscard]] virtual Procedure proc_address(const char* name) = 0;
  /// Returns the name of the backend: "glfw", "egl" or "osmesa".
  [[nodiscard]] virtual std::string_view backend() const = 0;
};

struct GlVersion {
  int major, minor;
};

/// Versions of OpenGL to request, in this order. Some drivers, such as NVIDIA's, give exactly the requested version,
/// and with it no functions of later ones. 4.5 has all that the renderer uses, and 3.3 all that it requires.
inline constexpr std::array<GlVersion, 3> kContextVersions{{{4, 5}, {4, 3}, {3, 3}}};

struct ContextError {
  std::string message;
};

/// Opens a context without a window. `backend` is "auto" or a headless backend ("egl", "osmesa"). The backend's library
/// is opened at run time. "auto" selects EGL if a GPU exists, otherwise OSMesa. The error lists each attempt with its
/// reason for failure.
[[nodiscard]] std::variant<std::unique_ptr<GlContext>, ContextError> open_headless_context(std::string_view backend);

/// Releases the memory of the driver's compiler and linker code: about 50 MB, of which later calls restore a tenth.
/// Call it after the driver has compiled the programs. Thread-safe.
void release_driver_code();

/// Returns the names of the headless backends, in the order in which "auto" tries them.
[[nodiscard]] std::vector<std::string_view> headless_backends();

}  // namespace gs::render
