#pragma once

#include "app/loading/updates/loaded_world.h"
#include "vrml/scene/x3d/language.h"

#include <string>
#include <vector>

namespace gs::app {

/// Text of a scene, and the properties that it lacks, as messages for the user.
struct SceneText {
  std::string text;
  std::vector<std::string> losses;
};

/// Prints the nodes of a world for a file `target`. Textures that the world's file embeds become data: URLs. Relative
/// URLs of existing files are adapted to the folder of `target`. World's thread.
[[nodiscard]] SceneText scene_text(LoadedWorld& world, vrml::Grammar grammar, const std::string& target);

}  // namespace gs::app
