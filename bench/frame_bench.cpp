// Measures frames of software rendering: `frame_bench [--frames N] [--size WxH] [--samples N] FILE...` prints, for each
// world, triangles, items and draw calls of a frame (1024x768 with 4 samples), and median times as a picture and as a
// window: at rest, and while the viewer moves sideways by a thousandth of the view. Milliseconds elapsed, and of the
// processor (all threads). Worlds are loaded with Inlines, images and streams, and stand at their first moment.
#include "app/loading/world_loader.h"
#include "render/collection/render_scene.h"
#include "render/draw/renderer.h"
#include "render/gl/context.h"
#include "render/gl/gl.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <memory>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace {

using namespace gs;

double processor_milliseconds() {
  std::timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return 1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec);
}

/// Returns median times of `draw`.
template <class Draw>
std::string measured(int frames, const Draw& draw) {
  std::vector<double> clock, processor;
  draw(0);
  for (int frame = 1; frame <= frames; ++frame) {
    const auto begin = std::chrono::steady_clock::now();
    const double busy = processor_milliseconds();
    draw(frame);
    clock.push_back(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count());
    processor.push_back(processor_milliseconds() - busy);
  }
  std::sort(clock.begin(), clock.end());
  std::sort(processor.begin(), processor.end());
  char text[64];
  std::snprintf(text, sizeof text, "%8.1f / %7.1f", clock[clock.size() / 2], processor[processor.size() / 2]);
  return text;
}

}  // namespace

int main(int count, char** arguments) {
  int frames = 20, first = 1;
  render::DrawOptions draw;
  for (; first + 1 < count && arguments[first][0] == '-'; first += 2) {
    const char* const value = arguments[first + 1];
    const std::string_view name = arguments[first];
    if (name == "--frames") frames = std::max(std::atoi(value), 1);
    if (name == "--samples") draw.samples = std::max(std::atoi(value), 1);
    if (name == "--size") (void)std::sscanf(value, "%dx%d", &draw.width, &draw.height);
  }
  auto opened = render::open_headless_context("osmesa");
  if (auto* error = std::get_if<render::ContextError>(&opened)) return std::fputs(error->message.c_str(), stderr), 1;
  const auto context = std::move(std::get<std::unique_ptr<render::GlContext>>(opened));
  auto created = render::Renderer::create(*context);
  if (auto* error = std::get_if<render::ContextError>(&created)) return std::fputs(error->message.c_str(), stderr), 1;
  const auto renderer = std::move(std::get<std::unique_ptr<render::Renderer>>(created));
  auto loaded = render::Gl::load(*context);
  if (auto* error = std::get_if<render::ContextError>(&loaded)) return std::fputs(error->message.c_str(), stderr), 1;
  const render::Gl& gl = std::get<render::Gl>(loaded);
  std::printf("%-28s %9s %7s %7s %18s %18s %18s\n", "world, ms clock / processor", "triangles", "items", "calls",
              "picture", "window", "window, moving");
  for (int i = first; i < count; ++i) {
    const app::LoadedWorld loaded_world = app::load_world(arguments[i]);
    if (!loaded_world.scene) return std::fprintf(stderr, "%s: cannot be read\n", arguments[i]), 1;
    render::MeshCache meshes;
    render::RenderScene world(*loaded_world.scene, loaded_world.images, loaded_world.geometries, meshes);
    world.gather({}, {0, 0, 10});
    render::Camera camera;
    if (world.list().viewpoints.empty()) {
      camera = render::orbit_camera(world.list().bounds, 0, 0, 0.785398f,
                                    static_cast<float>(draw.width), static_cast<float>(draw.height));
    } else {
      camera.world_from_camera = world.list().viewpoints[0].world_from_camera;
      camera.field_of_view = world.list().viewpoints[0].field_of_view;
    }
    const glm::dvec3 place(camera.world_from_camera[3]), side(camera.world_from_camera[0]);
    const double step = 1e-3 * glm::length(glm::dvec3(world.list().bounds.size()));
    const auto look = [&](int frame) {
      const glm::dvec3 at = place + side * (step * frame);
      camera.world_from_camera[3] = glm::dvec4(at, 1);
      (void)world.update({}, {}, at);
    };
    look(0);
    render::FrameStatistics statistics;
    const std::string picture =
        measured(frames, [&](int) { (void)renderer->draw_to_image(world.list(), camera, draw, &statistics); });
    draw.go_on = render::CancellationCheck{[] { return true; }};  // as in a window, where input cancels drawing
    const auto window = [&](int frame) {
      look(frame);
      (void)renderer->draw(world.list(), camera, draw);
      gl.Finish();
    };
    const std::string rest = measured(frames, [&](int) { window(0); });
    const std::string moving = measured(frames, window);
    const std::string name = std::string(arguments[i]).substr(std::string(arguments[i]).find_last_of('/') + 1);
    std::printf("%-28s %9zu %7zu %7zu %18s %18s %18s\n", name.c_str(), statistics.triangles, statistics.items,
                statistics.draw_calls, picture.c_str(), rest.c_str(), moving.c_str());
  }
  return 0;
}
