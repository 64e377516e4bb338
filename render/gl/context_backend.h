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

/// Implementation of contexts without a window.
struct HeadlessBackend {
  std::string_view name;
  /// Opens a context and makes it current. With `hardware_only`, a software renderer is an error.
  OpenedContext (*open)(bool hardware_only);
  bool software;  // always draws on the CPU; "auto" skips it when it asks for hardware
};

[[nodiscard]] OpenedContext open_egl_context(bool hardware_only);
[[nodiscard]] OpenedContext open_osmesa_context(bool hardware_only);

/// Returns false only if no device in the folder can be a GPU; unknown devices count as possible GPUs.
[[nodiscard]] bool may_have_gpu(const std::filesystem::path& devices = "/dev");

/// Reports whether the GL_RENDERER string belongs to a software driver.
[[nodiscard]] bool is_software_renderer(std::string_view renderer);

/// Library opened at run time and never closed: drivers leave thread-exit handlers and worker threads that must not
/// lose their code.
class RuntimeLibrary {
 public:
  /// Opens the first available one of `names`; otherwise `error()` explains why the last one failed.
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
