#pragma once

#include "app/formats/splats/splat_edit.h"
#include "app/session/documents/splat_edits.h"

#include <glm/vec2.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace gs::app {

/// Gaussian splats in the active viewport, and their edit.
struct UiSplats {
  bool editable = false;  // the file consists of splats
  SplatEdit edit;
  SplatExtent extent;  // of the unedited splats
  SplatsRemoved removed;
  std::size_t shown = 0;  // number of splats in the picture
  bool busy = false;      // the picture does not show the present edit yet
  std::string problem;    // reason why the edit cannot be shown; empty if it can
  std::string command;    // command line that makes the edited file, for copying
  /// Outlines of the crops, in framebuffer pixels.
  std::vector<std::pair<glm::vec2, glm::vec2>> edges;
};

/// Requests of the user for splats in this frame.
struct UiSplatActions {
  std::optional<SplatEdit> edit;
  std::uint64_t gesture = 0;  // changes of one gesture are undone together
};

}  // namespace gs::app
