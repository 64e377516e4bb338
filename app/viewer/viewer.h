#pragma once

#include "app/control/control_service.h"
#include "app/formats/common/upright.h"
#include "app/picture/volume_show.h"
#include "app/settings/user_folders.h"
#include "app/view/navigation.h"
#include "app/view/panes/split_tree.h"
#include "app/world/world_loader.h"
#include "render/draw/renderer.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace gs::app {

/// Discs that a window draws when nobody says how many.
inline constexpr std::size_t kWindowBudget = 2'000'000;

struct ViewerOptions {
  std::vector<std::string> files;       // opened at start, each in a viewport as far as there are
  std::optional<SplitTree> split;       // how they share the window; nothing: by how many there are
  int width = 1024, height = 768;       // of the window
  bool size_given = false;              // else the last window's counts, where that is known
  int samples = 4;                      // anti-aliasing
  std::optional<bool> headlight;        // in place of what the worlds say
  std::optional<glm::vec3> background;  // one colour in place of the worlds' Backgrounds
  std::string viewpoint;                // description, DEF name or number of the Viewpoint to bind
  std::size_t budget = 0;               // discs of all viewports together; 0: kWindowBudget
  std::optional<UpAxis> up;             // none: as the settings say
  bool orthographic = false;
  render::DisplayMode display = render::DisplayMode::surface;
  std::optional<Pose> camera;  // where the first file is first seen from
  VolumeWishes volume;         // how volumes are first shown
  bool muted = false;          // no sound, until it is asked for
  render::SplatPath splats = render::SplatPath::automatic;
  ControlPlaces control;  // where others may control it
  UserFolders folders;    // of what is kept of the user's; empty: nothing is
  std::string not_kept;   // a file that is not remembered
};

/// Opens a window and runs until the user quits. `load`: how worlds are read. Main thread. Returns the exit status: 0,
/// or 1 with the reason in `error` when there is no window system or no OpenGL 3.3.
[[nodiscard]] int run_viewer(const ViewerOptions& options, const LoadOptions& load, std::string& error);

}  // namespace gs::app
