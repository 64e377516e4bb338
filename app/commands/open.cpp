#include "app/commands/open.h"

#include "app/base/console.h"
#include "app/commands/common/picture_world.h"
#include "app/commands/common/shared.h"
#include "app/desktop/hand_over.h"
#include "app/loading/world_loader.h"
#include "app/picture/volume_show.h"
#include "app/settings/user_folders.h"
#include "app/viewer/headless.h"
#include "app/viewer/viewer.h"

#include <atomic>

namespace gs::app {
namespace {

constexpr double kNoTimeout = 1e6;  // seconds; longer than any loading

}  // namespace

std::optional<std::string> check_open(const OpenCommand& options) {
  const bool window = options.snapshot.empty();
  if (!window && options.files.size() > 1) return "--snapshot: expected one file";
  const bool shows_step = options.time > 0 && !options.files.empty() &&
                          (options.files.front().ends_with(".qnv") || has_volume_values(options.files.front()));
  if (window && ((options.time > 0 && !shows_step) || !options.input.empty() || options.press_sensors))
    return "--time, --input and --press-sensors: expected with --snapshot";
  if (!window && options.control.any()) return "--control: expected without --snapshot; clients can request pictures";
  if (!options.control.any() && !options.control.token_file.empty()) return "--control-token: expected with --control";
  if (window && !options.confine.empty()) return "--confine: a window needs wider access; expected --snapshot";
  if (const auto problem = check_camera(options)) return "open: " + *problem;
  const PictureRequest& picture = options.picture;
  const bool of_picture = picture.transparent || picture.stereo != render::Stereo::none || picture.eye_distance > 0 ||
                          picture.dots_per_inch > 0 || options.paper;
  if (window && of_picture)
    return "open: --background transparent, --stereo, --eye-distance, --dpi and paper sizes need --snapshot";
  return std::nullopt;
}

int run_open(const OpenCommand& options) {
  const std::string first = options.files.empty() ? demo_world() : options.files.front();
  if (!options.snapshot.empty()) return run_snapshot(options, first);
  if (options.reuse && hand_over(hand_over_folder(), options.files)) return kDone;
  ViewerOptions viewer;
  viewer.session.files = options.files.empty() ? std::vector<std::string>{first} : options.files;
  viewer.session.split = options.layout;
  viewer.session.viewpoint = options.viewpoint;
  viewer.session.headlight = options.headlight;
  viewer.session.audible = true;
  viewer.session.muted = options.muted;
  viewer.session.style = view_style(options);
  viewer.session.camera = options.camera;
  viewer.up_given = options.up.has_value();
  viewer.width = options.width;
  viewer.height = options.height;
  viewer.size_given = options.size_given;
  viewer.samples = options.samples;
  viewer.background = options.background;
  viewer.budget = options.budget;
  viewer.volume = options.volume;
  viewer.splats = options.splats;
  viewer.control = options.control;
  if (!options.no_config && !viewer.control.any() && options.confine.empty())
    viewer.folders = user_folders(options.config);
  if (options.files.empty()) viewer.not_kept = first;
  LoadOptions load = load_options(options);
  // A window shows the progress and lets the user cancel, so there is no default time limit.
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
