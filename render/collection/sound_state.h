#pragma once

#include "render/collection/collect_schema.h"
#include "render/scene/render_list.h"

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include <cstddef>
#include <vector>

namespace gs::render {

/// State of a Sound (VRML97 6.42). Values outside the ranges of the standard are clamped.
struct SoundState {
  const vrml::SceneGraph* scene = nullptr;
  const vrml::Node* node = nullptr;  // in `scene`
  vrml::NodeId source;               // in `scene`: the AudioClip or MovieTexture; null if none
  glm::dmat4 world_from_local{1.0};
  glm::dvec3 location{0}, direction{0, 0, 1};  // local
  double min_front = 1, min_back = 1, max_front = 10, max_back = 10;
  double intensity = 1, priority = 0;
  bool spatialize = true;
};

/// Returns the Sounds of an up-to-date list in its order, without those that have no source.
[[nodiscard]] std::vector<SoundState> sounds_of(const RenderList& list, Schemas& schemas);

}  // namespace gs::render
