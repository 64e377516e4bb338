#include "vrml/behaviours/animation/rotations.h"
#include "vrml/events/execution.h"
#include "vrml/mesh/mesh_contacts.h"

#include <glm/glm.hpp>

#include <cmath>
#include <optional>

namespace gs::vrml {
namespace {

struct Watch {
  enum : int { center, size, enabled, target, is_active, enter_time, exit_time, position, orientation };
};

// Returns sensor_from_target if the box around the target meets the box of the sensor (X3D 22.4.2). Of several
// instances, the first ones count.
std::optional<glm::dmat4> watched(Execution& execution, EventNode node) {
  const glm::vec3 size = execution.get<SFVec3f>(node, Watch::size),
                  center = execution.get<SFVec3f>(node, Watch::center);
  const bool everywhere = size == glm::vec3(-1);
  if (!execution.get<SFBool>(node, Watch::enabled) || (!everywhere && !(size.x > 0 && size.y > 0 && size.z > 0)))
    return std::nullopt;
  const NodePlace place = execution.nodes().place_of(node);
  PlacedShapes& shapes = execution.shapes();
  const auto nodes = shapes.nodes();
  if (!execution.budget().spend(nodes.size())) return std::nullopt;
  const NodeId object = place.scene->resolve(execution.get<SFNode>(node, Watch::target));
  const std::size_t own = shapes.find(*place.scene, place.node), target = shapes.find(*place.scene, object);
  if (own == 0 || target == 0) return std::nullopt;
  const glm::dmat4 sensor_from_world = glm::inverse(nodes[own].world_from_parent);
  WideBox bounds;
  for (std::size_t i = target; i < nodes.size() && (i == target || shapes.is_below(i, *place.scene, object)); ++i)
    if (nodes[i].shape && execution.budget().spend(EventBudget::kDelivery))
      bounds.add(box_of(shapes.mesh_of(*nodes[i].scene, geometry_in(*nodes[i].scene, nodes[i].node))->bounds,
                        sensor_from_world * nodes[i].world_from_parent));
  const WideBox region(glm::dvec3(center - size * 0.5F), glm::dvec3(center + size * 0.5F));
  if (bounds.empty() || (!everywhere && !do_overlap(bounds, region))) return std::nullopt;
  return sensor_from_world * nodes[target].world_from_inside;
}

SFRotation rotation_in(const glm::dmat4& matrix) {
  glm::dmat3 turned(matrix);
  for (int i = 0; i < 3; ++i) turned[i] /= glm::length(turned[i]);
  const SFRotation rotation = gs::vrml::rotation_of(glm::quat_cast(turned));
  return std::isfinite(rotation.x + rotation.y + rotation.z + rotation.angle) ? rotation : SFRotation{};
}

void watch(Execution& execution, EventNode node) {
  if (execution.has_sent(node, Watch::is_active)) return execution.timers().call_at(node, execution.now());
  const std::optional<glm::dmat4> sensor_from_target = watched(execution, node);
  const bool active = execution.get<SFBool>(node, Watch::is_active);
  if (active != sensor_from_target.has_value()) {
    execution.send(node, Watch::is_active, SFBool{!active});
    execution.send(node, active ? Watch::exit_time : Watch::enter_time, SFTime{execution.now()});
  }
  if (!sensor_from_target) return;
  const SFVec3f position((*sensor_from_target)[3]);
  const SFRotation orientation = rotation_in(*sensor_from_target);
  if (!active || position != execution.get<SFVec3f>(node, Watch::position))
    execution.send(node, Watch::position, position);
  if (!active || orientation != execution.get<SFRotation>(node, Watch::orientation))
    execution.send(node, Watch::orientation, orientation);
}

}  // namespace

const Behaviour kTransformSensorBehaviour = {
    .events = {"center", "size", "enabled", "targetObject", "isActive", "enterTime", "exitTime", "position_changed",
               "orientation_changed"},
    .initialize =
        [](Execution& execution, EventNode node) {
          execution.shapes().add(node);
          execution.timers().look_again(node);
        },
    .on_event =
        [](Execution& execution, EventNode node, int, const FieldValue&) {
          execution.timers().look_again(node);
          return true;
        },
    .on_time = watch,
    .on_remove = [](Execution& execution, EventNode node) { execution.shapes().remove(node); },
};

}  // namespace gs::vrml
