#pragma once

#include "app/base/read_file.h"
#include "base/diagnostic.h"
#include "vrml/scene/scene_graph.h"

#include <cstddef>
#include <span>

namespace gs::app {

/// Imports a glTF 2.0 asset, .gltf or .glb, into `scene`. Nodes become Transforms; primitives become Shapes with
/// IndexedFaceSet, IndexedLineSet or PointSet; perspective cameras become Viewpoints.
///
/// Materials are approximated in VRML97: base colour (converted from linear light), metal and roughness as a highlight,
/// emission, and opacity. The base colour texture becomes an ImageTexture; embedded images get a data: URL. Skinned
/// meshes have the pose of the nodes. Animations, morph targets, lights and other textures are ignored. Each
/// Draco-compressed primitive gives an error.
///
/// External buffers come only from `read_file`. Safe for untrusted input: it checks what tinygltf does not, and memory
/// is bounded by a multiple of the file size.
void import_gltf(std::span<const std::byte> bytes, vrml::SceneGraph& scene, Diagnostics& diagnostics,
                 const ReadFile& read_file = {});

}  // namespace gs::app
