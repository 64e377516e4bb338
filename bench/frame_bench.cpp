// Measures frames: `frame_bench [--backend NAME] [--frames N] [--size WxH] [--samples N] FILE...` prints a row for each
// world. The row begins with the triangles, items and draw calls of a frame (1024x768 with 4 samples), and the time of
// the first frame, which uploads and compiles. Median times follow: as a picture, and as a window at rest, while the
// viewer moves sideways by a thousandth of the view, and during this movement without cancellation. The last time ends
// when the frame of this last case has been submitted, before the driver has drawn it. Times are milliseconds elapsed,
// and milliseconds of the processor (all threads). The backend is osmesa unless named. Worlds are loaded with Inlines,
// images and streams, and stay at their first moment.
#include "app/loading/world_loader.h"
#include "bench/shared/open_gl.h"
#include "render/collection/render_scene.h"
#include "render/draw/renderer.h"

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

double milliseconds_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
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
    clock.push_back(milliseconds_since(begin));
    processor.push_back(processor_milliseconds() - busy);
  }
  char text[64];
  std::snprintf(text, sizeof text, "%8.2f / %7.2f", median(clock), median(processor));
  return text;
}

}  // namespace

int main(int count, char** arguments) {
  int frames = 20, first = 1;
  std::string backend = "osmesa";
  render::DrawOptions draw;
  for (; first + 1 < count && arguments[first][0] == '-'; first += 2) {
    const char* const value = arguments[first + 1];
    const std::string_view name = arguments[first];
    if (name == "--backend") backend = value;
    if (name == "--frames") frames = std::max(std::atoi(value), 1);
    if (name == "--samples") draw.samples = std::max(std::atoi(value), 1);
    if (name == "--size") (void)std::sscanf(value, "%dx%d", &draw.width, &draw.height);
  }
  const bench::OpenGl opened(backend);
  if (!opened.context) return 1;
  auto created = render::Renderer::create(*opened.context);
  if (auto* error = std::get_if<render::ContextError>(&created)) return std::fputs(error->message.c_str(), stderr), 1;
  const auto renderer = std::move(std::get<std::unique_ptr<render::Renderer>>(created));
  const render::Gl& gl = opened.gl;
  std::printf("%s, OpenGL %s\n", gl.renderer.c_str(), reinterpret_cast<const char*>(gl.GetString(GL_VERSION)));
  std::printf("%-24s %9s %7s %7s %8s %18s %18s %18s %18s %9s\n", "world, ms clock / processor", "triangles", "items",
              "calls", "first", "picture", "window", "window, moving", "not cancellable", "submitted");
  for (int i = first; i < count; ++i) {
    const app::LoadedWorld loaded_world = app::load_world(arguments[i]);
    if (!loaded_world.scene) return std::fprintf(stderr, "%s: cannot be read\n", arguments[i]), 1;
    render::MeshCache meshes;
    render::RenderScene world(*loaded_world.scene, loaded_world.images, loaded_world.geometries, meshes);
    world.gather({}, {0, 0, 10});
    render::Camera camera;
    if (world.list().viewpoints.empty()) {
      camera = render::orbit_camera(world.list().bounds, 0, 0, 0.785398f, static_cast<float>(draw.width),
                                    static_cast<float>(draw.height));
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
    const auto started = std::chrono::steady_clock::now();
    (void)renderer->draw_to_image(world.list(), camera, draw, &statistics);
    const double first_frame = milliseconds_since(started);
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
    draw.go_on = {};
    std::vector<double> submitted;
    const std::string whole = measured(frames, [&](int frame) {
      look(frame);
      const auto begin = std::chrono::steady_clock::now();
      (void)renderer->draw(world.list(), camera, draw);
      submitted.push_back(milliseconds_since(begin));
      gl.Finish();
    });
    const std::string name = std::string(arguments[i]).substr(std::string(arguments[i]).find_last_of('/') + 1);
    std::printf("%-24s %9zu %7zu %7zu %8.1f %18s %18s %18s %18s %9.1f\n", name.c_str(), statistics.triangles,
                statistics.items, statistics.draw_calls, first_frame, picture.c_str(), rest.c_str(), moving.c_str(),
                whole.c_str(), median(submitted));
    std::fflush(stdout);
  }
  return 0;
}
