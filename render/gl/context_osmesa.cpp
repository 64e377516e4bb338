#include "render/gl/context_backend.h"

#include <array>
#include <cstdint>
#include <memory>
#include <utility>

#if defined(__SANITIZE_ADDRESS__)
// Suppresses a leak report: OSMesa 22 leaks the default framebuffer's description, about 200 bytes per context.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() { return "leak:libOSMesa"; }
#endif

namespace gs::render {
namespace {

// Constants of OSMesa 11.2. The library is opened at run time, so its header is not included.
constexpr int kOsmesaRgba = 0x1908, kOsmesaFormat = 0x22;
constexpr int kOsmesaDepthBits = 0x30, kOsmesaStencilBits = 0x31, kOsmesaAccumBits = 0x32;
constexpr int kOsmesaProfile = 0x33, kOsmesaCoreProfile = 0x34;
constexpr int kOsmesaMajorVersion = 0x36, kOsmesaMinorVersion = 0x37;
constexpr unsigned kUnsignedByte = 0x1401;

struct OsmesaLibrary {
  using Context = void*;
  RuntimeLibrary library{"libOSMesa.so.8", "libOSMesa.so"};
  Context (*create_context)(const int* attributes, Context shared) = nullptr;
  void (*destroy_context)(Context) = nullptr;
  unsigned char (*make_current)(Context, void* buffer, unsigned type, int width, int height) = nullptr;
  GlContext::Procedure (*proc_address)(const char* name) = nullptr;

  [[nodiscard]] bool load() {
    return library.find("OSMesaCreateContextAttribs", create_context) &&
           library.find("OSMesaDestroyContext", destroy_context) && library.find("OSMesaMakeCurrent", make_current) &&
           library.find("OSMesaGetProcAddress", proc_address);
  }
};

class OsmesaContext final : public GlContext {
 public:
  OsmesaContext(OsmesaLibrary library, OsmesaLibrary::Context context)
      : library_(std::move(library)), context_(context) {}
  ~OsmesaContext() override {
    library_.make_current(nullptr, nullptr, 0, 0, 0);
    library_.destroy_context(context_);
  }
  void make_current() override { (void)bind(); }
  void release_current() override { (void)library_.make_current(nullptr, nullptr, 0, 0, 0); }
  void present() override {}
  Procedure proc_address(const char* name) override { return library_.proc_address(name); }
  [[nodiscard]] std::string_view backend() const override { return "osmesa"; }
  [[nodiscard]] bool bind() {
    return library_.make_current(context_, pixels_.data(), kUnsignedByte, kSide, kSide) != 0;
  }

 private:
  // Side of the default framebuffer, which OSMesa requires. Images are drawn into other framebuffers.
  static constexpr int kSide = 16;
  OsmesaLibrary library_;
  OsmesaLibrary::Context context_;
  alignas(16) std::array<std::uint32_t, kSide * kSide> pixels_{};
};

}  // namespace

OpenedContext open_osmesa_context(bool hardware_only) {
  if (hardware_only) return ContextError{"OSMesa draws on the CPU"};
  OsmesaLibrary library;
  if (!library.library) return ContextError{library.library.error()};
  if (!library.load()) return ContextError{"libOSMesa is older than 11.2"};
  const std::array attributes{kOsmesaFormat,
                              kOsmesaRgba,
                              kOsmesaDepthBits,
                              0,
                              kOsmesaStencilBits,
                              0,
                              kOsmesaAccumBits,
                              0,
                              kOsmesaProfile,
                              kOsmesaCoreProfile,
                              kOsmesaMajorVersion,
                              3,
                              kOsmesaMinorVersion,
                              3,
                              0,
                              0};
  const OsmesaLibrary::Context context = library.create_context(attributes.data(), nullptr);
  if (!context) return ContextError{"OSMesa gives no OpenGL 3.3 core context"};
  auto opened = std::make_unique<OsmesaContext>(std::move(library), context);
  if (!opened->bind()) return ContextError{"OSMesaMakeCurrent failed"};
  return opened;
}

}  // namespace gs::render
