#include "render/gl/context.h"

#include "render/gl/context_backend.h"

#include <dlfcn.h>

#include <algorithm>
#include <array>
#include <utility>

namespace gs::render {
namespace {

// In the order in which "auto" tries them.
constexpr std::array kBackends{
    HeadlessBackend{"egl", open_egl_context, false},
    HeadlessBackend{"osmesa", open_osmesa_context, true},
};

}  // namespace

RuntimeLibrary::RuntimeLibrary(std::initializer_list<const char*> names) {
  for (const char* name : names) {
    handle_ = dlopen(name, RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
    if (handle_) return;
    const char* reason = dlerror();
    error_ = reason ? reason : name;
  }
}

void* RuntimeLibrary::symbol(const char* name) const { return handle_ ? dlsym(handle_, name) : nullptr; }

bool is_software_renderer(std::string_view renderer) {
  constexpr std::array<std::string_view, 4> kWords{"llvmpipe", "softpipe", "swrast", "Software"};
  return std::any_of(kWords.begin(), kWords.end(),
                     [&](std::string_view word) { return renderer.find(word) != std::string_view::npos; });
}

std::variant<std::unique_ptr<GlContext>, ContextError> open_headless_context(std::string_view backend) {
  const bool automatic = backend == "auto";
  std::string tried, names = "auto";
  for (const HeadlessBackend& row : kBackends) {
    names.append(", ").append(row.name);
    if (!automatic && row.name != backend) continue;
    OpenedContext opened = row.open(automatic && !row.software);
    if (std::holds_alternative<std::unique_ptr<GlContext>>(opened)) return opened;
    if (!tried.empty()) tried += "; ";
    tried.append(row.name).append(": ").append(std::get<ContextError>(opened).message);
  }
  if (tried.empty()) return ContextError{"no backend '" + std::string(backend) + "': expected one of " + names};
  return ContextError{"no OpenGL 3.3 context could be opened (" + tried + ")"};
}

std::vector<std::string_view> headless_backends() {
  std::vector<std::string_view> names;
  for (const HeadlessBackend& row : kBackends) names.push_back(row.name);
  return names;
}

}  // namespace gs::render
