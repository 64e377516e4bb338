#pragma once

#include "app/base/read_file.h"
#include "base/diagnostic.h"
#include "vrml/scene/scene_graph.h"

#include <cstddef>
#include <span>

namespace gs::app {

/// Version of X3D scenes of glTF: the first one with physical materials.
inline constexpr int kX3DVersionOfGltf = 40;

/// Imports a glTF 2.0 asset, .gltf or .glb, into `scene`. Nodes become Transforms. Primitives become Shapes with
/// IndexedFaceSet, IndexedLineSet or PointSet. Perspective cameras become Viewpoints.
///
/// VRML97 materials approximate those of glTF: base colour (converted from linear light), metal and roughness as a
/// highlight, emission, and opacity. The base colour texture becomes an ImageTexture; embedded images get a data: URL.
/// Skinned meshes are in the pose of the file. Animations, morph targets, lights and other textures are ignored. Each
/// Draco-compressed primitive gives an error.
///
/// Only `read_file` opens external buffers. Safe for untrusted input, including input that tinygltf does not check.
/// Memory is bounded by a multiple of the file size.
void import_gltf(std::span<const std::byte> bytes, vrml::SceneGraph& scene, Diagnostics& diagnostics,
                 const ReadFile& read_file = {});

}  // namespace gs::app
