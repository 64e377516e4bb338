#pragma once

#include "app/base/world_budget.h"
#include "app/formats/content_types.h"
#include "vrml/scene/diagnostic.h"
#include "vrml/scene/scene_graph.h"

#include <cstddef>
#include <memory>
#include <span>
#include <string>

namespace gs::app {

/// The scene that a mesh's file becomes, gzip'd or not; `type` is a ContentClass::mesh. `path` is what diagnostics call
/// it; `read_file` gets the materials and buffers that belong to the format. Null when there is nothing to show; the
/// diagnostics say why. Safe for untrusted bytes; what it takes is drawn from `budget`.
[[nodiscard]] std::unique_ptr<vrml::SceneGraph> import_mesh(const ContentType& type, const std::string& path,
                                                            std::span<const std::byte> bytes,
                                                            vrml::Diagnostics& diagnostics, const ReadFile& read_file,
                                                            const WorldBudget& budget);

}  // namespace gs::app
