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

/// Default max number of vectors that a window draws.
inline constexpr std::size_t kWindowBudget = 2'000'000;

struct ViewerOptions {
  SessionOptions session;
  bool up_given = false;  // `session.style.up` has precedence over the setting
  int width = 1024, height = 768;  // screen units; size of the window
  bool size_given = false;  // use `width` and `height`; otherwise the size of the last window, if known
  int samples = 4;  // samples per pixel
  std::optional<glm::vec3> background;  // replaces the Backgrounds of worlds
  std::size_t budget = 0;  // max vectors in all viewports together; 0 means kWindowBudget
  VolumeWishes volume;                  // initial display of volumes
  render::SplatPath splats = render::SplatPath::automatic;
  ControlPlaces control;  // sockets at which clients can control the program
  UserFolders folders;  // paths of user data; if empty, none are stored
  std::string not_kept;  // file that is not added to the recent files
};

/// Opens a window and runs until the user quits. `load` has the options for reading worlds. Returns the exit status. It
/// is 1, with the reason in `error`, if there is no window system or no OpenGL 3.3. Main thread.
[[nodiscard]] int run_viewer(const ViewerOptions& options, const LoadOptions& load, std::string& error);

}  // namespace gs::app
