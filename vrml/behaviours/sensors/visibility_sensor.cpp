#include "vrml/events/execution.h"

#include <glm/glm.hpp>

#include <array>
#include <cmath>

namespace gs::vrml {
namespace {

struct Visibility {
  enum : int { center, size, enabled, is_active, enter_time, exit_time };
};

// Reports whether the box may be visible: for each plane of the frustum, a part of the box is inside. May return true
// for boxes near the frustum's edges, as 6.54 permits. There is no far plane.
bool may_be_seen(const glm::dvec3& center, const glm::dvec3& half, const glm::dmat4& viewer_from_sensor,
                 const Frustum& sees) {
  // Normals of the planes: right, left, top, bottom, front. Distances >= 0 are inside.
  const std::array<glm::dvec3, 5> planes = {glm::dvec3(-1, 0, -sees.right), glm::dvec3(1, 0, -sees.right),
                                            glm::dvec3(0, -1, -sees.up), glm::dvec3(0, 1, -sees.up),
                                            glm::dvec3(0, 0, -1)};
  for (const glm::dvec3& plane : planes) {
    bool outside = true;  // stays false if a number is NaN
    for (int corner = 0; corner < 8; ++corner) {
      const glm::dvec3 sides(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
      const glm::dvec3 point(viewer_from_sensor * glm::dvec4(center + half * sides, 1));
      outside = outside && glm::dot(plane, point) < 0;
    }
    if (outside) return false;
  }
  return true;
}

bool visible(Execution& execution, EventNode node) {
  const glm::dvec3 center(execution.get<SFVec3f>(node, Visibility::center)),
      half = glm::dvec3(execution.get<SFVec3f>(node, Visibility::size)) * 0.5;
  // Rejects numbers that are not finite, and negative sizes, which the standard forbids. A box without volume is valid.
  if (!(half.x >= 0 && half.y >= 0 && half.z >= 0) || !std::isfinite(glm::dot(center, half) * 0.0)) return false;
  const glm::dmat4 viewer_from_world = glm::inverse(execution.viewer().pose());
  const Frustum sees = execution.viewer().frustum();
  for (const glm::dmat4& world_from_sensor : execution.viewer().places_of(node))
    if (may_be_seen(center, half, viewer_from_world * world_from_sensor, sees)) return true;
  return false;
}

void visibility_time(Execution& execution, EventNode node) {
  const bool enabled = execution.get<SFBool>(node, Visibility::enabled);
  const bool active = execution.get<SFBool>(node, Visibility::is_active);
  const bool seen = enabled && visible(execution, node);
  if (seen != active && !execution.has_sent(node, Visibility::is_active)) {
    execution.send(node, Visibility::is_active, SFBool{seen});
    execution.send(node, seen ? Visibility::enter_time : Visibility::exit_time, SFTime{execution.now()});
  }
  execution.timers().run(node, enabled || execution.get<SFBool>(node, Visibility::is_active));
}

bool visibility_event(Execution& execution, EventNode node, int, const FieldValue&) {
  execution.timers().look_again(node);
  return true;
}

}  // namespace

const Behaviour kVisibilitySensorBehaviour = {
    .events = {"center", "size", "enabled", "isActive", "enterTime", "exitTime"},
    .initialize = [](Execution& execution, EventNode node) { execution.timers().look_again(node); },
    .on_event = visibility_event,
    .on_time = visibility_time,
};

}  // namespace gs::vrml
