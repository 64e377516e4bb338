#pragma once

#include "render/scene/render_list.h"
#include "render/volume/volume_model.h"

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include <vector>

namespace gs::render {

/// Returns the lights of a volume with the centre `center`, in camera space: up to four lights of the world, and the
/// headlight. Directional lights come first, then the point and spot lights that are strongest at the centre. Without
/// lights, returns one light that has no effect.
[[nodiscard]] std::vector<VolumeLight> volume_lights(const RenderList& list, const SplatItem& item,
                                                     const glm::dmat4& camera_from_world, const glm::vec3& center,
                                                     bool headlight);

}  // namespace gs::render
