#pragma once

#include "qnv/outline/outline_groups.h"
#include "qnv/stream/outline_header.h"
#include "vrml/scene/scene_graph.h"

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace gs::app {

/// A VRML97 world of outline groups (docs/formats.md): outlines first, largest first, then the polygons that take their
/// place. Browsers that do not know OutlineGroup show the polygons, by the PROTO of that name that stands in it.
/// Numbers are written so that they read back bit for bit. `viewpoint`: the text of nodes that stand before them; may be
/// empty.
[[nodiscard]] std::vector<std::byte> outline_world(const qnv::OutlineGroups& groups,
                                                   std::span<const qnv::OutlineAppearance> appearances,
                                                   const std::string& title, const std::string& viewpoint = {});

/// A scene of OutlineGroup nodes, as a stream of outlines gives it, as such a world.
[[nodiscard]] std::vector<std::byte> outline_world(const vrml::SceneGraph& scene, const std::string& title);

}  // namespace gs::app
