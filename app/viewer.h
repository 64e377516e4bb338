#pragma once

#include "app/opened_world.h"

#include <glm/vec3.hpp>

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace gs::app {

/// Reads a world. Called on a worker thread; must not touch anything that the main thread owns.
using OpenFunction = std::function<OpenedWorld(const std::string& path)>;

struct ViewerOptions {
  std::vector<std::string> files;       // opened at start; the first is shown
  int width = 1024, height = 768;       // of the window
  int samples = 4;                      // anti-aliasing
  std::optional<bool> headlight;        // in place of what the worlds say
  std::optional<glm::vec3> background;  // one colour in place of the worlds' Backgrounds
  std::string viewpoint;                // description, DEF name or number of the Viewpoint to bind
};

/// Opens a window and runs until the user quits. Main thread. Returns the exit status: 0, or 1 with the
/// reason in `error` when there is no window system or no OpenGL 3.3.
[[nodiscard]] int run_viewer(const ViewerOptions& options, const OpenFunction& open, std::string& error);

}  // namespace gs::app
