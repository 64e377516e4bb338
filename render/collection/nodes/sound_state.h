#pragma once

#include "render/collection/nodes/collect_schema.h"
#include "render/scene/render_list.h"

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include <cstddef>
#include <vector>

namespace gs::render {

/// State of a Sound (VRML97 6.42), with values clamped to the ranges of the standard.
struct SoundState {
  const vrml::SceneGraph* scene = nullptr;
  const vrml::Node* node = nullptr;  // Sound node in `scene`
  vrml::NodeId source;               // id in `scene` of the AudioClip or MovieTexture
  glm::dmat4 world_from_local{1.0};
  glm::dvec3 location{0}, direction{0, 0, 1};  // in the Sound's coordinate system
  double min_front = 1, min_back = 1, max_front = 10, max_back = 10;
  double intensity = 1, priority = 0;
  bool spatialize = true;
};

/// Returns the Sounds of a list, in its order. Omits Sounds without a source. The list must be up to date.
[[nodiscard]] std::vector<SoundState> sounds_of(const RenderList& list, Schemas& schemas);

}  // namespace gs::render
