#pragma once

#include "qnv/codecs/outlines/grouping/outline_groups.h"
#include "qnv/container/outline_header.h"
#include "vrml/scene/scene_graph.h"

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace gs::app {

/// Writes a VRML97 world of outline groups (docs/formats.md). First come the outlines, the largest first, then the
/// inner polygons that replace them. Browsers without OutlineGroup show the polygons with a PROTO of this name in the
/// file. Numbers round-trip bit for bit. `viewpoint` is the text of the first nodes; it may be empty.
[[nodiscard]] std::vector<std::byte> outline_world(const qnv::OutlineGroups& groups,
                                                   std::span<const qnv::OutlineAppearance> appearances,
                                                   const std::string& title, const std::string& viewpoint = {});

/// Writes a scene of OutlineGroup nodes as a VRML97 world. The scene comes from a stream with the outlines payload.
[[nodiscard]] std::vector<std::byte> outline_world(const vrml::SceneGraph& scene, const std::string& title);

}  // namespace gs::app
