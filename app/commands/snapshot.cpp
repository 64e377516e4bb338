#include "app/base/console.h"
#include "app/base/temporary_file.h"
#include "app/commands/common/picture_memory.h"
#include "app/commands/common/picture_world.h"
#include "app/commands/common/shared.h"
#include "app/commands/common/streamed_parts.h"
#include "app/commands/open.h"
#include "app/loading/updates/limit_report.h"
#include "app/loading/world_loader.h"
#include "app/loading/world_loading.h"
#include "app/media/wave_file.h"
#include "app/picture/paint.h"
#include "app/picture/volume_show.h"
#include "app/session/opening/links.h"
#include "app/simulation/simulation.h"
#include "app/view/navigation.h"
#include "app/viewer/offscreen.h"
#include "base/json_value.h"
#include "net/files/file.h"
#include "render/draw/renderer.h"
#include "render/gl/context.h"
#include "render/scene/camera.h"
#include "render/scene/render_list.h"
#include "vrml/scene/scene_graph.h"

#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <future>
#include <memory>
#include <optional>
#include <span>
#include <system_error>
#include <unordered_set>
#include <utility>
#include <variant>

namespace gs::app {
namespace {

using Clock = std::chrono::steady_clock;

// Minimum size of a world in bytes for which the memory of the driver's compiler is freed. That takes 5 ms.
constexpr std::size_t kLargeWorld = 16 << 20;
constexpr int kMaxAtFirst = 2048;  // max width and height in pixels of a band; the driver prepares for it

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

double seconds_now() { return std::chrono::duration<double>(Clock::now().time_since_epoch()).count(); }

/// Returns the processor time that the program has used so far. Most of it is dynamic linking, which never waits.
double seconds_so_far() {
  timespec used{};
  return clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &used) == 0
             ? static_cast<double>(used.tv_sec) + static_cast<double>(used.tv_nsec) * 1e-9
             : 0;
}

/// Adds the durations of all phases so far, in seconds. `total_s` is their sum.
void add_phases(PhaseClock& phases, JsonValue& stats) {
  phases.enter(Phase::other);
  for (std::size_t i = 0; i < kPhaseNames.size(); ++i)
    stats.put(std::string(kPhaseNames[i]) + "_s", phases.seconds(static_cast<Phase>(i)));
  stats.put("total_s", phases.total());
}

// Returns true if `path` may be written. Only pictures are replaced, so that a wrong OUT.png does not destroy a world.
bool may_write(const std::string& path, const std::string& world) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) return true;
  if (std::filesystem::equivalent(path, world, error)) return false;
  const auto opened = net::map_file(path);
  const auto* file = std::get_if<net::MappedFile>(&opened);
  if (!file) return false;
  static constexpr unsigned char kPng[] = {0x89, 'P', 'N', 'G'};
  return file->bytes().empty() || (file->bytes().size() >= 4 && std::memcmp(file->bytes().data(), kPng, 4) == 0);
}

// Counter of the different colours in a picture. A blank picture has only one.
class ColorCount {
 public:
  void add(const render::Image& image) {
    constexpr std::size_t kEnough = 65536;
    for (std::size_t i = 0; i + 2 < image.pixels.size() && seen_.size() < kEnough; i += image.components)
      seen_.insert(static_cast<std::uint32_t>(image.pixels[i]) << 16 |
                   static_cast<std::uint32_t>(image.pixels[i + 1]) << 8 | image.pixels[i + 2]);
  }
  [[nodiscard]] std::size_t count() const { return seen_.size(); }

 private:
  std::unordered_set<std::uint32_t> seen_;
};

// Time limit of drawing. A world of two kilobytes can request more pixels than a software rasteriser draws in a day. A
// frame cannot be interrupted, so at the limit the program prints one line and exits.

extern "C" void give_up(int) {
  static constexpr char kMessage[] = "ghostspace: error: drawing exceeded --timeout\n";
  (void)!write(STDERR_FILENO, kMessage, sizeof kMessage - 1);
  _exit(kFailed);
}

// Starts the time limit of drawing. 0 seconds ends it.
void limit_drawing(double timeout_seconds) {
  const double seconds = std::min(timeout_seconds, 1e6);
  std::signal(SIGALRM, give_up);
  itimerval timer{};
  timer.it_value.tv_sec = static_cast<time_t>(seconds);
  timer.it_value.tv_usec = static_cast<suseconds_t>((seconds - std::floor(seconds)) * 999'999);
  setitimer(ITIMER_REAL, &timer, nullptr);
}

/// Exits after the picture was written, without calling destructors. Destroying a large world and the driver would take
/// a tenth of the total time. With leak checkers, destructors run. Temporary files are always removed.
int leave(std::optional<WorldLoading>& loading, int status) {
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  loading.reset();
  remove_temporary_files();
  (void)std::fflush(nullptr);
  std::_Exit(status);
#else
  (void)loading;
  return status;
#endif
}

}  // namespace

int run_snapshot(const OpenCommand& given_options, const std::string& named) {
  keep_memory();
  use_universal_time();
  OpenCommand options = given_options;
  if (const auto problem = settle_size(options)) return fail(*problem);
  GivenPlace given = given_place(named);
  if (!given.problem.empty()) return fail(given.target + ": " + given.problem);
  if (const auto problem = settle_series(options, options.time, given.target)) return fail(*problem);
  const std::string& file = given.target;
  const Clock::time_point start = Clock::now();
  PhaseClock phases(seconds_now, seconds_now() - seconds_so_far());
  PhaseClock* const measured = options.stats.empty() ? nullptr : &phases;
  LoadOptions load = load_options(options);
  load.phases = measured;
  load.large_by_view = load.one_step = true;
  if (options.backend == "glfw")
    return fail("--backend glfw needs a window; expected auto, egl or osmesa with --snapshot");
  // A confined process must not use drivers and devices, so it draws on the software path.
  const bool confined = !options.confine.empty() && options.backend == "auto";
  render::DrawOptions first_part;
  first_part.width = std::min(options.width, kMaxAtFirst);
  first_part.height = std::min(options.height, kMaxAtFirst);
  first_part.samples = options.samples;
  // Start the driver while the world is read.
  std::future<OpenedRenderer> opening =
      std::async(std::launch::async, open_renderer, confined ? "osmesa" : options.backend, first_part);
  phases.enter(Phase::read);
  std::optional<WorldLoading> loading(std::in_place, file, load);
  LoadedWorld world = load_world(*loading, file);
  phases.enter(Phase::other);
  const double load_seconds = seconds_since(start);
  print_diagnostics(world.diagnostics);
  const std::size_t warnings = world.diagnostics.warnings(), errors = world.diagnostics.errors();
  if (!world.scene) return kFailed;
  const bool large = world.bytes > kLargeWorld;
  Diagnostics of_programs;
  Simulation simulation(std::move(world), {options.width, options.height}, view_style(options));
  simulation.fetch_with(*loading);
  tell_of_programs(simulation, of_programs);
  simulation.measure(measured);
  if (!options.viewpoint.empty() && !options.orbit)
    if (const auto problem = simulation.begin_at(options.viewpoint)) return fail(*problem);
  if (!given.viewpoint.empty() && options.viewpoint.empty() && !options.orbit)
    if (const auto problem = simulation.begin_at(given.viewpoint))
      complain("%s: warning: %s", file.c_str(), problem->c_str());
  if (!plan_input(options, simulation)) return kFailed;
  if (!may_write(options.snapshot, file))
    return fail(options.snapshot + " already exists and is not a PNG picture; not overwritten");

  limit_drawing(options.timeout_seconds);
  WaveFile sound;
  if (!options.sound.empty()) simulation.hear([&](std::span<const float> pairs) { sound.add(pairs); });
  // A still picture of the start shows particles, fire and smoke for example, as they are after a while.
  simulation.execution().states().particles_ahead = options.time == 0;
  simulation.run(options.time);
  if (const int status = write_sound(options, sound); status != kDone) return status;
  tell_of_simulation(options, named, simulation);
  const auto asked = camera_of_options(options, *simulation.look().list);
  const render::Camera camera = asked ? *asked : simulation.camera();
  simulation.stand_at(camera);
  const render::DrawOptions draw = picture_draw(options, simulation.look());
  const double unit = simulation.look().scale;
  // The camera is final only here. Levels of detail and billboards depend on it.
  const render::RenderList* list = &simulation.look_from(camera);
  if (options.display != render::DisplayMode::surface && !has_faces(*list))
    complain("%s: warning: splats and volumes have no faces; --display has no effect", file.c_str());
  Diagnostics limits;
  report_limits(*list, limits);
  print_diagnostics(limits);

  release_lists(*simulation.world().scene);
  phases.enter(Phase::compile);
  const OpenedRenderer opened = opening.get();
  if (large) render::release_driver_code();
  if (!opened.renderer) return fail(opened.problem);
  render::GlContext& context = *opened.context;
  context.make_current();
  render::Renderer& renderer = *opened.renderer;
  renderer.measure(measured);
  phases.enter(Phase::other);
  render::FrameStatistics statistics;
  phases.enter(Phase::draw);
  ColorCount colors;
  PictureScene scene{list, camera, draw, unit, {}, measured};
  if (!options.stats.empty()) scene.over = [&](render::Image& band, int, const glm::ivec2&) { colors.add(band); };
  VolumeShow volume;
  const auto prepare = [&] {
    scene.draw.splat_style.reading = volume.reading(options.volume, *list);
    // Streams that are larger than memory decode, and servers send, what the picture shows.
    limit_drawing(0);
    receive_for_picture(
        *loading, simulation.world(), options.timeout_seconds,
        [&] {
          limit_drawing(options.timeout_seconds);
          (void)paint_image(renderer, scene, options.picture);
          limit_drawing(0);
        },
        [&](ResourceUpdates updates) {
          print_diagnostics(updates.diagnostics);
          simulation.arrive(std::move(updates));
          scene.list = list = &simulation.look_from(camera);
        });
    limit_drawing(options.timeout_seconds);
    return volume.prepare(options.volume, file, *list, simulation.world().color_key,
                          std::make_shared<Budget>(options.limits));
  };
  if (const auto problem = prepare()) return fail(*problem);
  // The slices of such a stream have a place only now, and get finer values for it.
  const bool shows_values = !options.volume.slices.empty() || options.volume.display.needs_values();
  if (shows_values && detail_revision(*list) > 0) {
    scene.draw.splat_style.reading = volume.reading(options.volume, *list);
    if (!loading->streaming()) (void)paint_image(renderer, scene, options.picture);
    if (const auto problem = prepare()) return fail(*problem);
  }
  volume.apply(scene);
  auto picture = paint_png(renderer, scene, options.picture, &statistics, [&](double) {
    limit_drawing(options.timeout_seconds);  // start again for each band of a large picture
    return true;
  });
  if (auto* problem = std::get_if<std::string>(&picture)) return fail(*problem);
  limit_drawing(0);
  const double first_image_seconds = seconds_since(start);
  phases.enter(Phase::write);
  if (const auto problem = net::write_file_atomically(options.snapshot, std::get<std::vector<std::byte>>(picture)))
    return fail_to_write(options.snapshot + ": " + problem->message);

  if (!options.stats.empty()) {
    JsonValue stats;
    add_phases(phases, stats);
    const Clock::time_point again = Clock::now();
    (void)paint_image(renderer, scene, options.picture);
    stats.put("bytes", simulation.world().received());
    stats.put("load_s", load_seconds);
    stats.put("first_image_s", first_image_seconds);
    stats.put("frame_s", seconds_since(again));
    stats.put("triangles", statistics.triangles);
    stats.put("vectors", statistics.vectors);
    stats.put("items", statistics.items);
    stats.put("draw_calls", statistics.draw_calls);
    stats.put("colors", colors.count());
    stats.put("peak_rss_bytes", peak_memory());
    stats.put("backend", std::string(context.backend()));
    stats.put("renderer", renderer.gl_renderer());
    stats.put("splats", statistics.splats);
    stats.put("errors", errors + limits.errors() + of_programs.errors());
    stats.put("warnings", warnings + of_programs.warnings());
    if (const int status = write_stats(options.stats, stats.json()); status != kDone) return status;
  }
  return leave(loading, simulation.world().truncated ? kFailed : kDone);
}

}  // namespace gs::app
