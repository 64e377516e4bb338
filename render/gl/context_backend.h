#pragma once

#include "render/gl/context.h"

#include <filesystem>
#include <initializer_list>
#include <memory>
#include <string>
#include <string_view>
#include <variant>

namespace gs::render {

using OpenedContext = std::variant<std::unique_ptr<GlContext>, ContextError>;

/// One way to get a context without a window.
struct HeadlessBackend {
  std::string_view name;
  /// Opens and makes current. With `hardware_only`, a renderer that runs on the CPU is an error.
  OpenedContext (*open)(bool hardware_only);
  bool software;  // always draws on the CPU, so that "auto" does not ask it for hardware
};

[[nodiscard]] OpenedContext open_egl_context(bool hardware_only);
[[nodiscard]] OpenedContext open_osmesa_context(bool hardware_only);

/// False only if nothing in the folder of devices could be a GPU: whatever is not known to be something else could.
[[nodiscard]] bool may_have_gpu(const std::filesystem::path& devices = "/dev");

/// Whether this is the GL_RENDERER string of a driver that draws on the CPU.
[[nodiscard]] bool is_software_renderer(std::string_view renderer);

/// A library opened at run time. It stays in the process: drivers leave thread-exit handlers and
/// worker threads behind that must not lose their code.
class RuntimeLibrary {
 public:
  /// The first of `names` that opens; otherwise `error()` says why the last one did not.
  explicit RuntimeLibrary(std::initializer_list<const char*> names);
  explicit operator bool() const { return handle_ != nullptr; }
  [[nodiscard]] const std::string& error() const { return error_; }
  /// Sets `function` to the symbol `name`; false when the library has none.
  template <class Function>
  [[nodiscard]] bool find(const char* name, Function& function) const {
    function = reinterpret_cast<Function>(symbol(name));
    return function != nullptr;
  }

 private:
  [[nodiscard]] void* symbol(const char* name) const;
  void* handle_ = nullptr;
  std::string error_;
};

}  // namespace gs::render
