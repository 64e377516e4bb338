#include "render/gl/context_backend.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

namespace gs::render {
namespace {

// Definitions of EGL 1.5 and its extensions EGL_EXT_platform_device, EGL_EXT_device_enumeration and
// EGL_MESA_platform_surfaceless. EGL is opened at run time, so its headers are not included.
using Display = void*;
using Config = void*;
using Device = void*;
using Context = void*;
using Attribute = std::int32_t;
constexpr unsigned kPlatformDevice = 0x313F, kPlatformSurfaceless = 0x31DD, kOpenglApi = 0x30A2;
constexpr Attribute kNone = 0x3038, kSurfaceType = 0x3033, kRenderableType = 0x3040, kOpenglBit = 0x0008;
constexpr Attribute kContextMajorVersion = 0x3098, kContextMinorVersion = 0x30FB, kContextProfileMask = 0x30FD,
                    kContextCoreProfileBit = 0x0001, kExtensions = 0x3055;
constexpr unsigned kGlRenderer = 0x1F01;

struct EglLibrary {
  RuntimeLibrary library{"libEGL.so.1", "libEGL.so"};
  GlContext::Procedure (*get_proc_address)(const char*) = nullptr;
  const char* (*query_string)(Display, Attribute) = nullptr;
  unsigned (*initialize)(Display, Attribute* major, Attribute* minor) = nullptr;
  unsigned (*bind_api)(unsigned) = nullptr;
  unsigned (*choose_config)(Display, const Attribute*, Config*, Attribute size, Attribute* count) = nullptr;
  Context (*create_context)(Display, Config, Context shared, const Attribute*) = nullptr;
  unsigned (*destroy_context)(Display, Context) = nullptr;
  unsigned (*make_current)(Display, void* draw, void* read, Context) = nullptr;
  Display (*get_platform_display)(unsigned platform, void* native, const Attribute*) = nullptr;  // may be null
  unsigned (*query_devices)(Attribute size, Device*, Attribute* count) = nullptr;  // may be null
  const char* (*query_device_string)(Device, Attribute) = nullptr;  // may be null

  [[nodiscard]] bool load() {
    const bool core =
        library.find("eglGetProcAddress", get_proc_address) && library.find("eglQueryString", query_string) &&
        library.find("eglInitialize", initialize) && library.find("eglBindAPI", bind_api) &&
        library.find("eglChooseConfig", choose_config) && library.find("eglCreateContext", create_context) &&
        library.find("eglDestroyContext", destroy_context) && library.find("eglMakeCurrent", make_current);
    if (!core) return false;
    extension("eglGetPlatformDisplayEXT", get_platform_display);
    extension("eglQueryDevicesEXT", query_devices);
    extension("eglQueryDeviceStringEXT", query_device_string);
    return true;
  }
  template <class Function>
  void extension(const char* name, Function& function) const {
    function = reinterpret_cast<Function>(get_proc_address(name));
  }
};

class EglContext final : public GlContext {
 public:
  EglContext(const EglLibrary& library, Display display) : library_(library), display_(display) {}
  /// Destroys the context, but does not terminate the display: other contexts of the process may use it.
  ~EglContext() override {
    if (!context_) return;
    library_.make_current(display_, nullptr, nullptr, nullptr);
    library_.destroy_context(display_, context_);
  }
  void make_current() override { library_.make_current(display_, nullptr, nullptr, context_); }
  void release_current() override { library_.make_current(display_, nullptr, nullptr, nullptr); }
  void present() override {}
  Procedure proc_address(const char* name) override { return library_.get_proc_address(name); }
  [[nodiscard]] std::string_view backend() const override { return "egl"; }

  /// Creates the context and makes it current. Returns false if the display does not support OpenGL 3.3 core.
  [[nodiscard]] bool create() {
    constexpr std::array<Attribute, 5> kConfig{kRenderableType, kOpenglBit, kSurfaceType, 0, kNone};
    Config config = nullptr;
    Attribute count = 0;
    if (!library_.bind_api(kOpenglApi) || !library_.choose_config(display_, kConfig.data(), &config, 1, &count))
      return false;
    // If no config matches, create the context without one (EGL_KHR_no_config_context).
    for (const GlVersion& version : kContextVersions) {
      const std::array<Attribute, 7> wanted{
          kContextMajorVersion,   version.major, kContextMinorVersion, version.minor, kContextProfileMask,
          kContextCoreProfileBit, kNone};
      context_ = library_.create_context(display_, count > 0 ? config : nullptr, nullptr, wanted.data());
      if (context_) break;
    }
    return context_ && library_.make_current(display_, nullptr, nullptr, context_);
  }
  [[nodiscard]] bool draws_on_cpu() {
    const auto get_string = reinterpret_cast<const unsigned char* (*)(unsigned)>(proc_address("glGetString"));
    const unsigned char* name = get_string ? get_string(kGlRenderer) : nullptr;
    return is_software_renderer(name ? reinterpret_cast<const char*>(name) : "");
  }

 private:
  EglLibrary library_;
  Display display_;
  Context context_ = nullptr;
};

/// Returns the devices in EGL's order, GPUs first. If `hardware_only`, omits other devices.
std::vector<Device> devices(const EglLibrary& egl, bool hardware_only) {
  std::vector<Device> all(16);
  Attribute count = 0;
  if (!egl.query_devices || !egl.query_devices(static_cast<Attribute>(all.size()), all.data(), &count)) return {};
  all.resize(static_cast<std::size_t>(std::clamp<Attribute>(count, 0, 16)));
  const auto is_gpu = [&](Device device) {
    const char* extensions = egl.query_device_string ? egl.query_device_string(device, kExtensions) : nullptr;
    return !extensions || std::string_view(extensions).find("EGL_MESA_device_software") == std::string_view::npos;
  };
  const auto first_other = std::stable_partition(all.begin(), all.end(), is_gpu);
  if (hardware_only) all.erase(first_other, all.end());
  return all;
}

}  // namespace

OpenedContext open_egl_context(bool hardware_only) {
  // This check is faster: EGL would open a dozen libraries and find no GPU either.
  if (hardware_only && !may_have_gpu()) return ContextError{"no GPU in /dev"};
  EglLibrary egl;
  if (!egl.library) return ContextError{egl.library.error()};
  if (!egl.load()) return ContextError{"libEGL is older than 1.4"};
  if (!egl.get_platform_display) return ContextError{"EGL_EXT_platform_base is missing"};

  std::string reason = "no device";
  const auto open = [&](unsigned platform, void* native) -> std::unique_ptr<GlContext> {
    const Display display = egl.get_platform_display(platform, native, nullptr);
    if (!display || !egl.initialize(display, nullptr, nullptr)) {
      reason = "eglInitialize failed";
      return nullptr;
    }
    auto context = std::make_unique<EglContext>(egl, display);
    if (!context->create()) {
      reason = "no OpenGL 3.3 core context without a surface";
      return nullptr;
    }
    if (hardware_only && context->draws_on_cpu()) {
      reason = "no GPU";
      return nullptr;
    }
    return context;
  };
  const std::vector<Device> found = devices(egl, hardware_only);
  for (Device device : found)
    if (auto context = open(kPlatformDevice, device)) return context;
  // EGL has listed the devices and none is a usable GPU, so the surfaceless platform has none either.
  if (hardware_only && egl.query_devices) return ContextError{found.empty() ? "no GPU" : reason};
  if (auto context = open(kPlatformSurfaceless, nullptr)) return context;
  return ContextError{reason};
}

}  // namespace gs::render
