// Measures frames of a running world: `living_bench [--draw] FILE...` prints, for each world, the ROUTEs, the time to
// connect them, and the time of a full collection. Of 600 frames of 1/60 s it prints median and longest time of the
// events, and median times of updating the render list and, with software rendering at 1024 x 768, of the whole.
// Milliseconds of one core; drawing uses all cores.
#include "bench/shared/world_file.h"
#include "render/collection/render_scene.h"
#include "render/draw/renderer.h"
#include "render/gl/context.h"
#include "vrml/events/execution.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <memory>
#include <variant>
#include <vector>

namespace {

using namespace gs;
using Clock = std::chrono::steady_clock;

double milliseconds(Clock::time_point from) {
  return std::chrono::duration<double, std::milli>(Clock::now() - from).count();
}

double median(std::vector<double>& values) {
  std::sort(values.begin(), values.end());
  return values.empty() ? 0 : values[values.size() / 2];
}

render::BoundNodes bound(const vrml::Execution& execution) {
  const auto node_of = [&](vrml::NodeKind kind) -> const vrml::Node* {
    const vrml::NodeChange found = execution.stacks().bound(vrml::built_in_node_type(kind));
    return found.scene ? &found.scene->node(found.node) : nullptr;
  };
  return {node_of(vrml::NodeKind::viewpoint), node_of(vrml::NodeKind::navigation_info),
          node_of(vrml::NodeKind::background)};
}

}  // namespace

int main(int count, char** arguments) {
  constexpr double kStart = 946684800;
  int frames = 600, first = 1;
  std::unique_ptr<render::GlContext> context;
  std::unique_ptr<render::Renderer> renderer;
  if (count > 1 && std::strcmp(arguments[1], "--draw") == 0) {
    first = 2;
    frames = 60;
    auto opened = render::open_headless_context("auto");
    if (auto* error = std::get_if<render::ContextError>(&opened)) return std::fputs(error->message.c_str(), stderr), 1;
    context = std::move(std::get<std::unique_ptr<render::GlContext>>(opened));
    auto created = render::Renderer::create(*context);
    if (auto* error = std::get_if<render::ContextError>(&created)) return std::fputs(error->message.c_str(), stderr), 1;
    renderer = std::move(std::get<std::unique_ptr<render::Renderer>>(created));
  }
  std::printf("%-32s %8s %10s %10s %10s %10s %10s %10s\n", "world", "ROUTEs", "connect", "gather", "events", "longest",
              "follow", "whole");
  for (int i = first; i < count; ++i) {
    vrml::SceneGraph scene(arguments[i]);
    bench::read_world(arguments[i], scene);
    const Clock::time_point connecting = Clock::now();
    vrml::Execution execution(scene);
    execution.start(kStart);
    const double connected = milliseconds(connecting);
    const Clock::time_point gathering = Clock::now();
    const render::Images images;
    const render::Geometries geometries;
    render::MeshCache meshes;
    render::RenderScene list(scene, images, geometries, meshes);
    glm::vec3 viewer(0, 0, 10);
    list.gather(bound(execution), viewer);
    const double gathered = milliseconds(gathering);
    render::Camera camera;
    camera.world_from_camera[3] = glm::vec4(viewer, 1);
    if (!list.list().viewpoints.empty()) camera.world_from_camera = list.list().viewpoints[0].world_from_camera;
    std::vector<double> events, follows, wholes;
    for (int frame = 1; frame <= frames; ++frame) {
      const Clock::time_point begin = Clock::now();
      execution.step(kStart + frame / 60.0);
      const auto changes = execution.changes().take();
      events.push_back(milliseconds(begin));
      const Clock::time_point following = Clock::now();
      render::forget_changed(meshes, changes);
      (void)list.update(changes, bound(execution), viewer);
      follows.push_back(milliseconds(following));
      if (renderer) {
        render::DrawOptions draw;
        draw.samples = 0;
        (void)renderer->draw_to_image(list.list(), render::fit_depth(camera, list.list().bounds), draw);
      }
      wholes.push_back(milliseconds(begin));
    }
    const double longest = *std::max_element(events.begin(), events.end());
    std::printf("%-32s %8zu %10.2f %10.2f %10.3f %10.3f %10.3f %10.3f\n", arguments[i], scene.routes().size(),
                connected, gathered, median(events), longest, median(follows), median(wholes));
  }
  return 0;
}
