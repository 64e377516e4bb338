#include "app/base/console.h"
#include "app/commands/options/commands.h"
#include "app/commands/options/options.h"
#include "app/commands/options/shared.h"
#include "app/commands/picture_world.h"
#include "app/settings/user_folders.h"
#include "app/viewer/hand_over.h"
#include "app/viewer/headless.h"
#include "app/viewer/viewer.h"
#include "app/world/world_loader.h"

#include <atomic>

namespace gs::app {
namespace {

constexpr double kNoTimeout = 1e6;  // seconds

}  // namespace

std::optional<std::string> check_open(const Options& options) {
  if (auto problem = check_camera(options)) return problem;
  const PictureRequest& picture = options.picture;
  const bool of_picture = picture.transparent || picture.stereo != render::Stereo::none || picture.eye_distance > 0 ||
                          picture.dots_per_inch > 0 || picture.paper;
  if (of_picture && options.snapshot.empty())
    return "--background transparent, --stereo, --eye-distance, --dpi and paper sizes need --snapshot";
  return std::nullopt;
}

int run_open(const Options& options) {
  const std::string first = options.files.empty() ? demo_world() : options.files.front();
  if (!options.snapshot.empty()) return run_snapshot(options, first);
  if (options.reuse && hand_over(hand_over_folder(), options.files)) return kDone;
  ViewerOptions viewer;
  viewer.files = options.files.empty() ? std::vector<std::string>{first} : options.files;
  viewer.width = options.width;
  viewer.height = options.height;
  viewer.samples = options.samples;
  viewer.headlight = options.headlight;
  viewer.background = options.background;
  viewer.viewpoint = options.viewpoint;
  viewer.up = options.up;
  viewer.orthographic = options.orthographic;
  viewer.display = options.display;
  viewer.camera = options.camera;
  viewer.volume = volume_wishes(options);
  viewer.split = options.layout;
  viewer.muted = options.muted;
  viewer.budget = options.budget;
  viewer.splats = splat_path(options.splats);
  viewer.control = {options.control_paths, options.control_ports, options.control_token};
  if (!options.no_config && !viewer.control.any() && options.confine.empty())
    viewer.folders = user_folders(options.config);
  viewer.size_given = options.size_given;
  if (options.files.empty()) viewer.not_kept = first;
  LoadOptions load = load_options(options);
  // In a window, the user sees the progress and can cancel, so there is no default timeout.
  load.timeout_seconds = options.timeout_given ? options.timeout_seconds : kNoTimeout;
  load.by_view = true;
  std::string error;
  const bool windowless = options.backend == "osmesa" || options.backend == "egl";
  if (windowless && viewer.control.any()) {
    const int status = run_headless(viewer, load, options.backend, error);
    return status == kDone ? kDone : fail(error);
  }
  const int status = run_viewer(viewer, load, error);
  if (status != kDone)
    complain(
        "ghostspace: error: %s; without a window use ghostspace --snapshot OUT.png FILE, or ghostspace --backend "
        "osmesa --control PATH",
        error.c_str());
  return status;
}

}  // namespace gs::app
