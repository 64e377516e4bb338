#pragma once

#include "render/collection/nodes/collect_schema.h"
#include "render/scene/layered_material.h"

namespace gs::render {

/// Returns the sampling of a texture node: TextureProperties, or repeatS, repeatT and repeatR.
[[nodiscard]] Sampling sampling_of(Schemas& schemas, const vrml::SceneGraph& scene, const NodeView& texture);
/// Reports whether a texture node has TextureProperties.
[[nodiscard]] bool has_properties(const vrml::SceneGraph& scene, const NodeView& texture);

}  // namespace gs::render
