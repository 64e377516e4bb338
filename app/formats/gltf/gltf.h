#pragma once

#include "app/base/read_file.h"
#include "vrml/scene/diagnostic.h"
#include "vrml/scene/scene_graph.h"

#include <cstddef>
#include <span>

namespace gs::app {

/// Adds the scene of a glTF 2.0 asset, .gltf or .glb, to `scene`: nodes become Transforms, primitives Shapes
/// with IndexedFaceSet, IndexedLineSet or PointSet, perspective cameras Viewpoints. Materials are the nearest
/// ones that VRML97 has: base colour (linear light becomes display colour), metal and roughness as a highlight,
/// emission, opacity, the base colour texture as an ImageTexture whose url is that of the image or, for
/// embedded ones, a data: URL. Skinned meshes stand in the pose that the nodes have; animations, morph
/// targets, lights and other textures are left out. Draco-compressed primitives give an error each.
/// External buffers come through `read_file` and from nowhere else. Safe for untrusted input: what tinygltf
/// does not check is checked here, and memory is bounded by a multiple of the file.
void import_gltf(std::span<const std::byte> bytes, vrml::SceneGraph& scene, vrml::Diagnostics& diagnostics,
                 const ReadFile& read_file = {});

}  // namespace gs::app
