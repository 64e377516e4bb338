#include "app/commands/animate.h"

#include "app/base/console.h"
#include "app/base/numbered_files.h"
#include "app/commands/common/picture_world.h"
#include "app/commands/common/progress_bar.h"
#include "app/commands/common/shared.h"
#include "app/loading/world_loader.h"
#include "app/loading/world_loading.h"
#include "app/picture/animation.h"
#include "app/picture/frame_writer.h"
#include "app/picture/volume_show.h"
#include "app/session/opening/links.h"
#include "app/simulation/simulation.h"
#include "app/viewer/offscreen.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

// Command `animate`: draws pictures of simulated time, or of the files of a series, one after the other.
namespace gs::app {
namespace {

/// World from which several pictures are drawn.
class AnimatedWorld {
 public:
  explicit AnimatedWorld(const AnimateCommand& options) : options_(options) {}

  /// Opens a world. Returns an error, or nullopt. An empty error means that diagnostics were printed instead.
  std::optional<std::string> open(const std::string& file, const std::string& viewpoint) {
    show_ = nullptr;
    simulation_.reset();
    file_ = file;
    loading_.emplace(file, load_options(options_));
    LoadedWorld world = load_world(*loading_, file);
    print_diagnostics(world.diagnostics);
    if (!world.scene) return std::string();
    simulation_ = std::make_unique<Simulation>(std::move(world), glm::ivec2(options_.width, options_.height),
                                               view_style(options_));
    simulation_->fetch_with(*loading_);
    tell_of_programs(*simulation_, of_programs_);
    if (viewpoint.empty() || options_.orbit) return std::nullopt;
    return simulation_->begin_at(viewpoint);
  }
  void run(double time) { simulation_->run(time); }

  /// Returns the camera of the options, else that of the world. A turntable or tour starts there.
  [[nodiscard]] render::Camera own_camera() {
    const View& seen = simulation_->look();
    const auto asked = camera_of_options(options_, *seen.list);
    return asked ? *asked : simulation_->camera();
  }
  [[nodiscard]] const render::RenderList& list() { return *simulation_->look().list; }
  [[nodiscard]] glm::dvec3 up() { return glm::dvec3(simulation_->look().navigation.up); }

  std::variant<render::Image, std::string> paint(render::Renderer& renderer, const render::Camera& camera) {
    PictureScene scene;
    scene.camera = camera;
    scene.draw = picture_draw(options_, simulation_->look());
    scene.unit = simulation_->look().scale;
    // Collect the render list last: levels of detail and billboards depend on the camera.
    const render::RenderList& shown = simulation_->look_from(camera);
    scene.list = &shown;
    if (!show_) {
      show_ = std::make_unique<VolumeShow>();
      if (auto problem = show_->prepare(options_.volume, file_, shown, simulation_->world().color_key,
                                        std::make_shared<Budget>(options_.limits)))
        return std::move(*problem);
    }
    show_->apply(scene);
    return paint_image(renderer, scene, options_.picture);
  }

 private:
  const AnimateCommand& options_;
  std::string file_;
  std::optional<WorldLoading> loading_;
  Diagnostics of_programs_;
  std::unique_ptr<Simulation> simulation_;
  std::unique_ptr<VolumeShow> show_;
};

/// Returns the camera at each Viewpoint of a tour. Returns an error if a Viewpoint does not exist.
std::variant<std::vector<render::Camera>, std::string> tour_of(const AnimateCommand& options,
                                                               const render::RenderList& list) {
  std::vector<render::Camera> cameras;
  for (const std::string& name : options.animation.tour) {
    const auto found = find_viewpoint(list.viewpoints, name);
    if (!found) return "no Viewpoint '" + name + "'; " + viewpoint_list(list.viewpoints);
    render::Camera camera;
    camera.world_from_camera =
        world_from_viewer(pose_of(list.viewpoints[*found].world_from_camera, list.viewpoints[*found].field_of_view));
    camera.field_of_view = list.viewpoints[*found].field_of_view;
    if (options.orthographic && !list.bounds.empty())
      camera.height = fitting_height(camera, list.bounds, glm::vec2(options.width, options.height));
    cameras.push_back(camera);
  }
  return cameras;
}

int fail_unless_told(const std::string& problem) { return problem.empty() ? kFailed : fail(problem); }

}  // namespace

std::optional<std::string> check_animate(const AnimateCommand& options) {
  if (auto problem = check_camera(options)) return problem;
  return check_animation_name(options.files.back());
}

int run_animate(const AnimateCommand& given_options) {
  use_universal_time();
  AnimateCommand options = given_options;
  if (const auto problem = settle_size(options)) return fail(*problem);
  const std::string& out = options.files.back();
  if (options.picture.transparent && !numbered_name(out))
    return fail("--background transparent: expected PNG pictures, such as walk.%04d.png");
  const GivenPlace given = given_place(options.files.front());
  if (!given.problem.empty()) return fail(given.target + ": " + given.problem);
  const auto series = file_series(given.target);
  if (series && series->empty()) return fail(given.target + ": no file of this series exists");
  AnimationRequest request = options.animation;
  if (series && !request.times && !request.turntable && request.tour.empty())
    request.times = {0, static_cast<double>(series->size()) / request.rate};
  std::vector<AnimationStep> steps;
  if (const auto problem = plan_animation(request, steps)) return fail(*problem);

  AnimatedWorld world(options);
  std::size_t file = series ? series_place(steps.front().time, request.rate, series->size()) : 0;
  const std::string& viewpoint = options.viewpoint.empty() ? given.viewpoint : options.viewpoint;
  if (const auto problem = world.open(series ? (*series)[file] : given.target, viewpoint))
    return fail_unless_told(*problem);
  world.run(series ? 0 : steps.front().time);
  render::Camera camera = world.own_camera();
  const WideBox bounds = world.list().bounds;
  const glm::dvec3 center = bounds.empty() ? glm::dvec3(0) : glm::dvec3(bounds.center()), up = world.up();
  auto tour = tour_of(options, world.list());
  if (auto* problem = std::get_if<std::string>(&tour)) return fail(*problem);
  const auto& cameras = std::get<std::vector<render::Camera>>(tour);

  render::DrawOptions draw;
  draw.width = std::min(options.width, 2048);
  draw.height = std::min(options.height, 2048);
  draw.samples = options.samples;
  const OpenedRenderer opened = open_renderer(options.backend, draw);
  if (!opened.renderer) return fail(opened.problem);
  opened.context->make_current();
  auto writer = FrameWriter::open(out, {options.width, options.height}, request.rate, options.picture.dots_per_inch);
  if (auto* problem = std::get_if<std::string>(&writer)) return fail(*problem);
  FrameWriter& frames = *std::get<std::unique_ptr<FrameWriter>>(writer);

  ProgressBar progress;
  progress.whole().stage = "drawing";
  progress.whole().total = steps.size();
  std::size_t drawn = 0;
  for (const AnimationStep& step : steps) {
    if (progress.cancelled()) break;
    progress.whole().done = drawn;
    if (series) {
      const std::size_t wanted = series_place(step.time, request.rate, series->size());
      if (wanted != std::exchange(file, wanted)) {
        if (const auto problem = world.open((*series)[wanted], {})) return fail_unless_told(*problem);
        world.run(0);
      }
    } else {
      world.run(step.time);
    }
    if (step.from)
      camera = camera_between(cameras[*step.from], cameras[*step.from + 1], step.part);
    else if (!series && !request.turntable)
      camera = world.own_camera();
    // The world may move its viewer, but a turntable must always turn about the initial pose.
    auto picture =
        world.paint(*opened.renderer, request.turntable ? turned_camera(camera, center, up, step.turned) : camera);
    if (auto* problem = std::get_if<std::string>(&picture)) return fail(*problem);
    if (const auto problem = frames.add(std::get<render::Image>(picture))) return fail_to_write(*problem);
    ++drawn;
  }
  if (drawn == 0) return fail("cancelled");
  if (const auto problem = frames.finish()) return fail_to_write(*problem);
  complain("%s: %zu pictures, %s%s", out.c_str(), drawn, frames.what().c_str(),
           drawn < steps.size() ? "; cancelled before the end" : "");
  return drawn < steps.size() ? kFailed : kDone;
}

}  // namespace gs::app
