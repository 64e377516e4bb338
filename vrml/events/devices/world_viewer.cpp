#include "vrml/events/world_viewer.h"

#include "vrml/events/execution.h"
#include "vrml/scene/values/transformation.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace gs::vrml {

void WorldViewer::set(const glm::dmat4& world_from_viewer, const std::optional<Frustum>& sees) {
  if (!world_from_viewer_ || std::exchange(jump_ahead_, false)) ++jumps_;
  world_from_viewer_ = world_from_viewer;
  frustum_ = sees;
}

void WorldViewer::jump() {
  ++jumps_;
  jump_ahead_ = is_set();
  execution_.timers().look_again_at_running();
}

glm::dmat4 WorldViewer::pose() {
  if (world_from_viewer_) return *world_from_viewer_;
  const int active = execution_.stacks().active_layer();
  for (const BindableStacks::Stack& stack : execution_.stacks().all()) {
    if (stack.top == 0 || stack.layer != active || !stack.type->behaviour->parent_from_local) continue;
    const EventMember& top = execution_.nodes()[stack.top];
    glm::dmat4 matrix = execution_.nodes().behaviour_of(stack.top).parent_from_local(*top.scene, *top.node);
    // A Billboard above the Viewpoint would turn towards itself. It counts as not rotated.
    if (const auto places = execution_.placement().places_of(*top.scene, top.id); !places.empty())
      matrix = places.front() * matrix;
    return matrix;
  }
  return viewer_matrix({0, 0, 10}, {});
}

std::span<const glm::dmat4> WorldViewer::places_of(EventNode node) {
  const EventMember& at = execution_.nodes()[node];
  const std::span<const glm::dmat4> unturned = execution_.placement().places_of(*at.scene, at.id);
  if (!execution_.placement().below_billboard()) return unturned;
  const glm::dmat4 from = pose();
  return execution_.placement().places_of(*at.scene, at.id, from);
}

Frustum WorldViewer::frustum() const {
  if (world_from_viewer_ && frustum_) return *frustum_;
  constexpr double kDefault = 0.785398, kWidest = 3.13;
  double angle = kDefault;
  const int active = execution_.stacks().active_layer();
  for (const BindableStacks::Stack& stack : execution_.stacks().all())
    if (stack.top != 0 && stack.layer == active && stack.type->behaviour->parent_from_local &&
        execution_.nodes().has_event(stack.top, kFieldOfView))
      if (const auto* given = std::get_if<SFFloat>(&execution_.nodes().value_of(stack.top, kFieldOfView)))
        angle = *given;  // an OrthoViewpoint has a rectangle instead
  const double smaller = std::tan((angle > 0 ? std::min(angle, kWidest) : kDefault) / 2);
  const double aspect = aspect_ > 0 && std::isfinite(aspect_) ? aspect_ : 1;
  return aspect >= 1 ? Frustum{smaller * aspect, smaller} : Frustum{smaller, smaller / aspect};
}

}  // namespace gs::vrml
