#pragma once

#include "qnv/codecs/outlines/grouping/outline_groups.h"
#include "qnv/container/outline_header.h"
#include "vrml/scene/scene_graph.h"

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace gs::app {

/// Writes a VRML97 world of outline groups (docs/formats.md): outlines first, largest first, then the polygons that
/// replace them. Browsers without OutlineGroup show the polygons through a PROTO of that name in the file. Numbers
/// round-trip bit for bit. `viewpoint` is the text of nodes to put first; may be empty.
[[nodiscard]] std::vector<std::byte> outline_world(const qnv::OutlineGroups& groups,
                                                   std::span<const qnv::OutlineAppearance> appearances,
                                                   const std::string& title, const std::string& viewpoint = {});

/// Writes a scene of OutlineGroup nodes, from an outlines stream, as such a world.
[[nodiscard]] std::vector<std::byte> outline_world(const vrml::SceneGraph& scene, const std::string& title);

}  // namespace gs::app
