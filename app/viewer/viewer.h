#pragma once

#include "app/control/control_service.h"
#include "app/loading/world_loader.h"
#include "app/picture/volume_show.h"
#include "app/session/session.h"
#include "app/settings/user_folders.h"
#include "render/draw/renderer.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace gs::app {

/// Default number of splats that a window draws.
inline constexpr std::size_t kWindowBudget = 2'000'000;

struct ViewerOptions {
  SessionOptions session;
  bool up_given = false;                // session.style.up overrides the setting
  int width = 1024, height = 768;       // of the window
  bool size_given = false;              // otherwise the size of the last window is used, if known
  int samples = 4;                      // anti-aliasing
  std::optional<glm::vec3> background;  // colour that replaces the worlds' Backgrounds
  std::size_t budget = 0;               // splats of all viewports together; 0 means kWindowBudget
  VolumeWishes volume;                  // initial display of volumes
  render::SplatPath splats = render::SplatPath::automatic;
  ControlPlaces control;  // sockets on which clients can control it
  UserFolders folders;    // of the user data; if empty, none is stored
  std::string not_kept;   // file that is not remembered
};

/// Opens a window and runs until the user quits. `load` has the options for reading worlds. Returns the exit status: 0,
/// or 1 with the reason in `error` if there is no window system or no OpenGL 3.3. Main thread.
[[nodiscard]] int run_viewer(const ViewerOptions& options, const LoadOptions& load, std::string& error);

}  // namespace gs::app
