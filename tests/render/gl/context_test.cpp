#include "render/gl/context.h"

#include "render/gl/context_backend.h"
#include "render/gl/range_allocator.h"
#include "tests/app/scratch_folder.h"
#include "tests/render/drawing.h"

#include <string>

using namespace gs::render;
using namespace gs::render::testing;

TEST_CASE("opens OSMesa with its OpenGL functions") {
  auto opened = open_headless_context("osmesa");
  REQUIRE(std::holds_alternative<std::unique_ptr<GlContext>>(opened));
  auto& context = *std::get<std::unique_ptr<GlContext>>(opened);
  CHECK(context.backend() == "osmesa");
  context.make_current();
  context.present();
  CHECK(context.proc_address("glGetString") != nullptr);
}

TEST_CASE("finds a backend automatically") {
  const auto opened = open_headless_context("auto");
  CHECK(std::holds_alternative<std::unique_ptr<GlContext>>(opened));
}

TEST_CASE("opens EGL or reports why not") {
  auto opened = open_headless_context("egl");
  if (auto* error = std::get_if<ContextError>(&opened)) {
    CHECK(error->message.find("egl: ") != std::string::npos);
    WARN("EGL is not available here: " << error->message);
    return;
  }
  auto& context = *std::get<std::unique_ptr<GlContext>>(opened);
  CHECK(context.backend() == "egl");
  auto loaded = Gl::load(context);
  REQUIRE(std::holds_alternative<Gl>(loaded));
  const Gl& gl = std::get<Gl>(loaded);
  GLint major = 0, minor = 0;
  gl.GetIntegerv(GL_MAJOR_VERSION, &major);
  gl.GetIntegerv(GL_MINOR_VERSION, &minor);
  // No driver of the last ten years lacks OpenGL 4.5, unless the version is not requested.
  INFO(gl.renderer << ", OpenGL " << major << "." << minor);
  CHECK(10 * major + minor >= 45);
  CHECK(gl.MultiDrawElementsIndirect != nullptr);
  CHECK(gl.DispatchCompute != nullptr);
  CHECK(gl.ClipControl != nullptr);
  auto made = Renderer::create(context);
  REQUIRE(std::holds_alternative<std::unique_ptr<Renderer>>(made));
  RenderList list;
  add(list, glowing(square(20), {0, 0.4f, 0.8f}));
  DrawOptions options;
  options.width = options.height = 16;
  auto drawn = std::get<std::unique_ptr<Renderer>>(made)->draw_to_image(list, camera_at({0, 0, 10}), options);
  REQUIRE(std::holds_alternative<Image>(drawn));
  check_color(pixel(std::get<Image>(drawn), 8, 8), {0, 0.4f, 0.8f});
}

TEST_CASE("tells software drivers from GPUs by their names") {
  for (const char* name : {"llvmpipe (LLVM 15.0.6, 256 bits)", "softpipe", "Software Rasterizer",
                           "ANGLE (Google, Vulkan 1.3.0 (SwiftShader Device (LLVM 10.0.0)), SwiftShader driver)"}) {
    INFO(name);
    CHECK(is_software_renderer(name));
  }
  for (const char* name : {"NVIDIA H200/PCIe/SSE2", "AMD Radeon RX 6600 (radeonsi, navi23, LLVM 15.0.6)",
                           "Mesa Intel(R) UHD Graphics 620 (KBL GT2)", ""}) {
    INFO(name);
    CHECK(!is_software_renderer(name));
  }
}

TEST_CASE("rejects an unknown backend and lists the known names") {
  const auto opened = open_headless_context("directx");
  REQUIRE(std::holds_alternative<ContextError>(opened));
  const std::string& message = std::get<ContextError>(opened).message;
  CHECK(message.find("'directx'") != std::string::npos);
  for (const std::string_view name : headless_backends()) CHECK(message.find(name) != std::string::npos);
  CHECK(headless_backends() == std::vector<std::string_view>{"egl", "osmesa"});
}

TEST_CASE("assumes a GPU unless all devices are known to be something else") {
  const ScratchFolder plain;
  for (const char* name : {"null", "tty63", "ttyS0", "loop-control", "vcsa1", "net/tun", "shm/x", "cpu/0/msr"})
    plain.write(name, "");
  CHECK_FALSE(may_have_gpu(plain.path("")));
  // Mesa, WSL, NVIDIA and Tegra, Mali, PowerVR, Adreno, VideoCore, Vivante, and unknown devices.
  for (const char* name : {"dri/renderD128", "dxg", "nvidia0", "nvidiactl", "nvmap", "nvhost-gpu", "mali0", "pvrsrvkm",
                           "kgsl-3d0", "vchiq", "galcore", "kfd", "unheard-of7"}) {
    const ScratchFolder other;
    other.write("null", "");
    other.write(name, "");
    CHECK(may_have_gpu(other.path("")));
  }
  CHECK(may_have_gpu(plain.path("not there")));
}

TEST_CASE("draws on after the driver's code left the memory, including later compilations") {
  Drawing drawing;
  RenderList list;
  add(list, glowing(square(20), {1, 0, 0}));
  check_color(pixel(drawing.draw(list), 32, 32), {1, 0, 0});
  release_driver_code();
  check_color(pixel(drawing.draw(list), 32, 32), {1, 0, 0});
  list.items[0] = unlit(square(20));
  release_driver_code();
  check_color(pixel(drawing.draw(list), 32, 32), {1, 1, 1});
}

TEST_CASE("alternates two renderers") {
  Drawing first;
  RenderList list;
  add(list, glowing(square(20), {1, 0, 0}));
  check_color(pixel(first.draw(list), 32, 32), {1, 0, 0});
  {
    Drawing second;
    check_color(pixel(second.draw(list), 32, 32), {1, 0, 0});
  }
  first.context().make_current();
  check_color(pixel(first.draw(list), 32, 32), {1, 0, 0});
}

TEST_CASE("allocates ranges first fit, and merges returned ones") {
  RangeAllocator ranges(100);
  CHECK(ranges.take(40) == std::size_t{0});
  CHECK(ranges.take(40) == std::size_t{40});
  CHECK_FALSE(ranges.take(21));
  CHECK(ranges.take(20) == std::size_t{80});
  CHECK_FALSE(ranges.take(1));
  ranges.give_back(0, 40);
  ranges.give_back(80, 20);
  CHECK_FALSE(ranges.take(41));
  ranges.give_back(40, 40);
  CHECK(ranges.take(100) == std::size_t{0});
  CHECK_FALSE(RangeAllocator(0).take(1));
}
