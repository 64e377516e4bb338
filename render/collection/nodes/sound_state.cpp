#include "render/collection/nodes/sound_state.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <cmath>

namespace gs::render {
namespace {

glm::dvec3 vector_of(const NodeView& view, int field, const vrml::SFVec3f& otherwise) {
  const vrml::SFVec3f value = view.get(field, otherwise);
  return std::isfinite(value.x) && std::isfinite(value.y) && std::isfinite(value.z) ? glm::dvec3(value)
                                                                                    : glm::dvec3(otherwise);
}

double number_of(const NodeView& view, int field, float otherwise, double most) {
  const float value = view.get(field, otherwise);
  return std::isnan(value) ? otherwise : std::clamp(double{value}, 0.0, most);
}

}  // namespace

std::vector<SoundState> sounds_of(const RenderList& list, Schemas& schemas) {
  constexpr double kFarthest = 1e30;
  std::vector<SoundState> sounds;
  for (const SoundPlace& place : list.sounds) {
    if (!place.scene->contains(place.node) || place.frame >= list.world_from_frame.size()) continue;
    const NodeView view = schemas.view(*place.scene, place.node);
    if (view.kind() != NodeKind::sound) continue;
    SoundState sound;
    sound.scene = place.scene;
    sound.node = view.node;
    sound.source = place.scene->resolve(view.get(SoundFields::source, vrml::NodeId{}));
    if (!sound.source) continue;
    sound.world_from_local = list.world_from_frame[place.frame];
    sound.location = vector_of(view, SoundFields::location, vrml::SFVec3f(0, 0, 0));
    sound.direction = vector_of(view, SoundFields::direction, vrml::SFVec3f(0, 0, 1));
    sound.max_back = number_of(view, SoundFields::max_back, 10, kFarthest);
    sound.max_front = number_of(view, SoundFields::max_front, 10, kFarthest);
    sound.min_back = number_of(view, SoundFields::min_back, 1, kFarthest);
    sound.min_front = number_of(view, SoundFields::min_front, 1, kFarthest);
    sound.intensity = number_of(view, SoundFields::intensity, 1, 1);
    sound.priority = number_of(view, SoundFields::priority, 0, 1);
    sound.spatialize = view.get(SoundFields::spatialize, true);
    sounds.push_back(sound);
  }
  return sounds;
}

}  // namespace gs::render
