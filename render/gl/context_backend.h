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

/// Row of the table of headless backends, that is, sources of contexts without a window.
struct HeadlessBackend {
  std::string_view name;
  /// Opens a context and makes it current. If `hardware_only`, a software renderer is an error.
  OpenedContext (*open)(bool hardware_only);
  bool software;  // always draws on the CPU; "auto" skips it when it asks for hardware
};

[[nodiscard]] OpenedContext open_egl_context(bool hardware_only);
[[nodiscard]] OpenedContext open_osmesa_context(bool hardware_only);

/// Returns false only if no device in the folder can be a GPU. Unknown devices count as possible GPUs.
[[nodiscard]] bool may_have_gpu(const std::filesystem::path& devices = "/dev");

/// Reports whether a GL_RENDERER string belongs to a software driver.
[[nodiscard]] bool is_software_renderer(std::string_view renderer);

/// Library that is opened at run time and never closed. Drivers leave thread-exit handlers and worker threads that
/// still need its code.
class RuntimeLibrary {
 public:
  /// Opens the first library of `names` that is available. If none is, `error()` is the message for the last name.
  explicit RuntimeLibrary(std::initializer_list<const char*> names);
  explicit operator bool() const { return handle_ != nullptr; }
  [[nodiscard]] const std::string& error() const { return error_; }
  /// Sets `function` to the symbol `name`. Returns false if the library does not export it.
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
