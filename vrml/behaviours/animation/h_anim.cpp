#include "vrml/behaviours/animation/h_anim.h"
#include "vrml/behaviours/grouping.h"
#include "vrml/events/execution.h"
#include "vrml/scene/values/transformation.h"

#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <unordered_set>
#include <utility>

// Humanoids (ISO/IEC 19774-1, X3D component HAnim): joints, and the skin that follows them.
namespace gs::vrml {
namespace {

struct HumanoidEvents {
  enum : int { skin_coord, skin_normal, skeleton, joints, segments, skin_binding_coords, motions, motions_enabled };
};
struct JointEvents {
  // The first ones are those of change_children().
  enum : int { displacers = 3, skin_coord_index, skin_coord_weight };
};
struct SegmentEvents {
  enum : int { coord = 3, displacers };
};
struct DisplacerEvents {
  enum : int { coord_index, displacements, weight };
};

/// Node of a world, and its position there.
struct WorldNode {
  SceneGraph* scene = nullptr;
  SceneState* state = nullptr;
};
WorldNode humanoid_world(Execution& execution, EventNode node) {
  SceneGraph* const scene = execution.nodes()[node].scene;
  return {scene, execution.scenes().find(scene)};
}

// Returns a field of a node that an HAnim node refers to; null if its type has no such field.
template <class T>
const T* part_field(const SceneGraph& scene, NodeId id, std::string_view name) {
  const NodeId node = scene.resolve(id);
  const InterfaceDeclaration* const field = node ? scene.node(node).type->find_field(name) : nullptr;
  return field ? std::get_if<T>(&scene.node(node).values[field->slot]) : nullptr;
}

std::vector<glm::dvec3> points_of(const SceneGraph& scene, NodeId node, std::string_view field) {
  if (const auto* list = part_field<MFVec3f>(scene, node, field)) return {list->begin(), list->end()};
  if (const auto* list = part_field<MFVec3d>(scene, node, field)) return {list->begin(), list->end()};
  return {};
}

// Sets a list of points of a Coordinate, CoordinateDouble or Normal, and sends it.
void send_points(Execution& execution, WorldNode world, NodeId id, std::string_view field,
                 const std::vector<glm::dvec3>& points) {
  const NodeId node = world.scene->resolve(id);
  const NodeType& type = *world.scene->node(node).type;
  const InterfaceDeclaration* const declared = type.find_field(field);
  const EventNode target = declared && declared->access == AccessType::exposedField
                               ? execution.scenes().member(*world.state, node)
                               : EventNode{0};
  if (target == 0 || !execution.nodes().afford_most(target, points.size() * sizeof(glm::dvec3))) return;
  FieldValue value = declared->type == FieldType::MFVec3f ? FieldValue(MFVec3f()) : FieldValue(MFVec3d());
  if (auto* list = std::get_if<MFVec3f>(&value))
    for (const glm::dvec3& point : points) list->push_back(SFVec3f(point));
  if (auto* list = std::get_if<MFVec3d>(&value))
    for (const glm::dvec3& point : points) list->push_back(point);
  set_field(execution, target, *declared, std::move(value));
}

// Adds the displacements of the displacers to points: weight times displacement, turned by `turn`.
void displace(const SceneGraph& scene, const MFNode& displacers, const glm::dmat3& turn,
              std::vector<glm::dvec3>& points) {
  for (const NodeId displacer : displacers) {
    const auto* index = part_field<MFInt32>(scene, displacer, "coordIndex");
    const auto* motion = part_field<MFVec3f>(scene, displacer, "displacements");
    const auto* weight = part_field<SFFloat>(scene, displacer, "weight");
    if (!index || !motion || !weight || *weight == 0) continue;
    for (std::size_t i = 0; i < index->size() && i < motion->size(); ++i)
      if (const auto at = static_cast<std::size_t>((*index)[i]); (*index)[i] >= 0 && at < points.size())
        points[at] += turn * glm::dvec3((*motion)[i]) * static_cast<double>(*weight);
  }
}

std::size_t displacement_cost(const SceneGraph& scene, const MFNode& displacers) {
  std::size_t cost = 0;
  for (const NodeId displacer : displacers)
    if (const auto* index = part_field<MFInt32>(scene, displacer, "coordIndex")) cost += index->size();
  return cost;
}

/// Collects the joints of a skeleton, parents first.
class SkeletonReader {
 public:
  SkeletonReader(Execution& execution, EventNode humanoid, HumanoidState& state)
      : execution_(execution), humanoid_(humanoid), state_(state), world_(humanoid_world(execution, humanoid)) {}

  void read(const MFNode& skeleton) {
    std::vector<std::pair<NodeId, std::uint32_t>> waiting;
    const auto add = [&](const MFNode& nodes, std::uint32_t parent) {
      for (std::size_t i = nodes.size(); i-- > 0;) waiting.emplace_back(world_.scene->resolve(nodes[i]), parent);
    };
    add(skeleton, 0);
    while (!waiting.empty() && execution_.budget().spend(1)) {
      const auto [id, parent] = waiting.back();
      waiting.pop_back();
      if (!id || !seen_.insert(id.index).second) continue;
      watch(id);
      const MFNode* const children = part_field<MFNode>(*world_.scene, id, "children");
      if (const auto* displacers = part_field<MFNode>(*world_.scene, id, "displacers"))
        for (const NodeId displacer : *displacers) watch(world_.scene->resolve(displacer));
      if (!part_field<MFInt32>(*world_.scene, id, "skinCoordIndex")) {
        // Segments and Sites contain no joints.
        continue;
      }
      state_.joints.push_back({id, parent, glm::dmat4(1)});
      if (children) add(*children, static_cast<std::uint32_t>(state_.joints.size()));
    }
  }

 private:
  // Registers a part, so that its changes reach the humanoid.
  void watch(NodeId id) {
    if (!id) return;
    const Behaviour* const behaviour = world_.scene->node(id).type->behaviour;
    if (behaviour != &kJointBehaviour && behaviour != &kDisplacerBehaviour) return;
    if (const EventNode part = execution_.scenes().member(*world_.state, id))
      execution_.nodes().state_of(part) = humanoid_;
  }

  Execution& execution_;
  EventNode humanoid_;
  HumanoidState& state_;
  WorldNode world_;
  std::unordered_set<std::uint32_t> seen_;
};

// Reads the binding pose: by default, the pose without rotations.
void read_binding(Execution& execution, EventNode node, HumanoidState& state) {
  const WorldNode world = humanoid_world(execution, node);
  const SceneGraph& scene = *world.scene;
  const NodeId self = execution.nodes()[node].id;
  const NodeId given = execution.get<SFNode>(node, HumanoidEvents::skin_binding_coords);
  state.points = points_of(scene, given ? given : execution.get<SFNode>(node, HumanoidEvents::skin_coord), "point");
  state.normals = points_of(scene, execution.get<SFNode>(node, HumanoidEvents::skin_normal), "vector");
  if (state.normals.size() != state.points.size()) state.normals.clear();
  const auto* positions = part_field<MFVec3f>(scene, self, "jointBindingPositions");
  const auto* rotations = part_field<MFRotation>(scene, self, "jointBindingRotations");
  const auto* scales = part_field<MFVec3f>(scene, self, "jointBindingScales");
  const MFNode& joints = execution.get<MFNode>(node, HumanoidEvents::joints);
  for (std::size_t i = 0; positions && rotations && i < joints.size() && i < positions->size(); ++i) {
    const NodeId id = scene.resolve(joints[i]);
    const auto joint =
        std::find_if(state.joints.begin(), state.joints.end(), [&](const auto& j) { return j.node == id; });
    if (joint == state.joints.end()) continue;
    const SFRotation rotation = i < rotations->size() ? (*rotations)[i] : SFRotation();
    const SFVec3f scale = scales && i < scales->size() ? (*scales)[i] : SFVec3f(1);
    joint->binding_from_humanoid = glm::inverse(transform_matrix((*positions)[i], SFVec3f(0), rotation, scale, {}));
  }
}

HumanoidState& humanoid_state(Execution& execution, EventNode node) {
  return execution.states().humanoids[execution.nodes().state_of(node)];
}

void read_humanoid(Execution& execution, EventNode node) {
  HumanoidState& state = humanoid_state(execution, node);
  state.joints.clear();
  SkeletonReader(execution, node, state).read(execution.get<MFNode>(node, HumanoidEvents::skeleton));
  read_binding(execution, node, state);
  const WorldNode world = humanoid_world(execution, node);
  const MFNode& motions = execution.get<MFNode>(node, HumanoidEvents::motions);
  for (std::size_t i = 0; i < motions.size(); ++i)
    if (const NodeId id = world.scene->resolve(motions[i]);
        id && world.scene->node(id).type->behaviour == &kMotionBehaviour)
      if (const EventNode member = execution.scenes().member(*world.state, id))
        attach_motion(execution, member, node, i, state);
}

// Starts or ends motions after a change of motionsEnabled.
void look_at_motions(Execution& execution, EventNode node) {
  const WorldNode world = humanoid_world(execution, node);
  for (const NodeId motion : execution.get<MFNode>(node, HumanoidEvents::motions))
    if (const NodeId id = world.scene->resolve(motion);
        id && world.scene->node(id).type->behaviour == &kMotionBehaviour)
      if (const EventNode member = execution.scenes().member(*world.state, id)) execution.timers().look_again(member);
}

void begin_humanoid(Execution& execution, EventNode node) {
  execution.nodes().state_of(node) = execution.states().humanoids.take();
  read_humanoid(execution, node);
  execution.timers().look_again(node);
}

bool humanoid_event(Execution& execution, EventNode node, int event, const FieldValue&) {
  if (event == HumanoidEvents::skeleton || event == HumanoidEvents::joints) execution.timers().look_again(node);
  if (event == HumanoidEvents::motions_enabled) look_at_motions(execution, node);
  return true;
}

// Moves the skin: each point follows its joints, with their weights.
void move_skin(Execution& execution, EventNode node) {
  HumanoidState& state = humanoid_state(execution, node);
  if (state.points.empty()) return;
  const WorldNode world = humanoid_world(execution, node);
  const SceneGraph& scene = *world.scene;
  std::size_t cost = state.points.size();
  for (const HumanoidState::Joint& joint : state.joints) {
    if (!scene.contains(joint.node)) return read_humanoid(execution, node);
    cost += scene.get<MFInt32>(joint.node, "skinCoordIndex").size();
    cost += displacement_cost(scene, scene.get<MFNode>(joint.node, "displacers"));
  }
  if (!execution.budget().spend(cost)) return;
  std::vector<glm::dmat4> humanoid_from_joint(state.joints.size());
  std::vector<glm::dvec3> points(state.points.size()), normals(state.normals.size());
  std::vector<double> weights(state.points.size(), 0);
  for (std::size_t j = 0; j < state.joints.size(); ++j) {
    const HumanoidState::Joint& joint = state.joints[j];
    const glm::dmat4 parent = joint.parent == 0 ? glm::dmat4(1) : humanoid_from_joint[joint.parent - 1];
    humanoid_from_joint[j] = parent * transform_of(scene, scene.node(joint.node));
    const glm::dmat4 motion = humanoid_from_joint[j] * joint.binding_from_humanoid;
    const glm::dmat3 turn = glm::inverse(glm::transpose(glm::dmat3(motion)));
    const MFInt32& index = scene.get<MFInt32>(joint.node, "skinCoordIndex");
    const MFFloat& given = scene.get<MFFloat>(joint.node, "skinCoordWeight");
    for (std::size_t i = 0; i < index.size(); ++i) {
      const auto at = static_cast<std::size_t>(index[i]);
      if (index[i] < 0 || at >= points.size()) continue;
      const double weight = i < given.size() ? static_cast<double>(given[i]) : 1;
      points[at] += glm::dvec3(motion * glm::dvec4(state.points[at], 1)) * weight;
      if (!normals.empty()) normals[at] += turn * state.normals[at] * weight;
      weights[at] += weight;
    }
  }
  // Points without a joint stay in place. Weights that do not sum to 1 are normalized.
  for (std::size_t i = 0; i < points.size(); ++i) {
    const bool moved = weights[i] > 0;
    points[i] = moved ? points[i] / weights[i] : state.points[i];
    if (!normals.empty())
      normals[i] = moved && glm::dot(normals[i], normals[i]) > 0 ? glm::normalize(normals[i]) : state.normals[i];
  }
  for (std::size_t j = 0; j < state.joints.size(); ++j)
    displace(scene, scene.get<MFNode>(state.joints[j].node, "displacers"), glm::dmat3(humanoid_from_joint[j]), points);
  send_points(execution, world, execution.get<SFNode>(node, HumanoidEvents::skin_coord), "point", points);
  if (!normals.empty())
    send_points(execution, world, execution.get<SFNode>(node, HumanoidEvents::skin_normal), "vector", normals);
}

void end_humanoid(Execution& execution, EventNode node) {
  execution.states().humanoids.give_back(execution.nodes().state_of(node));
}

// Notifies the humanoid if a joint of a skeleton has changed.
bool joint_event(Execution& execution, EventNode node, int event, const FieldValue& value) {
  const EventNode humanoid = execution.nodes().state_of(node);
  if (humanoid != 0 && !execution.nodes().is_removed(humanoid)) execution.timers().look_again(humanoid);
  return change_children(execution, node, event, value);
}
bool displacer_event(Execution& execution, EventNode node, int, const FieldValue&) {
  const EventNode owner = execution.nodes().state_of(node);
  if (owner != 0 && !execution.nodes().is_removed(owner)) execution.timers().look_again(owner);
  return true;
}

// Stores the coordinates of a segment before displacement.
void begin_segment(Execution& execution, EventNode node) {
  const WorldNode world = humanoid_world(execution, node);
  const MFNode& displacers = execution.get<MFNode>(node, SegmentEvents::displacers);
  if (displacers.empty()) return;
  execution.nodes().state_of(node) = execution.states().humanoids.take();
  humanoid_state(execution, node).points =
      points_of(*world.scene, execution.get<SFNode>(node, SegmentEvents::coord), "point");
  for (const NodeId displacer : displacers)
    if (const NodeId id = world.scene->resolve(displacer);
        id && world.scene->node(id).type->behaviour == &kDisplacerBehaviour)
      if (const EventNode member = execution.scenes().member(*world.state, id))
        execution.nodes().state_of(member) = node;
  execution.timers().look_again(node);
}
void move_segment(Execution& execution, EventNode node) {
  if (execution.nodes().state_of(node) == 0) return;
  const WorldNode world = humanoid_world(execution, node);
  std::vector<glm::dvec3> points = humanoid_state(execution, node).points;
  const MFNode& displacers = execution.get<MFNode>(node, SegmentEvents::displacers);
  if (points.empty() || !execution.budget().spend(points.size() + displacement_cost(*world.scene, displacers))) return;
  displace(*world.scene, displacers, glm::dmat3(1), points);
  send_points(execution, world, execution.get<SFNode>(node, SegmentEvents::coord), "point", points);
}

}  // namespace

void set_field(Execution& execution, EventNode node, const InterfaceDeclaration& field, FieldValue value) {
  const auto& interfaces = execution.nodes().type_of(node).interfaces;
  for (std::uint32_t i = 0; i < interfaces.size(); ++i) {
    if (&interfaces[i] != &field || execution.cascade().has_sent_own(node, i)) continue;
    execution.nodes().own_value(node, i) = std::move(value);
    execution.cascade().send_own(node, i);
    return;
  }
}

const Behaviour kHumanoidBehaviour = {
    .events = {"skinCoord", "skinNormal", "skeleton", "joints", "segments", "skinBindingCoords", "motions",
               "motionsEnabled"},
    .initialize = begin_humanoid,
    .on_event = humanoid_event,
    .on_time = move_skin,
    .parent_from_local = transform_of,
    .on_remove = end_humanoid,
};
const Behaviour kJointBehaviour = {
    .events = {"addChildren", "removeChildren", "children", "displacers", "skinCoordIndex", "skinCoordWeight",
               "translation", "rotation", "scale", "center", "scaleOrientation"},
    .on_event = joint_event,
    .parent_from_local = transform_of,
};
const Behaviour kSegmentBehaviour = {
    .events = {"addChildren", "removeChildren", "children", "coord", "displacers"},
    .initialize = begin_segment,
    .on_event = change_children,
    .on_time = move_segment,
    .on_remove = end_humanoid,
};
const Behaviour kDisplacerBehaviour = {
    .events = {"coordIndex", "displacements", "weight"},
    .on_event = displacer_event,
};

}  // namespace gs::vrml
