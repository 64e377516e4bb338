#pragma once

#include "app/commands/common/option_groups.h"
#include "app/saving/scene_formats.h"

#include <string>

namespace gs::app {

/// Reports whether `export` writes the nodes of a file instead of its vectors: it is a scene or a mesh, and no option
/// asks for vectors.
[[nodiscard]] bool exports_scene(const ConversionOptions& options, const std::string& in);

/// Reads a scene or a mesh and writes its nodes in another format. Does not read the files that a scene refers to.
/// Prints losses, errors and a summary. Returns the exit status.
[[nodiscard]] int export_scene(const LoadingOptions& options, const std::string& in, const std::string& out,
                               const SceneFormat& format);

}  // namespace gs::app
