#pragma once

#include "app/formats/content_types.h"
#include "base/budget.h"
#include "base/diagnostic.h"
#include "vrml/scene/scene_graph.h"

#include <cstddef>
#include <memory>
#include <span>
#include <string>

namespace gs::app {

/// Imports a mesh file, gzip-compressed or not; `type` is a ContentClass::mesh. `path` is its name in diagnostics.
/// `read_file` provides material and buffer files. Returns null if there is nothing to show; the diagnostics say why.
/// Safe for untrusted input; memory is charged to `budget`.
[[nodiscard]] std::unique_ptr<vrml::SceneGraph> import_mesh(const ContentType& type, const std::string& path,
                                                            std::span<const std::byte> bytes, Diagnostics& diagnostics,
                                                            const ReadFile& read_file, const WorldBudget& budget);

}  // namespace gs::app
